"""Faults of meaning in text files: inverse kinematics, ground forces and moments of OpenSim."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path

import numpy as np
from faults_of_meaning import Case, Rows, in_storage, in_trc, mirrored, renamed, scaled

ANGLES = r"^(?!time|pelvis_t[xyz]$)"
KNEES = r"knee_angle_[rl](_beta)?$"
SIDES = r"(?<=_)[rl](?=$|/|_beta)"  # of a joint, not of a pelvis_rotation
MASSES = {"mrs": 75.0, "moco": 75.3, "gait10dof": 72.6}


def opensim_cases(data: Path) -> Iterator[Case]:
    """Of three walks with angles, forces, moments and markers."""
    walks, dof = data / "gait" / "opensim_walks", data / "opensim_gait10dof"
    moco, mrs = walks / "moco_3dwalking", walks / "mrs_emg_walking"
    sets = {
        "mrs": (mrs / "IK_gait.mot", mrs / "GRF_gait.mot", mrs / "ID_gait.sto", mrs / "TRC_gait.trc"),
        "moco": (moco / "coordinates.sto", moco / "grf_walk.mot", moco / "id_walk.sto", moco / "markers_walk.trc"),
        "gait10dof": tuple(
            next(dof.rglob(f"subject01_walk{end}")) for end in ("_IK.mot", "_grf.mot", "_ID.sto", ".trc")
        ),
    }
    for name, (ik, grf, own, trc) in sets.items():
        rad, first = name == "moco", f"ik{ik.suffix}"
        files, crop_s = {first: ik, "grf.mot": grf}, (1.06, 3.23) if name == "mrs" else None  # where mrs is a walk
        header = ("inDegrees=no", "inDegrees=yes") if rad else ("inDegrees=yes", "inDegrees=no")
        words = "states (degrees|radians)"
        stays = in_storage(first, scaled("^$", 1.0), header)
        yield Case("angles in radians for degrees", name, files, stays, words, crop_s)
        turned = in_storage(first, scaled(ANGLES, 57.29578 if rad else 0.0174533))
        yield Case("angles in radians for degrees", f"{name}, numbers", files, turned, words, crop_s)
        per_kg = in_storage("grf.mot", scaled("force_(._)?v|torque", 1 / MASSES[name]))
        yield Case("forces per kg", name, files, per_kg, "per kg", crop_s)
        torques = in_storage("id.sto", scaled("_(moment|force)$", 1 / MASSES[name]))
        yield Case("moments per kg", name, {"id.sto": own}, torques, "per kg")
        if name != "mrs":  # its forces bear the other foot's name as published: ID_gait.sto shows it
            yield Case("left and right swapped", name, files, in_storage(first, mirrored(SIDES)), "swapped")
            # whichever way a file names the foot that its forces belong to
            belts = mirrored(r"(?<=ground_force_)[rl]|(?<=ground_torque_)[rl]") if rad else renamed(_other_belt)
            yield Case("belts swapped", name, files, in_storage("grf.mot", belts), "swapped")
        # where knees are negative, turned ones have the package's sign; one alone is a fault
        knees = in_storage(first, scaled(r"knee_angle_[rl]/value" if rad else "knee_angle_l", -1.0))
        yield Case("knee's sign", name, files, knees, r"flexion is (negative|positive)", crop_s)
        metres, marks = "TRC" in trc.name, {"walk.trc": trc, "grf.mot": grf}
        plant = in_trc("walk.trc", 1e3 if metres else 1e-3, r"m" if metres else "mm")
        yield Case("numbers in m for mm", name, marks, plant, "looks like m")
        other = in_trc("walk.trc", 1.0, "mm" if metres else "m")
        yield Case("numbers in m for mm", f"{name}, header", marks, other, "looks like m")


def _other_belt(label: str) -> str:
    other = label[2:] if label.startswith("1_") else f"1_{label}"
    return other if "ground" in label else label


def angle_cases(records: Mapping[str, Path]) -> Iterator[Case]:
    """Of walks with angles alone."""
    for name, path in sorted(records.items()):
        files = {"ik.mot": path}
        header = in_storage("ik.mot", scaled("^$", 1.0), ("inDegrees=yes", "inDegrees=no"))
        yield Case("angles in radians for degrees", name, files, header, "states radians")
        numbers = in_storage("ik.mot", scaled(ANGLES, 0.0174533))
        yield Case("angles in radians for degrees", f"{name}, numbers", files, numbers, "states degrees")
        yield Case("knee's sign", name, files, in_storage("ik.mot", scaled(KNEES, -1.0)), "flexion is negative")
        one = in_storage("ik.mot", scaled(r"knee_angle_l(_beta)?$", -1.0))
        yield Case("knee's sign", f"{name}, one knee", files, one, "flexion is positive in .* and negative in")
        yield Case("left and right swapped", name, files, in_storage("ik.mot", mirrored(SIDES)), "swapped")
        halves = {"left.mot": path, "right.mot": path}

        yield Case("100 against 101 points", name, halves, _plant_halves, "have one time base")


def _plant_halves(folder: Path) -> None:
    """Leave each of two files its own labels, and the right one a sample less."""

    def left(labels: list[str], _: Rows) -> None:
        labels[:] = [f"unused {i}" if label.endswith("_r") else label for i, label in enumerate(labels)]

    def right(labels: list[str], rows: Rows) -> None:
        own = [label == "time" or label.endswith("_r") for label in labels]
        labels[:] = [label if kept else f"unused {i}" for i, (label, kept) in enumerate(zip(labels, own, strict=True))]
        rows[-1, 0] = np.nan  # is not written

    in_storage("left.mot", left)(folder)
    in_storage("right.mot", right)(folder)
