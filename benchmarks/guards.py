"""Guards of `gaitdisc discover`: nothing missing, random pushes, and laws that no effect of the catalogue is.

    python benchmarks/guards.py OUT [--seed 1] [--cases 25] [--kinds exact,pushed] [--limit 120]

Each case is a simulation of guards/systems, run by SciPy with a law, pushes or an error of the record that the file
lacks (guards/cases.toml). OUT/cases keeps simulation, record and truth; OUT/answers.jsonl gets one line a case, and
what stands there is not run again: stop it at any time. Right are: where nothing is missing `no_gap`, with errors of
the inputs whatever names no term, of a law outside the catalogue `unnamed` with its place, or a known effect that
leaves mere noise.
"""

from __future__ import annotations

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "studies"))
from command_line import argument, command_line

GIVEN = command_line(
    __name__,
    __doc__,
    argument("out", "where cases and answers go", Path("guards-out")),
    argument("--seed", "of the cases", 1),
    argument("--cases", "of each kind", 25),
    argument("--kinds", "which, with commas between", "all"),
    argument("--limit", "seconds for one case", 120),
)  # before the slow imports

import signal
import time
from collections import Counter
from typing import Any

import numpy as np
from guard_cases import CASES, make_case
from kept_answers import keep_answers

import gaitdisc as gd

WITHIN = 1.05  # times the sensors' noise, which a known effect may leave in the place of a law without a name
RIGHT = {
    "pushed": ("process_noise",),
    "inputs": ("no_gap", "unexplained", "input_error", "process_noise"),
    "hidden": ("no_gap", "wrong_initial_condition"),  # the record begins later than the file's start
}  # verdicts


def is_right(kind: str, truth: dict[str, Any], found: gd.Discovery) -> bool:
    """Whether an answer says what is hidden, and no more."""
    named = [(one.name, one.place) for one in found.effects]
    if kind == "pushed_term":
        return named == [(truth["effect"], truth["port"])]
    if kind == "outside":
        left = max(after / truth["sd"][channel] for channel, (_, after, _) in found.held_out.channels.items())
        equal = found.verdict == "unnamed" or (len(named) == 1 and left < WITHIN)
        return equal and {place for _, place in named} == {truth["port"]}
    return found.verdict in RIGHT.get(kind, ("no_gap",))


def ask(kind: str, number: int) -> dict[str, Any]:
    """Make a case, answer it and return the line about it."""
    folder = GIVEN.out / "cases" / f"{kind}-{number:02d}"
    truth, began = make_case(kind, number, GIVEN.seed, folder), time.monotonic()
    signal.alarm(GIVEN.limit)
    try:
        found, _ = gd.discover(folder / "simulation.toml", folder / "measured.csv")
    except (gd.GaitdiscError, TimeoutError) as refusal:
        answer = {"verdict": type(refusal).__name__, "right": False, "sentence": str(refusal)}
    else:
        named = [f"{one.name}@{one.place}" for one in found.effects]
        rivals = [[f"{e.name}@{e.place}" for e in one.effects] for one in found.explanations]
        gap = (found.held_out.before, found.held_out.after, found.held_out.noise_floor)
        answer = {"verdict": found.verdict, "right": is_right(kind, truth, found), "named": named, "gap": gap}
        answer |= {"p": found.held_out.p, "explanations": rivals, "sentence": found.sentence}
    signal.alarm(0)
    return {"kind": kind, "number": number, "seconds": time.monotonic() - began} | answer | {"truth": truth}


def stop(*_: object) -> None:
    """End a case that takes too long."""
    raise TimeoutError("out of time")


def print_table(lines: list[dict[str, Any]]) -> None:
    """Say of each kind how many answers are right, and what the others said."""
    for kind in CASES["kinds"]:
        some = [one for one in lines if one["kind"] == kind]
        others = Counter(" ".join([one["verdict"], *one.get("named", [])]) for one in some if not one["right"])
        if some:
            seconds, right = np.median([one["seconds"] for one in some]), sum(one["right"] for one in some)
            said = "; ".join(f"{count} {what}" for what, count in others.most_common())
            print(f"{kind:12s} {len(some):3d} {right:3d} {100 * right / len(some):5.1f} % {seconds:6.1f} s  {said}")


if __name__ == "__main__":
    signal.signal(signal.SIGALRM, stop)
    kinds = [one for one in CASES["kinds"] if one != "term"] if GIVEN.kinds == "all" else GIVEN.kinds.split(",")
    cases = ((kind, number) for number in range(GIVEN.cases) for kind in kinds)
    print_table(keep_answers(GIVEN.out, cases, ask, ("kind", "number")))
