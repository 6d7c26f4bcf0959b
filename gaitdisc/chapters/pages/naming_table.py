"""Table of who names what is hidden, by case and noise."""

from __future__ import annotations

from collections.abc import Sequence

import pandas as pd

from gaitdisc.chapters.discrepancy.naming import Naming, namings_table
from gaitdisc.report.table import Table

MOST_WORDS = 120  # characters of an answer
TOOL_WORDS = {"discover": "discover", "sindy": "SINDy", "dmd": "DMD", "gp": "Gaussian process", "nn": "network"}


def naming_table(namings: Sequence[Naming], name: str) -> Table:
    """What each tool answers, a row a case and noise."""
    table = namings_table(namings)
    tools = [tool for tool in TOOL_WORDS if tool in set(table["tool"])]
    rows = []
    for (case, noise), found in table.groupby(["case", "noise"], sort=False):
        cells = [_said(found[found["tool"] == tool]) for tool in tools]
        rows.append((str(case), str(found["hidden"].iloc[0]) or "nothing", f"{noise:.1%}", *cells))
    rows.sort(key=lambda row: list(dict.fromkeys(table["case"])).index(row[0]))
    caption = (
        "Answers, with how many of the seeds gave them; × the true number: median of the seeds that named it. Of a "
        "curve: how far it is from what is missing, along the record without noise (first seed)."
    )
    return Table(
        name, caption, ("case", "hidden", "noise", *(TOOL_WORDS[t] for t in tools)), tuple(rows), table
    )  # fmt: skip


def seeds_of(found: pd.DataFrame) -> tuple[str, float]:
    """Most frequent answer of the seeds, `right` where it is, and its share.

    Parameters
    ----------
    found : DataFrame
        Rows of one case, tool and noise.

    Examples
    --------
    >>> seeds_of(pd.DataFrame({"right": [True, False, True], "answer": ["named", "curve", "named"]}))
    ('right', 0.6666666666666666)
    """
    kinds = found["answer"].where(~found["right"], "right")
    counts = kinds.value_counts(sort=False)
    return str(counts.idxmax()), float(counts.max() / len(kinds))


def _said(found: pd.DataFrame) -> str:
    if not len(found):
        return ""
    counts = found["answer"].value_counts(sort=False)
    some = [f"{answer} {count}/{len(found)}" if count < len(found) else str(answer) for answer, count in counts.items()]
    amounts = found["amount"].dropna()
    words = ", ".join(some)
    if len(amounts):
        words += f" (× {amounts.median():.4g})"
    first = str(found["said"].iloc[0]).split(";")[0]
    shown = found["answer"].iloc[0] in ("curve", "refused") and len(first) < MOST_WORDS
    return f"{words}: {first}" if shown else words
