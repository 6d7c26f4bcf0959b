"""What the four studies of chapter 3 have in common: their result, and the parts of their pages."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from gaitdisc.discrepancy.recommend import measured_cells
from gaitdisc.report.block import Block
from gaitdisc.report.discrepancy_figure import (
    METHOD_WORDS,
    accuracy_figure,
    cost_figure,
    error_figure,
    horizon_figure,
    system_figure,
)
from gaitdisc.report.discrepancy_page import write_blocks
from gaitdisc.report.discrepancy_tables import as_markdown, grid_table, spread_words, statements_table
from gaitdisc.report.table import Table, save_table
from gaitdisc.results.discrepancy_cell import DiscrepancyCell
from gaitdisc.whole_file import write_whole

Cells = Mapping[str, tuple[DiscrepancyCell, ...]]
Stated = tuple[str, str, str, float]  # where, statement, approach, noise
ARTEFACT = (
    "As published, SINDy's map for the residual is integrated as if it gave a rate, from zero, and added; the map "
    "itself is evaluated in the cells done right. That is why the chapter finds that SINDy learns no residual."
)


@dataclass(frozen=True, eq=False)
class Result:
    """A study of chapter 3.

    Parameters
    ----------
    cells : mapping of str to tuple of DiscrepancyCell
        By variant.
    tables : tuple of Table
        Of the page.
    page : Path
        The report.
    """

    cells: Cells
    tables: tuple[Table, ...]
    page: Path


def blocks_of(cells: Cells, figures: Mapping[str, str], stated: Sequence[Stated]) -> list[Block]:
    """Parts of a page: a variant each, with the figures that the chapter has.

    Parameters
    ----------
    cells : mapping
        By variant.
    figures : mapping of str to str
        Figure of the dissertation by `system`, `dynamics`, `state`, `noise`, `horizon`, `cost`.
    stated : sequence of Stated
        Statements to answer.
    """
    statements = [(where, words, answered(cells, approach, noise)) for where, words, approach, noise in stated]
    blocks = [Block("stated", "What the chapter states", (ARTEFACT,), tables=(statements_table(statements, "stated"),))]
    for number, (variant, found) in enumerate(cells.items(), 1):
        quiet = [cell for cell in found if cell.noise == 0]
        drawn = []
        if "system" in figures:
            whole = quiet[0].parts["reconstruction"]
            drawn.append(system_figure(whole, quiet[0].channels, f"system-{number}", figures["system"]))
        for approach in ("dynamics", "state"):
            some = [cell for cell in quiet if cell.approach == approach and cell.parts]
            if approach in figures and some:
                drawn.append(error_figure(some, f"{approach}-{number}", figures[approach]))
        drawn.append(accuracy_figure(found, f"noise-{number}", figures["noise"]))
        if "horizon" in figures:
            drawn.append(horizon_figure(quiet, f"horizon-{number}", figures["horizon"]))
        if "cost" in figures:
            drawn.append(cost_figure(found, f"cost-{number}", figures["cost"]))
        blocks.append(Block(f"variant-{number}", variant, (), tuple(drawn), (grid_table(found, f"cells-{number}"),)))
    return blocks


def answered(cells: Cells, approach: str, noise: float) -> str:
    """Forecast (reconstruction) accuracy of each method, by variant: median and range over seeds.

    Parameters
    ----------
    cells : mapping
        By variant.
    approach : str
        `dynamics` or `state`.
    noise : float
        Level.
    """
    said = []
    for variant, found in cells.items():
        some = [c for c in found if c.approach == approach and c.noise == noise]
        parts = [f"{METHOD_WORDS[m]} {_accuracy([c for c in some if c.method == m])}" for m in METHOD_WORDS]
        if some:
            said.append(f"{variant}: {', '.join(part for part in parts if not part.endswith(' '))}")
    return "forecast (reconstruction) [%]; " + "; ".join(said) if said else "not computed"


def _accuracy(cells: Sequence[DiscrepancyCell]) -> str:
    fitted = [cell for cell in cells if cell.parts]
    if not fitted:
        return "not fitted" if cells else ""
    words = []
    for part in ("forecast", "reconstruction"):
        lost = [t for c in fitted if (t := c.parts[part].diverged_s) is not None]
        said = spread_words(np.array([np.median(c.parts[part].accuracy()) for c in fitted]))
        words.append(f"diverged at t = {min(lost):.2f} s ({len(lost)} of {len(cells)} seeds)" if lost else said)
    return f"{words[0]} ({words[1]})"


def written(cells: Cells, blocks: Sequence[Block], title: str, folder: Path) -> Result:
    """Write page, figures, tables, and all tables once more as Markdown.

    Parameters
    ----------
    cells : mapping
        By variant.
    blocks : sequence of Block
        Of the page.
    title : str
        Of the page.
    folder : Path
        Where it goes.
    """
    folder.mkdir(parents=True, exist_ok=True)
    page = write_blocks(title, "Ebers 2023, chapter 3, computed anew.", blocks, folder)
    tables = tuple(table for block in blocks for table in block.tables)
    text = "\n\n".join(f"{block.heading}\n\n{as_markdown(t)}" for block in blocks for t in block.tables)
    write_whole(folder / "tables.md", text + "\n")
    measured = [
        cell for name, found in cells.items() for cell in found if "dt" not in name and cell.approach == "dynamics"
    ]
    if measured:
        save_table(measured_cells(measured), folder / "measured_cells.csv")
    return Result(cells, tables, page)
