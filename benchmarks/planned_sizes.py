"""The planned size of an effect, beside the size from which on fresh records of the truth show it.

    python benchmarks/planned_sizes.py OUT [--cases 40] [--records 10] [--seed 35]

A simulation of guards/systems is run by SciPy with nothing hidden: that is the pilot record. From it `find_power` plans
how large a friction, a drag or an offset must be. Then it is hidden, in sizes about the planned one, in records of the
same trials with other noise, and the size that is found in 19 of 20 is read from these in the same way (probit).
OUT/answers.jsonl keeps each case that is done.
"""

from __future__ import annotations

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "studies"))
from command_line import argument, command_line

GIVEN = command_line(
    __name__,
    __doc__,
    argument("out", "where cases and answers go", Path("planned-out")),
    argument("--cases", "cases", 40),
    argument("--records", "of each size", 10),
    argument("--seed", "of the cases", 35),
)  # before the slow imports

import time
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
import pandas as pd
from guard_cases import CASES, NOISE, SETTLING, Model, draw_share, draw_trials, write_record
from kept_answers import keep_answers

from gaitdisc.discovery.catalogue import ALL
from gaitdisc.discovery.discover import discover
from gaitdisc.discovery.power import Power, find_power
from gaitdisc.simulation.measured_table import read_measured
from gaitdisc.simulation.simulation_file import read_simulation

EFFECTS = (  # system, effect, place, law of size 1; without a law it is added to what the sensor reads
    ("sled", "quadratic_drag", "force", "-v*abs(v)"),
    ("motor", "quadratic_drag", "shaft", "-speed*abs(speed)"),
    ("sled", "sensor_offset", "v", ""),
    ("motor", "sensor_offset", "speed", ""),
    ("motor", "coulomb_friction", "shaft", "-sign(speed)"),
    ("joint", "coulomb_friction", "moment", "-sign(omega)"),
)
AROUND = (0.45, 0.6, 0.77, 1.0, 1.3, 1.7)  # times the planned size


def compare_sizes(number: int, seed: int, out: Path, records: int) -> dict[str, Any]:
    """Plan from a record without the effect, and find from which size on records of the truth show it."""
    rng, began = np.random.default_rng([seed, number]), time.process_time()
    name, effect, place, law = EFFECTS[number % len(EFFECTS)]
    system, model = CASES["systems"][name], Model(name)
    trials = draw_trials(system, model, int(rng.integers(2, 4)), rng)
    folder = out / "cases" / f"{number:02d}"
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "simulation.toml").write_text(model.text, encoding="utf-8")
    read, level = read_simulation(folder / "simulation.toml"), draw_share(NOISE, rng)
    skipped = int(SETTLING * system["seconds"] * system["rate"])
    model.port, runs = place if law else "", [pd.DataFrame(model.run(one), columns=model.states) for one in trials]
    sd = level * pd.concat(runs)[model.channels].std()

    def record(some: list[pd.DataFrame], draw: int) -> Any:
        noise = np.random.default_rng([seed, number, draw])
        seen = [{key: run[key] + sd[key] * noise.standard_normal(len(run)) for key in sd.index} for run in some]
        write_record(folder / "measured.csv", trials, seen, skipped)
        return read_measured(folder / "measured.csv", read)

    label = f"{effect}@{place}"
    (plan,) = find_power(read, record(runs, 0), replace(ALL, effects=(label,), twins=records))
    line: dict[str, Any] = {"number": number, "system": name, "effect": label, "trials": len(trials), "noise": level}
    line |= {"sizes": plan.sizes, "found": plan.found, "planned": plan.least, "planned in": time.process_time() - began}
    if not np.isfinite(plan.least):
        return line
    found, sizes = [], tuple((plan.least * np.array(AROUND)).tolist())
    for turn, size in enumerate(sizes):
        model.law = compile(f"{size}*({law or 0.0})", label, "eval")
        runs, count = [pd.DataFrame(model.run(one), columns=model.states) for one in trials], 0
        for run in runs:
            run[place if not law else model.states[0]] += 0.0 if law else size
        for again in range(records):
            with np.errstate(over="ignore", invalid="ignore"):
                said, _ = discover(read, record(runs, 1 + turn * records + again), ALL)
            count += [f"{one.name}@{one.place}" for one in said.effects if not one.small] == [label]
        found.append(count)
    true = Power(label, plan.number, plan.unit, sizes, tuple(found), records)
    return line | {
        "fresh sizes": sizes,
        "fresh found": found,
        "true": true.least,
        "seconds": time.process_time() - began,
    }


if __name__ == "__main__":
    cases = ((number,) for number in range(GIVEN.cases))
    compare = partial(compare_sizes, seed=GIVEN.seed, out=GIVEN.out, records=GIVEN.records)
    lines = keep_answers(GIVEN.out, cases, compare, ("number",))
    ratios = [one["true"] / one["planned"] for one in lines if np.isfinite(one.get("true", np.nan))]
    within = sum(1 / 1.3 <= one <= 1.3 for one in ratios)
    print(f"{len(lines)} cases, {len(ratios)} with both sizes, within a factor 1.3: {within}; found over planned:")
    print(" ".join(f"{one:.2f}" for one in sorted(ratios)))
