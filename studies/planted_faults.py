"""How many planted faults of meaning are found with the right words, and how many clean walks raise a false alarm.

    python studies/planted_faults.py [DATA] [--only WORD] [--held-back] [--quick]

DATA holds gait and opensim_gait10dof; by default ../shared/data. Each case is a copy of real files in which one meaning
is turned: mm for m, degrees for radians, left for right. It is given to what a user runs: `check` of a study and, where
there is a static trial, `moments`. Found: a new warning or refusal (or a note that it was turned back) has the words.
"""

from __future__ import annotations

from command_line import QUICK, SHARED, argument, command_line

GIVEN = command_line(
    __name__,
    __doc__,
    argument("data", "folder of the real recordings", SHARED),
    argument("--only", "only faults whose name has this word", type=str, default=""),
    argument("--held-back", "cases in files that nothing was set on", False),
    QUICK,
)  # before the slow imports

import re
import shutil
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

from fault_cases import cases, held_back
from faults_of_meaning import Case

import gaitdisc as gd
from gaitdisc.commands.moments import moments
from gaitdisc.ingest.study import Conditions, Participant, PlannedTrial, Quality, Study
from gaitdisc.processing.inspection import inspected_study

TURNED_BACK = ("knee sign", "per body mass")  # notes that say that the reader set a fault right
ALARM = re.compile(
    r"swapped|exchanged|mirrored|looks? like|another person|another shape|states? (degrees|radians)|per kg of body "
    r"mass, though|of another foot|share one time base|counts|knee sign|follows the other foot|beside the nearest foot"
)


class Outcome(NamedTuple):
    """What came of one case."""

    case: Case
    found: bool
    said: list[str]


def outcomes(data: Path, only: str = "", quick: bool = False, kept: bool = False) -> tuple[list[Outcome], list[str]]:
    """Every case, those held back where they are asked for, and the alarms of the same walks untouched."""
    clean: dict[tuple[Path, ...], set[str]] = {}
    found, alarms = [], []
    for case in held_back(data) if kept else cases(data, quick):
        if only not in case.fault:
            continue
        key = tuple(case.files.values())
        if key not in clean:
            clean[key] = set(_said(case, planted=False))
            alarms += [f"{case.name}: {line}" for line in clean[key] if _alarm(line)]
        said = [line for line in _said(case) if line not in clean[key]]
        found.append(Outcome(case, any(re.search(case.words, line) for line in said), said))
    return found, alarms


def _alarm(line: str) -> bool:
    return ALARM.search(line) is not None and not line.startswith("note")


def _said(case: Case, planted: bool = True) -> list[str]:
    """Warnings, refusals and notes of what was turned back, of all that a user would run."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for file, source in case.files.items():
            shutil.copyfile(source, folder / file)
        if planted:
            case.plant(folder)
        walk = [file for file in case.files if not file.startswith("static")]
        static = [file for file in case.files if file.startswith("static")]
        return _checked(case, folder, walk, static) + (_moments(folder, walk, static[0]) if static else [])


def _checked(case: Case, folder: Path, walk: Sequence[str], static: Sequence[str]) -> list[str]:
    trials = [PlannedTrial(condition="walking", files=tuple(walk), crop_s=case.crop_s)]
    trials += [PlannedTrial(condition="static", files=(one,)) for one in static]
    study = Study(
        conditions=Conditions(nominal="walking"),
        participants=(Participant(id="P01", trials=tuple(trials)),),
        quality=Quality(min_strides=1),
    ).placed(folder)
    lines = []
    for seen in inspected_study(study):
        lines += [seen.refusal] * bool(seen.refusal)
        lines += [f.line() for f in seen.findings if f.severity != "note" or f.kind in TURNED_BACK]
    return lines


def _moments(folder: Path, walk: Sequence[str], static: str) -> list[str]:
    lines: list[str] = []
    try:
        for line in _printed(folder, walk, static):
            lines += [line] if line.startswith("warning") or "plate step" in line else []
    except gd.GaitdiscError as error:
        lines.append(str(error))
    return lines


def _printed(folder: Path, walk: Sequence[str], static: str) -> list[str]:
    import contextlib
    import io

    text = io.StringIO()
    with contextlib.redirect_stdout(text):
        mass = None if static.endswith(".c3d") else 72.6
        moments([folder / one for one in walk], folder / static, folder / "moments.mot", mass)
    return text.getvalue().splitlines()


def table(found: Sequence[Outcome]) -> list[tuple[str | int, ...]]:
    """Fault, cases, found with the right words, with others, not found."""
    rows: list[tuple[str | int, ...]] = []
    for fault in dict.fromkeys(one.case.fault for one in found):
        own = [one for one in found if one.case.fault == fault]
        right = sum(one.found for one in own)
        others = sum(not one.found and bool(one.said) for one in own)
        rows.append((fault, len(own), right, others, len(own) - right - others))
    return [*rows, ("all", *(sum(int(row[i]) for row in rows) for i in range(1, 5)))]


def main() -> None:
    """Print the table, the false alarms and what was missed."""
    found, alarms = outcomes(GIVEN.data, GIVEN.only, GIVEN.quick, GIVEN.held_back)
    print("| fault | n | found | other words | not found |\n|---|---|---|---|---|")
    for row in table(found):
        print(f"| {' | '.join(map(str, row))} |")
    walks = len({tuple(one.case.files.values()) for one in found})
    print(f"\nfalse alarms on the {walks} walks untouched: {len(alarms)}", *alarms, sep="\n  ")
    for one in found:
        if not one.found:
            print(f"missed: {one.case.fault}, {one.case.name}: {one.said[0][:220] if one.said else 'nothing said'}")


if __name__ == "__main__":
    main()
