"""Faults of meaning in text files: inverse kinematics, ground forces and moments of OpenSim."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path

from faults_of_meaning import Case, Turn, cut_row, in_storage, in_trc, mirrored, scaled

ANGLES = r"^(?!time|pelvis_t[xyz]$)"
KNEES = r"knee_angle_[rl](_beta)?$"
SIDES = r"(?<=_)[rl](?=$|/|_beta)"  # of a joint, not of a pelvis_rotation
MASSES = {"mrs": 75.0, "moco": 75.3, "gait10dof": 72.6}


def opensim_cases(data: Path) -> Iterator[Case]:
    """Of three walks with angles, forces, moments and markers."""
    for case in _whole(data):  # inverse kinematics of mrs is a walk in these seconds only
        own = case.name.startswith("mrs") and "ik.mot" in case.files
        yield case._replace(crop_s=(1.06, 3.23)) if own else case


def _whole(data: Path) -> Iterator[Case]:
    walks, dof = data / "gait" / "opensim_walks", data / "opensim_gait10dof"
    moco, mrs = walks / "moco_3dwalking", walks / "mrs_emg_walking"
    sets = {
        "mrs": (mrs / "IK_gait.mot", mrs / "GRF_gait.mot", mrs / "ID_gait.sto", mrs / "TRC_gait.trc"),
        "moco": (moco / "coordinates.sto", moco / "grf_walk.mot", moco / "id_walk.sto", moco / "markers_walk.trc"),
        "gait10dof": (
            dof / "IK" / "subject01_walk_IK.mot",
            dof / "ExperimentalData" / "subject01_walk_grf.mot",
            dof / "ID" / "Results" / "subject01_walk_ID.sto",
            dof / "ExperimentalData" / "subject01_walk.trc",
        ),
    }
    for name, (ik, grf, own, trc) in sets.items():
        rad = name == "moco"
        files = {f"ik{ik.suffix}": ik, "grf.mot": grf}
        first = f"ik{ik.suffix}"
        header = ("inDegrees=no", "inDegrees=yes") if rad else ("inDegrees=yes", "inDegrees=no")
        words = "states (degrees|radians)"
        stays = in_storage(first, scaled("^$", 1.0), header)
        yield Case("angles in radians for degrees", name, files, stays, words)
        turned = in_storage(first, scaled(ANGLES, 57.29578 if rad else 0.0174533))
        yield Case("angles in radians for degrees", f"{name}, numbers", files, turned, words)
        per_kg = in_storage("grf.mot", scaled("force_(._)?v|torque", 1 / MASSES[name]))
        yield Case("forces per kg", name, files, per_kg, "per kg")
        torques = in_storage("id.sto", scaled("_(moment|force)$", 1 / MASSES[name]))
        yield Case("moments per kg", name, {"id.sto": own}, torques, "per kg")
        if name != "mrs":  # its forces bear the other foot's name as published: ID_gait.sto shows it
            yield Case("left and right swapped", name, files, in_storage(first, mirrored(SIDES)), "swapped")
            yield Case("belts swapped", name, files, in_storage("grf.mot", _swapped(rad)), "swapped")
        knees = r"knee_angle_[rl]/value" if rad else KNEES
        words = r"flexion is (negative|positive)"
        if name != "moco":  # knees are negative: turned, both have the package's sign; one alone is a fault
            knees = "knee_angle_l"
        yield Case("knee's sign", name, files, in_storage(first, scaled(knees, -1.0)), words)
        metres = "TRC" in trc.name
        marks = {"walk.trc": trc, "grf.mot": grf}
        plant = in_trc("walk.trc", 1e3 if metres else 1e-3, r"m" if metres else "mm")
        yield Case("numbers in m for mm", name, marks, plant, "looks like m")
        other = in_trc("walk.trc", 1.0, "mm" if metres else "m")
        yield Case("numbers in m for mm", f"{name}, header", marks, other, "looks like m")


def _swapped(sided: bool) -> Turn:
    """Forces of the right and the left foot exchanged, whichever way a file names them."""
    if sided:
        return mirrored(r"(?<=ground_force_)[rl]|(?<=ground_torque_)[rl]")

    def turn(labels, _):
        for i, label in enumerate(labels):
            if "ground" in label:
                labels[i] = label[2:] if label.startswith("1_") else f"1_{label}"

    return turn


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

        def plant(folder: Path) -> None:
            in_storage("left.mot", _part(lambda label: not label.endswith("_r")))(folder)
            in_storage("right.mot", _part(lambda label: label == "time" or label.endswith("_r")))(folder)
            in_storage("right.mot", cut_row)(folder)

        yield Case("100 against 101 points", name, halves, plant, "share one time base")


def _part(keep):
    """Labels that are left, the others called after themselves so that two files share none."""

    def turn(labels, _):
        labels[:] = [label if keep(label) else f"unused {i}" for i, label in enumerate(labels)]

    return turn
