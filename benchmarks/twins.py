"""How often twins find what was planted, beside how often records of the truth do, simulated afresh.

    python benchmarks/twins.py OUT [--cases 20] [--records 20] [--seed 35]

Each case is a simulation of guards/systems with a weak effect of the catalogue in it, run by SciPy (benchmarks/
guards.py). Its first record is searched with twins; then so many records of the same trials with other noise are
searched. Where both rates come from one probability, Fisher's exact test gives p below .05 in one case of twenty. Only
cases whose first record names what is hidden are compared. OUT/answers.jsonl keeps each case that is done.
"""

from __future__ import annotations

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "studies"))
from command_line import argument, command_line

GIVEN = command_line(
    __name__,
    __doc__,
    argument("out", "where cases and answers go", Path("twins-out")),
    argument("--cases", "cases", 20),
    argument("--records", "twins, and fresh records, of each case", 20),
    argument("--seed", "of the cases", 35),
    argument("--trials", "of each record", 4),
    argument("--sizes", "of the effect, least and largest share of a rate", [0.01, 0.1]),
)  # before the slow imports

import time
from argparse import Namespace
from functools import partial
from typing import Any

import guard_cases
from guard_cases import make_case
from kept_answers import keep_answers
from scipy.stats import fisher_exact

import gaitdisc as gd


def compare_rates(number: int, given: Namespace) -> dict[str, Any]:
    """Search a case; where it names the truth, its twins and records of the truth too."""
    guard_cases.WEAK, guard_cases.TRIALS = tuple(given.sizes), given.trials
    folder, began = given.out / "cases" / f"term-{number:02d}", time.process_time()
    model, data = folder / "simulation.toml", folder / "measured.csv"
    truth = make_case("term", number, given.seed, folder)
    label = f"{truth['effect']}@{truth['port']}"
    found, _ = gd.discover(model, data)
    named = ", ".join(f"{one.name}@{one.place}" for one in found.effects) or found.verdict
    line = {"case": number, "truth": label, "named": named, "seconds": time.process_time() - began}
    if named != label:
        return line
    began = time.process_time()
    twins = gd.discover(model, data, twins=given.records)[0].twins
    if twins is None:
        return line
    line |= {"with twins": time.process_time() - began, "twins": twins.with_effects.get(label, 0)}
    line |= {"invented": sum(count for answer, count in twins.without.items() if "@" in answer)}
    fresh = []
    for again in range(1, given.records + 1):
        make_case("term", number, given.seed, folder, again)
        fresh.append(", ".join(f"{one.name}@{one.place}" for one in gd.discover(model, data)[0].effects))
    return line | {"fresh": fresh.count(label)}


if __name__ == "__main__":
    cases = ((number,) for number in range(GIVEN.cases))
    lines = keep_answers(GIVEN.out, cases, partial(compare_rates, given=GIVEN), ("case",))
    compared = [one for one in lines if "fresh" in one]
    for one in compared:
        _, p = fisher_exact([[one[key], GIVEN.records - one[key]] for key in ("twins", "fresh")])
        rates = f"twins {one['twins']}, fresh {one['fresh']} of {GIVEN.records}, p {p:.2g}"
        print(f"{one['case']:3d}  {one['truth']:28s} {rates}, invented {one['invented']}")
    print(f"{len(lines)} cases, {len(compared)} named what is hidden")
