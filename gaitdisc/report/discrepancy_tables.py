"""Tables of chapter 3: every cell of the grid, and what the dissertation states beside what was found."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import pandas as pd

from gaitdisc.report.discrepancy_figure import METHOD_WORDS
from gaitdisc.report.table import Table
from gaitdisc.results.discrepancy_cell import DiscrepancyCell, PartAccuracy, cells_table

MOST_TERMS = 110  # characters


def grid_table(cells: Sequence[DiscrepancyCell], name: str) -> Table:
    """Accuracy of every cell, a row a method, approach and noise; the median of the seeds.

    Parameters
    ----------
    cells : sequence of DiscrepancyCell
        Of one system.
    name : str
        Of the CSV.
    """
    groups: dict[tuple, list[DiscrepancyCell]] = {}
    for cell in cells:
        groups.setdefault((cell.variant, cell.approach, cell.method, cell.noise), []).append(cell)
    rows = []
    for (variant, approach, method, noise), found in groups.items():
        parts = [[c.parts[part] for c in found if c.parts] for part in ("reconstruction", "forecast")]
        rows.append((
            variant, approach, METHOD_WORDS[method], f"{noise:g}", *(_cell(each) for each in parts),
            _median([p.valid_s("augmented") for p in parts[1]], "{:.1f}"),
            _median([p.valid_s("known") for p in parts[1]], "{:.1f}"),
            f"{np.median([c.fit_s for c in found]):.1f}", f"{np.median([c.run_s for c in found]):.1f}",
            found[0].refused or _short(found[0].terms),
        ))  # fmt: skip
    columns = (
        "variant", "approach", "method", "noise", "reconstruction [%]", "forecast [%]", "valid [s]", "known valid [s]",
        "fit [s]", "run [s]", "found (first seed)",
    )  # fmt: skip
    caption = (
        "100 (1 − RMSE augmented / RMSE known) by channel, unclipped, against the noise-free truth; median of "
        f"n = {max(len(found) for found in groups.values())} seeds at most. Valid: until the error passes 0.4 standard "
        "deviations."
    )
    return Table(name, caption, columns, tuple(rows), cells_table(cells))


def _cell(parts: list[PartAccuracy]) -> str:
    if not parts:
        return "not fitted"
    diverged = [part.diverged_s for part in parts if part.diverged_s is not None]
    if diverged:
        return f"diverged at {min(diverged):.2f} s" + (f" ({len(diverged)} of {len(parts)} seeds)" * (len(parts) > 1))
    accuracy = np.median([part.accuracy() for part in parts], axis=0)
    if len(accuracy) > 4:
        return f"{np.median(accuracy):.1f} (median of {len(accuracy)})"
    return "; ".join(f"{value:.1f}" if math.isfinite(value) else "nothing to mend" for value in accuracy)


def _median(values: list[float], form: str) -> str:
    return form.format(float(np.median(values))) if values else ""


def _short(text: str) -> str:
    return text if len(text) <= MOST_TERMS else f"{text[:MOST_TERMS]}… ({text.count('*')} products)"


def statements_table(statements: Sequence[tuple[str, str, str]], name: str) -> Table:
    """What the dissertation states, and what was found.

    Parameters
    ----------
    statements : sequence of (str, str, str)
        Place, statement, ours.
    name : str
        Of the CSV.
    """
    columns = ("where", "dissertation", "ours")
    caption = "The dissertation's statements beside what was found here."
    return Table(name, caption, columns, tuple(statements), pd.DataFrame(list(statements), columns=pd.Index(columns)))


def as_markdown(table: Table) -> str:
    """Return a table as documents of the project hold it.

    Parameters
    ----------
    table : Table
        Any.

    Examples
    --------
    >>> print(as_markdown(statements_table([("3.4", "a", "b")], "s")))
    | where | dissertation | ours |
    |---|---|---|
    | 3.4 | a | b |
    """
    rows = ["| " + " | ".join(table.columns) + " |", "|" + "---|" * len(table.columns)]
    return "\n".join(
        [*rows, *("| " + " | ".join(cell.replace("\n", " ") for cell in row) + " |" for row in table.rows)]
    )
