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
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

from fault_cases import cases, held_back
from faults_of_meaning import Case
from markdown_table import markdown_table
from said_of_files import said_of

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
    """Every case, those held back where they are wanted, and the alarms of the same walks untouched."""
    clean: dict[tuple[Path, ...], set[str]] = {}
    found, alarms = [], []
    for case in held_back(data) if kept else cases(data, quick):
        if only not in case.fault:
            continue
        key = tuple(case.files.values())
        if key not in clean:
            clean[key] = set(said_of(case, planted=False))
            alarms += [f"{case.name}: {line}" for line in clean[key] if _alarm(line)]
        said = [line for line in said_of(case) if line not in clean[key]]
        found.append(Outcome(case, any(re.search(case.words, line) for line in said), said))
    return found, alarms


def _alarm(line: str) -> bool:
    return ALARM.search(line) is not None and not line.startswith("note")


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
    print(markdown_table("fault | n | found | other words | not found", table(found)))
    walks = len({tuple(one.case.files.values()) for one in found})
    print(f"\nfalse alarms on the {walks} walks untouched: {len(alarms)}", *alarms, sep="\n  ")
    for one in found:
        if not one.found:
            print(f"missed: {one.case.fault}, {one.case.name}: {one.said[0][:220] if one.said else 'nothing said'}")


if __name__ == "__main__":
    main()
