"""Pages of the studies of chapter 3: figures by variant, and what the chapter states beside what the cells answer."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from gaitdisc.report.page import Block, write_blocks, write_markdown
from gaitdisc.report.table import Table, save_table

from . import pages
from .discrepancy_cell import FORECAST, ORACLE, RECONSTRUCTION, DiscrepancyCell
from .recommend import measured_cells
from .system import System

Cells = Mapping[str, tuple[DiscrepancyCell, ...]]
Stated = tuple[str, str, str, float]  # where, statement, approach, noise
APART = "the time evolution diverges quickly with only an eps-small difference in the dynamics"
COST = "SINDy costs least, then DMD, GPR and NN, in both approaches; NN in the dynamics over 500 s, up to 2,100 s"
HORIZON = "dynamics: near 100 % at first, falls at the first jump (about 5 s), settles near 0"
HORIZONS_S = (0.3, 1.0, 5.0, 20.0)
ARTEFACT = (
    "As published, SINDy's map for the residual is integrated as if it gave a rate, from zero, and added; the map "
    "itself is evaluated in the cells done right. That is why the chapter finds that SINDy learns no residual."
)


def of_figures(cells: Cells, figures: Mapping[str, str]) -> list[tuple[str, str, str]]:
    """Answer the statements that captions make, of the figures that a study has."""
    own = (("system", APART, apart_words), ("horizon", HORIZON, horizon_words), ("cost", COST, cost_words))
    return [(figures[key], words, answer(cells)) for key, words, answer in own if key in figures]


def apart_words(cells: Cells) -> str:
    """Say how long the known system stays near the true one, by variant."""
    said = []
    for variant, found in cells.items():
        part = next(c.parts[RECONSTRUCTION] for c in found if c.parts and not c.noise)
        said.append(f"{variant}: within 0.4 SD for {part.valid_s('known'):.1f} of {part.time[-1]:.0f} s")
    return "; ".join(said)


def cost_words(cells: Cells) -> str:
    """Seconds of a core of each method, cheapest first, by approach: median over variants, noises and seeds."""
    said = []
    for approach in ("dynamics", "state"):
        some = [c for found in cells.values() for c in found if c.approach == approach and c.parts]
        spent = {m: np.median([c.fit_s + c.run_s for c in some if c.method == m]) for m in {c.method for c in some}}
        ordered = sorted(spent.items(), key=lambda item: item[1])
        said.append(
            f"{approach}: " + ", ".join(f"{pages.METHOD_WORDS[method]} {seconds:.1f} s" for method, seconds in ordered)
        )
    return "; ".join(said)


def horizon_words(cells: Cells) -> str:
    """Say how much less error the forecasts have within a few horizons, without noise, by variant and method."""
    said = []
    for variant, found in cells.items():
        quiet = [c for c in found if c.approach == "dynamics" and c.parts and not c.noise]
        some = [f"{pages.METHOD_WORDS[c.method]} {_within(c)}" for c in quiet]
        said.append(f"{variant}: " + ", ".join(some))
    horizons = "; ".join(f"{each:g}" for each in HORIZONS_S)
    return f"[%] from the estimated start, within {horizons} s; " + "; ".join(said)


def _within(cell: DiscrepancyCell) -> str:
    part = cell.parts[FORECAST]
    changes = part.change([each for each in HORIZONS_S if each <= part.time[-1]])
    said = f"diverged at t = {part.diverged_s:.2f} s" if part.diverged_s is not None else ""
    return "/".join([f"{each:.0f}" if np.isfinite(each) else said for each in changes])


def answered(cells: Cells, approach: str, noise: float) -> str:
    """Forecast (oracle; reconstruction) accuracy of each method, by variant: median and range over seeds."""
    said = []
    for variant, found in cells.items():
        some = [c for c in found if c.approach == approach and c.noise == noise]
        parts = [f"{pages.METHOD_WORDS[m]} {_accuracy([c for c in some if c.method == m])}" for m in pages.METHOD_WORDS]
        if some:
            said.append(f"{variant}: {', '.join(part for part in parts if not part.endswith(' '))}")
    return (
        "forecast from the estimated start (from the true state, an oracle; reconstruction) [%]; " + "; ".join(said)
        if said
        else "not computed"
    )


def _accuracy(cells: Sequence[DiscrepancyCell]) -> str:
    fitted = [cell for cell in cells if cell.parts]
    if not fitted:
        return "not fitted" if cells else ""
    words = []
    for part in (FORECAST, ORACLE, RECONSTRUCTION):
        lost = [t for c in fitted if (t := c.parts[part].diverged_s) is not None]
        said = pages.spread_words(np.array([np.median(c.parts[part].accuracy()) for c in fitted]))
        some = f" ({len(lost)} of {len(cells)} seeds)" * (len(cells) > 1)
        words.append(f"diverged at t = {min(lost):.2f} s{some}" if lost else said)
    return f"{words[0]} ({words[1]}; {words[2]})"


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
    blocks = [
        Block("stated", "What the chapter states", (ARTEFACT,), tables=(pages.statements_table(statements, "stated"),))
    ]
    for number, (variant, found) in enumerate(cells.items(), 1):
        quiet = [cell for cell in found if cell.noise == 0]
        drawn = []
        if systems and variant in systems:
            truth, system = quiet[0].parts[RECONSTRUCTION].truth, systems[variant]
            missing = system.true(truth) - system.known(truth)
            drawn.append(pages.system_figure(quiet[0], missing, f"system-{number}", figures["system"]))
        for approach in ("dynamics", "state"):
            some = [cell for cell in quiet if cell.approach == approach and cell.parts]
            if approach in figures and some:
                drawn.append(pages.error_figure(some, f"{approach}-{number}", figures[approach]))
        drawn.append(pages.accuracy_figure(found, f"noise-{number}", figures["noise"]))
        if "horizon" in figures:
            drawn.append(pages.horizon_figure(quiet, f"horizon-{number}", figures["horizon"]))
        if "cost" in figures:
            drawn.append(pages.cost_figure(found, f"cost-{number}", figures["cost"]))
        blocks.append(
            Block(f"variant-{number}", variant, (), tuple(drawn), (pages.grid_table(found, f"cells-{number}"),))
        )
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
