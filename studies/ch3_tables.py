"""Tables of section 3.4 as the docs hold them, from the cells that `ch3_seeds.py` measured; nothing is computed.

    python studies/ch3_tables.py TABLE

TABLE is `recommended`, `evidence`, `rankings`, or a set of `ch3_seeds.py` with the number that is shown:
`lorenz:valid`, `lorenz:jump`, `van_der_pol_text:forecast`; `all` for each of them. Where a number has two starts,
`estimated` is a state estimated from the noisy measurement; the true state is an oracle.
"""

from __future__ import annotations

from itertools import combinations

from command_line import argument, command_line

TABLE = argument("table", "recommended, evidence, rankings, SET:NUMBER, or all")
GIVEN = command_line(__name__, __doc__, TABLE)  # before the slow imports

import numpy as np
import pandas as pd
from chapter3.cell import FOUR_METHODS as FOUR
from chapter3.kept_cells import (
    FURTHER,
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

ALPHA = 0.05
RANKED = {
    "van_der_pol_text": ("forecast", "Van der Pol, text [% less RMSE]"),
    "van_der_pol_code": ("forecast", "Van der Pol, code [% less RMSE]"),
    "lorenz": ("valid", "Lorenz, valid [Lyapunov times]"),
}


def rankings(table: pd.DataFrame) -> str:
    """Methods paired by noise seed, or by start over its seeds; the pairs of one cell are a family (Holm-Sidak)."""
    rows, counts = [], set()
    for name, (number, words) in RANKED.items():
        column, factor, parts = NUMBERS[number]
        for part, noise in [(part, noise) for part in parts for noise in (0.001, 0.01, 0.1)]:
            some = table[(table["noise"] == noise) & (table["part"] == part)]
            own, further = some[some["set"] == name], some[some["set"].str.startswith(name + FURTHER)]
            for by, found in (("seed", own), ("set", further)):
                if len(found):
                    values = factor * found.pivot_table(index=by, columns="method", values=column)[list(FOUR)]
                    counts.add(len(values))
                    each = f"{(seeds := found['seed'].nunique())} seed{'s' * (seeds > 1)} each"
                    begun = "its own" if by == "seed" else f"{len(values)} others, {each}"
                    said = [f"{value:.1f}" for value in values.median()]
                    rows.append(
                        (words, f"{noise:.1%}", begun, START_WORDS[part], len(values), *said, differing(values))
                    )
    heads = ("system", "noise", "starts", "forecast from", "n", *(METHOD_WORDS[one] for one in FOUR), "differ")
    return "\n".join([markdown_table(" | ".join(heads), rows), "", *(f"- {least(n)}" for n in sorted(counts))])


def differing(values: pd.DataFrame) -> str:
    """The pairs of one cell's methods that differ beyond chance: which is ahead, with its corrected p."""
    pairs = list(combinations(values.columns, 2))
    ahead = [(values[one] - values[other]).dropna().to_numpy() for one, other in pairs]
    corrected = gd.holm_sidak([exact_p(each) for each in ahead])
    said = [
        f"{' > '.join(METHOD_WORDS[each] for each in (pair if np.median(gain) > 0 else pair[::-1]))} (p {p:.2g})"
        for pair, gain, p, differs in zip(pairs, ahead, corrected.adjusted, corrected.rejected, strict=True) if differs
    ]  # fmt: skip
    return "; ".join(said) or "none"


def least(n: int) -> str:
    """What n pairs can reject, by the p of ranks 1 to k against."""
    pairs = len(list(combinations(FOUR, 2)))
    needed = 1 - (1 - ALPHA) ** (1 / pairs)
    p = [exact_p(np.array([-rank if rank <= against else rank for rank in range(1, n + 1)])) for against in range(n)]
    most = sum(each <= needed for each in p) - 1
    return (
        f"n = {n}: least p {p[0]:.2g}, {1 - (1 - p[0]) ** pairs:.2g} over the {pairs} pairs of a cell; a difference is "
        f"seen first at p <= {needed:.2g}: no more than {most} of {n}, the smallest, go against it"
    )


NAMED = {
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
