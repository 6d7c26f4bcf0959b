"""Who names the hidden effect, and at which noise: `gaitdisc discover` beside the methods of chapter 3.

    python studies/ch3_who_names.py [FOLDER] [--quick] [--seeds 3] [--keep]
    python studies/ch3_who_names.py --print

All learn from the same samples, the first 60 %, and forecast the rest. Below stand what section 3.5 leaves open: one
state measured, a wrong parameter, a wrong start, random pushes. The answers at each noise and seed are a file in
FOLDER: a run that was stopped goes on. `--keep` writes `studies/ch3_who_names.csv`, which `--print` prints.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from command_line import KEPT, QUICK, argument, command_line

OUT, SEEDS = argument("folder", KEPT, Path("ch3_who_names")), argument("--seeds", "noise seeds", 3)
KEEP = argument("--keep", "write studies/ch3_who_names.csv as well", False)
PRINT = argument("--print", "compute nothing; print the table of what is kept", False)
GIVEN = command_line(__name__, __doc__, OUT, SEEDS, KEEP, PRINT, QUICK)  # before the slow imports

import numpy as np
import pandas as pd
from ch3_systems import biased_masses, lorenz, oscillators
from chapter3.cell import NOISES
from chapter3.methods import Method
from chapter3.naming import HiddenEffect, discover_answer, method_answer, namings_table, read_namings
from chapter3.pages import naming_figure, naming_table, written
from chapter3.record import Conditions, KnownRates, StochasticRates, recorded, system_of
from further import Result, result_text
from markdown_table import as_markdown

import gaitdisc as gd
from gaitdisc.report.page import Block
from gaitdisc.report.table import save_table

CELLS = Path(__file__).with_suffix(".csv")
NAMING: tuple[Method, ...] = ("sindy",)
CURVED = NOISES[1:3]
METHODS: tuple[Method, ...] = (*NAMING, "dmd", "gp", "nn")  # a curve is no name: one seed and two noises show that
MU, START, PUSH = 0.55, (0.6, 4.0), 0.02  # where 0.5 and (0.1, 5) are thought; and 1/s per sqrt(s)
CUBIC = ("y", "cubic_stiffness")


def cases(seed: int = 0) -> tuple[HiddenEffect, ...]:
    """Every case."""
    (hidden, code), (by_text, by_code), fast = oscillators().values(), biased_masses().values(), lorenz()
    text = gd.bundled_simulation("van_der_pol")
    alike, slow = system_of(text), system_of(gd.bundled_simulation("lorenz"))
    begun = replace(system_of(text, start=START), assumed=alike.start)
    pushed, both = (replace(s, true=StochasticRates(s.true, (0.0, PUSH), seed)) for s in (alike, hidden))
    cubic, gain = {"y": {"x**3": -0.01}}, ("x", "sensor_gain")
    damping = {"y": {"y": MU - 0.5, "x**2*y": 0.5 - MU}}
    mu = replace(alike, true=KnownRates(text.with_values({"mu": MU})))
    only = replace(hidden, observation=np.eye(2)[:1])
    return (
        HiddenEffect("Van der Pol, text", "−0.01 x³", hidden, CUBIC, 0.01, cubic),
        HiddenEffect("Van der Pol, code", "+0.01 x³", code, CUBIC, -0.01, {"y": {"x**3": 0.01}}),
        HiddenEffect("Lorenz", "+0.01 x³", fast, ("x", CUBIC[1]), -0.01, {"x": {"x**3": 0.01}}),
        HiddenEffect("biased mass, code", "gain 1.1", by_code, gain, 1.1, {"x": {"x": 0.1}}, "state", 20.0),
        HiddenEffect("biased mass, text", "gain 1.01", by_text, gain, 1.01, {"x": {"x": 0.01}}, "state", 20.0),
        HiddenEffect("Van der Pol, nothing hidden", "", alike),
        HiddenEffect("Lorenz, nothing hidden", "", slow),
        HiddenEffect("only x measured", "−0.01 x³", only, CUBIC, 0.01, cubic),
        HiddenEffect("only x measured, residual", "−0.01 x³", only, CUBIC, 0.01, cubic, "state"),
        HiddenEffect("wrong parameter", f"mu {MU} for 0.5", mu, ("mu", "wrong_parameter"), MU, damping),
        HiddenEffect("wrong start", "start of x, y", begun, ("x", "wrong_initial_condition"), START[0], {}, "state"),
        HiddenEffect("random pushes", "pushes of y", pushed, ("y", "process_noise")),
        HiddenEffect("random pushes and a cubic", "−0.01 x³", both, CUBIC, 0.01, cubic),
    )  # fmt: skip


def answers(noise: float, seed: int, quick: bool, path: Path) -> pd.DataFrame:
    """What everybody says of every case, or what is kept of it."""
    if not path.exists():
        found = []
        for hidden in cases(seed)[: 7 if quick else None]:
            record = recorded(hidden.system, Conditions(noise, seed, duration_s=hidden.duration_s))
            methods = METHODS if not quick and seed == 0 and noise in CURVED else NAMING
            found += [discover_answer(hidden, record), *(method_answer(hidden, record, each) for each in methods)]
        save_table(namings_table(found), path)
    return read_namings(path)


def run(quick: bool = False, folder: Path = Path("ch3_who_names"), seeds: int = 3) -> Result:
    """Ask everybody about every case: all noises of a seed before the next; without noise one seed."""
    pairs = [(NOISES[2], 0)] if quick else [(noise, seed) for seed in range(seeds) for noise in NOISES[seed > 0 :]]
    every = [answers(*pair, quick, folder / "answers" / f"{pair[0]:g}-{pair[1]}.csv") for pair in pairs]
    found = pd.concat(every, ignore_index=True)
    block = Block("names", "Who names it", (), (naming_figure(found, "names"),), (naming_table(found),))
    return written({}, [block], "Who names the hidden effect, sections 3.4 and 3.5", folder)


if __name__ == "__main__":
    if GIVEN.print:
        print(as_markdown(naming_table(read_namings(CELLS))))
    else:
        made = run(GIVEN.quick, GIVEN.folder, GIVEN.seeds)
        print(result_text(made))
        if GIVEN.keep:
            save_table(made.tables[0].numbers, CELLS)
