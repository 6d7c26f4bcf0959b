"""How many planted faults of meaning are found with the right words, and how many clean walks raise a false alarm.

    python studies/planted_faults.py [DATA] [--only WORD] [--held-back] [--quick]

DATA holds gait and opensim_gait10dof. Each case is a copy of real files in which one meaning is turned: mm for m,
degrees for radians, left for right. It is given to what a user runs: `check` of a study and, where there is a static
trial, `moments`. Found: a new warning or refusal (or a note that it was turned back) has the words.
"""

from __future__ import annotations

from command_line import QUICK, RECORDINGS, argument, command_line

ONLY = argument("--only", "only faults whose name has this word", "")
HELD_BACK = argument("--held-back", "cases in files that nothing was set on", False)
GIVEN = command_line(__name__, __doc__, RECORDINGS, ONLY, HELD_BACK, QUICK)  # before the slow imports

import contextlib
import io
import re
import shutil
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

from fault_cases import cases, held_back
from faults_of_meaning import Case
from markdown_table import markdown_table

import gaitdisc as gd
from gaitdisc.commands.moments import moments
from gaitdisc.ingest.study import Conditions, Participant, PlannedTrial, Quality, Study
from gaitdisc.processing.inspection import inspect_study

TURNED_BACK = ("knee sign", "per body mass")  # notes that say that the reader set a fault right

ALARM = re.compile(
    r"swapped|exchanged|mirrored|looks? like|another person|another shape|states? (degrees|radians)|per kg of body "
    r"mass, contrary|of another foot|have one time base|counts|knee sign|follows the other foot|from the nearest foot"
)


class Outcome(NamedTuple):
    """What came of one case."""

    case: Case
    found: bool
    said: list[str]


def said_of(case: Case, planted: bool = True) -> list[str]:
    """Warnings, refusals and notes of what was turned back, by `check` and, with a static trial, by `moments`."""
    with tempfile.TemporaryDirectory() as name:
        folder, text, lines = Path(name), io.StringIO(), []
        for file, source in case.files.items():
            shutil.copyfile(source, folder / file)
        if planted:
            case.plant(folder)
        walk = [file for file in case.files if not file.startswith("static")]
        static = [file for file in case.files if file.startswith("static")]
        trials = [PlannedTrial(condition="walking", files=tuple(walk), crop_s=case.crop_s)]
        trials += [PlannedTrial(condition="static", files=(one,)) for one in static]
        person, few = Participant(id="P01", trials=tuple(trials)), Quality(min_strides=1)
        study = Study(conditions=Conditions(nominal="walking"), participants=(person,), quality=few)
        for seen in inspect_study(study.placed(folder)):
            lines += [seen.refusal] * bool(seen.refusal)
            lines += [f.line() for f in seen.findings if f.severity != "note" or f.kind in TURNED_BACK]
        for one in static:
            with contextlib.redirect_stdout(text):
                try:
                    moments([folder / file for file in walk], folder / one, folder / "moments.mot", None)
                except gd.GaitdiscError as error:
                    text.write(f"warning: {error}\n")
        return lines + [one for one in text.getvalue().splitlines() if one.startswith("warning") or "plate step" in one]


def outcomes(data: Path, only: str = "", quick: bool = False, kept: bool = False) -> tuple[list[Outcome], list[str]]:
    """Every case, those held back where they are wanted, and the alarms of the same walks untouched."""
    clean: dict[tuple[Path, ...], set[str]] = {}
    found, alarms = [], []
    for case in held_back(data) if kept else cases(data, quick):
        if only not in case.fault:
            continue
        key = tuple(case.files.values())
        if key not in clean:
            clean[key] = set(said_of(case, planted=False))
            said = (line for line in clean[key] if ALARM.search(line) and not line.startswith("note"))
            alarms += [f"{case.name}: {line}" for line in said]
        said = [line for line in said_of(case) if line not in clean[key]]
        found.append(Outcome(case, any(re.search(case.words, line) for line in said), said))
    return found, alarms


def table(found: Sequence[Outcome]) -> list[tuple[str | int, ...]]:
    """Fault, cases, found with the right words, with others, not found."""
    rows: list[tuple[str | int, ...]] = []
    for fault in dict.fromkeys(one.case.fault for one in found):
        own = [one for one in found if one.case.fault == fault]
        right = sum(one.found for one in own)
        others = sum(not one.found and bool(one.said) for one in own)
        rows.append((fault, len(own), right, others, len(own) - right - others))
    return [*rows, ("all", *(sum(int(row[i]) for row in rows) for i in range(1, 5)))]


if __name__ == "__main__":
    found, alarms = outcomes(GIVEN.data, GIVEN.only, GIVEN.quick, GIVEN.held_back)
    print(markdown_table("fault | n | found | other words | not found", table(found)))
    walks = len({tuple(one.case.files.values()) for one in found})
    print(f"\nfalse alarms on the {walks} walks untouched: {len(alarms)}", *alarms, sep="\n  ")
    for one in found:
        if not one.found:
            print(f"missed: {one.case.fault}, {one.case.name}: {one.said[0][:220] if one.said else 'nothing said'}")
