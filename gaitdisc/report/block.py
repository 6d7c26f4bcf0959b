"""A part of the page over all participants: what it says, then figures and tables."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from gaitdisc.report.figure import Figure, SavedFigure, save_figures
from gaitdisc.report.table import Table, save_tables


@dataclass(frozen=True, eq=False)
class Block:
    """One part, as it is computed."""

    anchor: str
    heading: str
    sentences: tuple[str, ...]  # what the figures and tables say; a block without any is not shown
    figures: tuple[Figure, ...] = ()
    tables: tuple[Table, ...] = ()


@dataclass(frozen=True, eq=False)
class SavedBlock:
    """One part, with its figures and tables on disk."""

    anchor: str
    heading: str
    sentences: tuple[str, ...]
    figures: tuple[SavedFigure, ...]
    tables: tuple[Table, ...]


def save_block(block: Block, folder: Path) -> SavedBlock:
    """Write the figures and tables of a part."""
    figures = tuple(save_figures(block.figures, folder))
    save_tables(block.tables, folder)
    return SavedBlock(block.anchor, block.heading, block.sentences, figures, block.tables)
