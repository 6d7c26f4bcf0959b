"""Which fault of meaning is planted into which real walk, and with which words it has to be found."""

from __future__ import annotations

import itertools
import re
import shutil
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

from fault_cases_in_text import angle_cases, opensim_cases
from faults_of_meaning import Case, analog, analog_exchanged, point_labels, points_times
from plug_in_gait_bones import WALKERS, static_file

RIGHT_LEFT = re.compile(r"^([LR])(?=[A-Z])")
LEG = re.compile(r"^[LR](?=THI|KNE|TIB|ANK|HEE|TOE|FTC|KNM|MMA|P1M|D1M|P5M|D5M|PCA|LCA|STL|CPG|HFB|SHN|TUB)")
# analog channels, from 0, of the calf and of the tibialis anterior of a leg whose EMG lives: manifest.csv
LIVE = {name: ([16], [18]) if name in ("HC032A", "HC036A") else ([17], [19]) for name in WALKERS}
SIDES = "left and right are (exchanged|swapped)"


def cases(data: Path, quick: bool = False) -> Iterator[Case]:
    """Every case; three of three files where it is to be quick."""
    gait = data / "gait"
    records = {path.stem[:12]: path for path in (gait / "treadmill_walk_ik").glob("S01DE*.mot")}
    records |= {f"exotendon {path.stem[-27:-22]}": path for path in (gait / "exotendon_run").glob("*.mot")}
    every = itertools.chain(_young(gait), _treadmill(gait), opensim_cases(data), angle_cases(records))
    wanted = [("m for mm", "HC030A"), ("radians", "S01DE504"), ("another person", "HC030A")]
    for case in every:
        own = [pair for pair in wanted if pair[0] in case.fault and pair[1] in case.name]
        wanted = [pair for pair in wanted if pair not in own]
        if own or not quick:
            yield case


def held_back(data: Path) -> Iterator[Case]:
    """Cases in files that nothing was set on: the turns, another laboratory's walks, two treadmill files."""
    gait = data / "gait"
    yield from _young(gait, "turn")
    for path in sorted((gait / "opensim_walks" / "c3d_walk_noemg").glob("*.c3d")):
        case = _planter(path.stem, {"walk.c3d": path})
        yield case("numbers in m for mm", "looks like m", points_times, 1e-3)
        yield case("forces per kg", "per kg", analog, "^[FM]", 0.014)
        yield case("left and right swapped", SIDES, point_labels, _mirrored)
        yield case("plates swapped", r"follows the other|exchanged|cm from the nearest foot", in_plates)
    names = {"S01DN603": gait / "treadmill_walk_ik" / "S01DN603_ik.mot"}
    names |= {f"exotendon {path.parent.name}": path for path in (gait / "exotendon_run").glob("*/manual_ik.mot")}
    yield from angle_cases(names)


def _planter(name: str, files: Mapping[str, Path]) -> Callable[..., Case]:
    """Make a case of a fault, the words that have to be said, and what turns the file, with its arguments."""

    def case(fault: str, words: str, turn: Callable[..., None], *given: Any) -> Case:
        def plant(folder: Path) -> None:
            import ezc3d

            c3d = ezc3d.c3d(str(folder / "walk.c3d"))
            turn(c3d, *given)
            c3d.write(str(folder / "walk.c3d"))

        return Case(fault, name, files, plant, words)

    return case


def _young(gait: Path, kind: str = "straight") -> Iterator[Case]:
    for place, person in enumerate(WALKERS):
        walk = next((gait / "young_straight_and_turn" / person / kind).glob("*.c3d"))
        files = {"walk.c3d": walk, "static.c3d": static_file(gait, person)}
        case = _planter(person, files)
        measured = r"^(?!.*(Angles|Moment|Power|Force))"
        yield case("numbers in m for mm", "looks like m", points_times, 1e-3, measured)
        yield case("angles in radians for degrees", "may be in radians", points_times, 0.0174533, "Angles")
        yield case("EMG in V for mV", r"looks? like V", analog, "Voltage", 1.0, "mV")
        yield case("EMG in mV for V", r"looks? like mV", analog, "Voltage", 1e3)
        yield case("forces per kg", r"per kg", analog, "Force|Moment", 0.02)
        yield case("left and right swapped", SIDES, point_labels, _mirrored)
        yield case("legs swapped", "left and right", point_labels, lambda x: _mirrored(x) if LEG.match(x) else x)
        turned = r"flexion is (negative|positive)|reversed"
        yield case("knee's sign", turned, points_times, -1.0, "KneeAngles", slice(0, 1))
        yield case("plates swapped", r"follows the other|exchanged|cm from the nearest foot", in_plates)
        yield case("EMG channels exchanged", "exchanged", analog_exchanged, *LIVE[person])
        for other in (WALKERS[place - 1], WALKERS[place - 2]):

            def plant(folder, other=other):
                shutil.copyfile(static_file(gait, other), folder / "static.c3d")

            words = "another person|of this person"
            yield Case("static trial of another person", f"{person} with {other}", files, plant, words)


def in_plates(c3d: Any) -> None:
    """Exchange what two plates measured and leave where they lie."""
    analog_exchanged(c3d, range(6), range(6, 12))


def in_corners(c3d: Any) -> None:
    """Exchange where two plates lie and leave what they measured."""
    corners = c3d["parameters"]["FORCE_PLATFORM"]["CORNERS"]
    corners["value"] = corners["value"][:, :, [1, 0]]


def _mirrored(label: str) -> str:
    return RIGHT_LEFT.sub(lambda found: "L" if found[1] == "R" else "R", label)


def _treadmill(gait: Path) -> Iterator[Case]:
    case = _planter("treadmill C3D", {"walk.c3d": gait / "treadmill_c3d_emg" / "walking_1.c3d"})
    yield case("numbers in m for mm", "looks like m", points_times, 1e-3)
    yield case("EMG in V for mV", "looks? like V", analog, "Voltage", 1.0, "mV")
    yield case("EMG in mV for V", "looks? like mV", analog, "Voltage", 1e3)
    yield case("forces per kg", "per kg", analog, "Force|Moment", 0.014)
    yield case("left and right swapped", SIDES, point_labels, _mirrored)
    yield case("belts swapped", "exchanged|follows the other", in_corners)
    yield case("belts swapped", "exchanged|follows the other", in_plates)
