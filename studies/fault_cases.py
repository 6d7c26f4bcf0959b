"""Which fault of meaning is planted into which real walk, and with which words it has to be found."""

from __future__ import annotations

import itertools
import re
import shutil
from collections.abc import Iterator, Mapping
from pathlib import Path

from faults_of_meaning import (
    Case,
    Turn,
    analog,
    analog_exchanged,
    cut_row,
    in_c3d,
    in_storage,
    in_trc,
    mirrored,
    point_labels,
    points_times,
    scaled,
)
from plug_in_gait_bones import WALKERS, static_file

ANGLES = r"^(?!time|pelvis_t[xyz]$)"
KNEES = r"knee_angle_[rl](_beta)?$"
SIDES = r"(?<=_)[rl](?=$|/|_beta)"  # of a joint, not of a pelvis_rotation
PLATES = (range(6), range(6, 12))
RIGHT_LEFT = re.compile(r"^([LR])(?=[A-Z])")
LEG = re.compile(r"^[LR](?=THI|KNE|TIB|ANK|HEE|TOE|FTC|KNM|MMA|P1M|D1M|P5M|D5M|PCA|LCA|STL|CPG|HFB|SHN|TUB)")
MASSES = {"mrs": 75.0, "moco": 75.3, "gait10dof": 72.6}


def cases(data: Path, quick: bool = False) -> Iterator[Case]:
    """Every case; three of three files where it is to be quick."""
    gait = data / "gait"
    records = {path.stem[:12]: path for path in (gait / "treadmill_walk_ik").glob("S01DE*.mot")}
    records |= {f"exotendon {path.stem[-27:-22]}": path for path in (gait / "exotendon_run").glob("*.mot")}
    every = itertools.chain(_young(gait), _treadmill(gait), _opensim(data), _angles(records))
    if not quick:
        yield from every
        return
    wanted = [("m for mm", "HC030A"), ("radians", "S01DE504"), ("another person", "HC030A")]
    for case in every:
        if any(word in case.fault and name in case.name for word, name in wanted):
            wanted = [pair for pair in wanted if not (pair[0] in case.fault and pair[1] in case.name)]
            yield case


def held_back(data: Path) -> Iterator[Case]:
    """Cases in files that nothing was set on: the turns, another laboratory's walks, two treadmill files."""
    gait = data / "gait"
    yield from _young(gait, "turn")
    for path in sorted((gait / "opensim_walks" / "c3d_walk_noemg").glob("*.c3d")):
        yield from _without_emg(path)
    names = {"S01DN603": gait / "treadmill_walk_ik" / "S01DN603_ik.mot"}
    names |= {f"exotendon {path.parent.name}": path for path in (gait / "exotendon_run").glob("*/manual_ik.mot")}
    yield from _angles(names)


def _without_emg(path: Path) -> Iterator[Case]:
    files = {"walk.c3d": path}

    def case(fault, turn, words):
        return Case(fault, path.stem, files, in_c3d("walk.c3d", turn), words)

    yield case("numbers in m for mm", points_times(1e-3), "looks like m")
    yield case("forces per kg", analog("^[FM]", 0.014), "per kg")
    yield case("left and right swapped", point_labels(_mirrored), "left and right are (exchanged|swapped)")
    yield case("plates swapped", in_plates, r"follows the other|swapped|cm beside the nearest foot")


def _young(gait: Path, kind: str = "straight") -> Iterator[Case]:
    for place, person in enumerate(WALKERS):
        walk = next((gait / "young_straight_and_turn" / person / kind).glob("*.c3d"))
        files = {"walk.c3d": walk, "static.c3d": static_file(gait, person)}
        live = LIVE[person]

        def case(fault, turn, words, files=files, person=person):
            return Case(fault, person, files, in_c3d("walk.c3d", turn), words)

        yield case("numbers in m for mm", points_times(1e-3, r"^(?!.*(Angles|Moment|Power|Force))"), "looks like m")
        yield case("angles in radians for degrees", points_times(0.0174533, "Angles"), "look like radians")
        yield case("EMG in V for mV", analog("Voltage", 1.0, "mV"), r"looks? like V")
        yield case("EMG in mV for V", analog("Voltage", 1e3), r"looks? like mV")
        yield case("forces per kg", analog("Force|Moment", 0.02), r"per kg")
        yield case("left and right swapped", point_labels(_mirrored), "left and right are (exchanged|swapped)")
        yield case("legs swapped", point_labels(_legs_mirrored), "left and right")
        yield case("knee's sign", points_times(-1.0, "KneeAngles", 0), r"flexion is (negative|positive)|turned")
        yield case("plates swapped", in_plates, r"follows the other|swapped|cm beside the nearest foot")
        yield case("EMG channels exchanged", analog_exchanged(*live), "exchanged")
        for other in (WALKERS[place - 1], WALKERS[place - 2]):

            def plant(folder, other=other):
                shutil.copyfile(static_file(gait, other), folder / "static.c3d")

            words = "another person|of this person"
            yield Case("static trial of another person", f"{person} with {other}", files, plant, words)


def in_plates(c3d) -> None:
    """Exchange what two plates measured and leave where they lie."""
    analog_exchanged(*PLATES)(c3d)


def in_corners(c3d) -> None:
    """Exchange where two plates lie and leave what they measured."""
    corners = c3d["parameters"]["FORCE_PLATFORM"]["CORNERS"]
    corners["value"] = corners["value"][:, :, [1, 0]]


def _mirrored(label: str) -> str:
    return RIGHT_LEFT.sub(lambda found: "L" if found[1] == "R" else "R", label)


def _legs_mirrored(label: str) -> str:
    return _mirrored(label) if LEG.match(label) else label


# analog channels, from 0, of the calf and of the tibialis anterior of a leg whose EMG lives: manifest.csv
LIVE = {name: ([16], [18]) if name in ("HC032A", "HC036A") else ([17], [19]) for name in WALKERS}


def _treadmill(gait: Path) -> Iterator[Case]:
    files = {"walk.c3d": gait / "treadmill_c3d_emg" / "walking_1.c3d"}

    def case(fault, turn, words):
        return Case(fault, "treadmill C3D", files, in_c3d("walk.c3d", turn), words)

    yield case("numbers in m for mm", points_times(1e-3), "looks like m")
    yield case("EMG in V for mV", analog("Voltage", 1.0, "mV"), "looks? like V")
    yield case("EMG in mV for V", analog("Voltage", 1e3), "looks? like mV")
    yield case("forces per kg", analog("Force|Moment", 0.014), "per kg")
    yield case("left and right swapped", point_labels(_mirrored), "left and right are (exchanged|swapped)")
    yield case("belts swapped", in_corners, "swapped|follows the other")
    yield case("belts swapped", in_plates, "swapped|follows the other")


def _opensim(data: Path) -> Iterator[Case]:
    for case in _opensim_whole(data):  # inverse kinematics of mrs is a walk in these seconds only
        own = case.name.startswith("mrs") and "ik.mot" in case.files
        yield case._replace(crop_s=(1.06, 3.23)) if own else case


def _opensim_whole(data: Path) -> Iterator[Case]:
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


def _angles(records: Mapping[str, Path]) -> Iterator[Case]:
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
