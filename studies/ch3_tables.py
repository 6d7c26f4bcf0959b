"""Tables of section 3.4 as README and docs hold them, from the cells that `ch3_seeds.py` measured; nothing is computed.

    python studies/ch3_tables.py TABLE

TABLE is `readme`, `recommended`, `evidence`, `rankings`, or a set of `ch3_seeds.py` with the number that is shown:
`lorenz:valid`, `lorenz:jump`, `van_der_pol_text:forecast`; `all` for each of them. Where a number has two starts,
`estimated` is a state estimated from the noisy measurement; the true state is an oracle.
"""

from __future__ import annotations

from itertools import combinations

from command_line import argument, command_line

TABLE = argument("table", "readme, recommended, evidence, rankings, SET:NUMBER, or all")
GIVEN = command_line(__name__, __doc__, TABLE)  # before the slow imports

import numpy as np
import pandas as pd
from chapter3.cell import FORECAST, ORACLE
from chapter3.kept_cells import (
    NUMBERS,
    START_WORDS,
    evidence_table,
    measured,
    recommended_table,
    set_table,
    sets_tables,
)
from chapter3.pages import METHOD_WORDS
from markdown_table import markdown_table

import gaitdisc as gd
from gaitdisc.statistics.signed_rank import exact_p

IN_README = ("sindy", "dmd", "gp", "nn")
RANKED = {"van_der_pol_text": "forecast", "van_der_pol_code": "forecast", "lorenz": "valid"}


def readme_table(table: pd.DataFrame) -> str:
    """Van der Pol in short: medians from the estimated start, in brackets from the true state."""
    of_set, rows = table[table["set"] == "van_der_pol_text"], []
    noises = sorted(of_set["noise"].unique())
    for method in IN_README:
        said = []
        for noise in noises:
            some = of_set[(of_set["method"] == method) & (of_set["noise"] == noise)]
            one, other = (float(np.median(some.loc[some["part"] == part, "accuracy"])) for part in (FORECAST, ORACLE))
            said.append(f"{one:.1f} ({other:.1f})")
        rows.append((METHOD_WORDS[method], *said))
    words = ["no noise" if noise == 0 else f"{100 * noise:g} %" for noise in noises]
    return markdown_table(" | ".join(("Van der Pol with a hidden cubic spring", *words)), rows)


def rankings(table: pd.DataFrame) -> str:
    """Methods paired by noise seed, forecast accuracy (on Lorenz valid time): the pairs that differ beyond chance."""
    pairs = []
    for name, number in RANKED.items():
        column, factor, parts = NUMBERS[number]
        for part, noise in [(part, noise) for part in parts for noise in (0.001, 0.01, 0.1)]:
            some = table[(table["set"] == name) & (table["noise"] == noise) & (table["part"] == part)]
            by_seed = some.pivot_table(index="seed", columns="method", values=column)
            for one, other in combinations(("sindy", "gp", "nn"), 2):
                ahead = factor * (by_seed.loc[:, one] - by_seed.loc[:, other]).dropna().to_numpy()
                what = f"{name}, {noise:.1%} noise, {START_WORDS[part]}: {METHOD_WORDS[one]} against"
                size = f"{np.median(ahead):+.2g} {'Lyapunov times' if number == 'valid' else 'points'}"
                pairs.append((exact_p(ahead), f"{what} {METHOD_WORDS[other]} {size} in the median, n = {len(ahead)}"))
    corrected = gd.holm_sidak([p for p, _ in pairs])
    sure = [
        f"{said}, p = {p:.3g} ({p_corrected:.2g} corrected)"
        for (p, said), p_corrected, differs in zip(pairs, corrected.adjusted, corrected.rejected, strict=True)
        if differs
    ]
    counted = f"{len(pairs)} pairs; beyond chance (signed rank, Holm-Sidak) differ {len(sure)}"
    return "\n".join(f"- {line}" for line in (counted, *sure))


NAMED = {
    "readme": ("In short", readme_table),
    "rankings": ("Rankings", rankings),
    "recommended": ("What `recommend` answers", recommended_table),
    "evidence": ("What it answers from", evidence_table),
}


def printed(name: str) -> str:
    """A table by its name."""
    table = measured()
    if name == "all":
        return "\n".join([*(f"## {words}\n\n{made(table)}" for words, made in NAMED.values()), sets_tables(table)])
    return NAMED[name][1](table) if name in NAMED else set_table(table, *name.split(":"))


if __name__ == "__main__":
    print(printed(GIVEN.table))
