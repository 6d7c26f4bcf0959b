"""What the four studies of chapter 3 have in common: their result, and the parts of their pages."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from ch3_statements import Cells, Stated, answered, of_figures
from chapter3.discrepancy_cell import RECONSTRUCTION
from chapter3.pages import (
    accuracy_figure,
    cost_figure,
    error_figure,
    grid_table,
    horizon_figure,
    statements_table,
    system_figure,
)
from chapter3.recommend import measured_cells
from chapter3.system import System

from gaitdisc.report.page import Block, write_blocks, write_markdown
from gaitdisc.report.table import Table, save_table

ARTEFACT = (
    "As published, SINDy's map for the residual is integrated as if it gave a rate, from zero, and added; the map "
    "itself is evaluated in the cells done right. That is why the chapter finds that SINDy learns no residual."
)


@dataclass(frozen=True, eq=False)
class Result:
    """A study of chapter 3."""

    cells: Cells
    tables: tuple[Table, ...]
    page: Path


def blocks_of(
    cells: Cells, figures: Mapping[str, str], stated: Sequence[Stated], systems: Mapping[str, System] | None = None
) -> list[Block]:
    """Parts of a page: a variant each, with the figures that the chapter has."""
    statements = [(where, words, answered(cells, approach, noise)) for where, words, approach, noise in stated]
    statements += of_figures(cells, figures)
    blocks = [Block("stated", "What the chapter states", (ARTEFACT,), tables=(statements_table(statements, "stated"),))]
    for number, (variant, found) in enumerate(cells.items(), 1):
        quiet = [cell for cell in found if cell.noise == 0]
        drawn = []
        if systems and variant in systems:
            truth, system = quiet[0].parts[RECONSTRUCTION].truth, systems[variant]
            missing = system.true(truth) - system.known(truth)
            drawn.append(system_figure(quiet[0], missing, f"system-{number}", figures["system"]))
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


def written(cells: Cells, blocks: Sequence[Block], title: str, folder: Path) -> Result:
    """Write page, figures, tables, and all tables once more as Markdown."""
    folder.mkdir(parents=True, exist_ok=True)
    page = write_blocks(title, "Ebers 2023, chapter 3, computed anew.", blocks, folder)
    tables = tuple(table for block in blocks for table in block.tables)
    write_markdown(blocks, folder)
    measured = [cell for found in cells.values() for cell in found if cell.approach == "dynamics"]
    if measured:
        save_table(measured_cells(measured), folder / "measured_cells.csv")
    return Result(cells, tables, page)
