"""Which fault of meaning is planted into which real walk, and with which words it has to be found."""

from __future__ import annotations

import itertools
import re
import shutil
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path

from fault_cases_in_text import angle_cases, opensim_cases
from faults_in_c3d import analog, analog_exchanged, point_labels, points_times
from faults_of_meaning import Case, in_c3d
from plug_in_gait_bones import WALKERS, static_file

PLATES = (range(6), range(6, 12))
RIGHT_LEFT = re.compile(r"^([LR])(?=[A-Z])")
LEG = re.compile(r"^[LR](?=THI|KNE|TIB|ANK|HEE|TOE|FTC|KNM|MMA|P1M|D1M|P5M|D5M|PCA|LCA|STL|CPG|HFB|SHN|TUB)")


def cases(data: Path, quick: bool = False) -> Iterator[Case]:
    """Every case; three of three files where it is to be quick."""
    gait = data / "gait"
    records = {path.stem[:12]: path for path in (gait / "treadmill_walk_ik").glob("S01DE*.mot")}
    records |= {f"exotendon {path.stem[-27:-22]}": path for path in (gait / "exotendon_run").glob("*.mot")}
    every = itertools.chain(_young(gait), _treadmill(gait), opensim_cases(data), angle_cases(records))
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
    yield from angle_cases(names)


def _planter(name: str, files: Mapping[str, Path]) -> Callable[..., Case]:
    return lambda fault, turn, words: Case(fault, name, files, in_c3d("walk.c3d", turn), words)


def _without_emg(path: Path) -> Iterator[Case]:
    case = _planter(path.stem, {"walk.c3d": path})
    yield case("numbers in m for mm", points_times(1e-3), "looks like m")
    yield case("forces per kg", analog("^[FM]", 0.014), "per kg")
    yield case("left and right swapped", point_labels(_mirrored), "left and right are (exchanged|swapped)")
    yield case("plates swapped", in_plates, r"follows the other|swapped|cm beside the nearest foot")


def _young(gait: Path, kind: str = "straight") -> Iterator[Case]:
    for place, person in enumerate(WALKERS):
        walk = next((gait / "young_straight_and_turn" / person / kind).glob("*.c3d"))
        files = {"walk.c3d": walk, "static.c3d": static_file(gait, person)}
        live = LIVE[person]
        case = _planter(person, files)
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
    case = _planter("treadmill C3D", {"walk.c3d": gait / "treadmill_c3d_emg" / "walking_1.c3d"})
    yield case("numbers in m for mm", points_times(1e-3), "looks like m")
    yield case("EMG in V for mV", analog("Voltage", 1.0, "mV"), "looks? like V")
    yield case("EMG in mV for V", analog("Voltage", 1e3), "looks? like mV")
    yield case("forces per kg", analog("Force|Moment", 0.014), "per kg")
    yield case("left and right swapped", point_labels(_mirrored), "left and right are (exchanged|swapped)")
    yield case("belts swapped", in_corners, "swapped|follows the other")
    yield case("belts swapped", in_plates, "swapped|follows the other")
