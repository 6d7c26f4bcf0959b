"""How often twins find what was planted, beside how often records of the truth do, simulated afresh.

    python benchmarks/twins.py OUT [--cases 20] [--records 20] [--seed 35]

Each case is a simulation of guards/systems with a weak effect of the catalogue in it, run by SciPy (benchmarks/
guards.py). Its first record is searched with twins; then so many records of the same trials with other noise are
searched. Where both rates come from one probability, Fisher's exact test gives p below .05 in one case of twenty. Cases
whose first record names nothing have no twins with the effect. OUT/answers.jsonl keeps each case that is done.
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
)  # before the slow imports

import json
import time
from typing import Any

from guard_cases import make_case
from scipy.stats import fisher_exact

import gaitdisc as gd


def compare_rates(number: int) -> dict[str, Any]:
    """Search a case with twins, then records of its truth."""
    folder, began = GIVEN.out / "cases" / f"term-{number:02d}", time.process_time()
    model, data = folder / "simulation.toml", folder / "measured.csv"
    truth = make_case("term", number, GIVEN.seed, folder)
    label = f"{truth['effect']}@{truth['port']}"
    found, _ = gd.discover(model, data)
    alone, began = time.process_time() - began, time.process_time()
    found, _ = gd.discover(model, data, twins=GIVEN.records)
    twins, seconds = found.twins, time.process_time() - began
    fresh = []
    for again in range(1, GIVEN.records + 1):
        make_case("term", number, GIVEN.seed, folder, again)
        fresh.append(", ".join(f"{one.name}@{one.place}" for one in gd.discover(model, data)[0].effects))
    line = {"case": number, "truth": label, "seconds": alone, "with twins": seconds, "fresh": fresh.count(label)}
    if twins is None:
        return line | {"named": "no twins"}
    invented = sum(count for answer, count in twins.without.items() if "@" in answer)
    return line | {"named": twins.named, "twins": twins.with_effects.get(label), "invented": invented}


if __name__ == "__main__":
    answers = GIVEN.out / "answers.jsonl"
    GIVEN.out.mkdir(parents=True, exist_ok=True)
    answers.touch()
    lines = [json.loads(line) for line in answers.read_text(encoding="utf-8").splitlines()]
    for number in range(len(lines), GIVEN.cases):
        lines.append(compare_rates(number))
        with answers.open("a", encoding="utf-8") as file:
            file.write(json.dumps(lines[-1]) + "\n")
    count = GIVEN.records
    for one in lines:
        rates = f"fresh {one['fresh']} of {count}"
        if one["named"] == one["truth"]:
            table = [[kept, count - kept] for kept in (one["twins"] or 0, one["fresh"])]
            _, p = fisher_exact(table)
            rates += f", twins {one['twins'] or 0} of {count}, p {p:.2g}"
        print(f"{one['case']:3d}  {one['truth']:28s} named {one['named']:36s} {rates}, invented {one.get('invented')}")
