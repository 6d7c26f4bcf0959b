"""The page of a study of chapter 3: sentences, figures and tables, self-contained, with every number as CSV."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from gaitdisc.report.block import Block, save_block
from gaitdisc.report.page import write_page


def write_blocks(title: str, about: str, blocks: Sequence[Block], folder: Path) -> Path:
    """Write a page of blocks: `report.html`, `figures/` and `tables/`.

    Parameters
    ----------
    title, about : str
        Of the page.
    blocks : sequence of Block
        In order.
    folder : Path
        Where it goes; made if missing.

    Raises
    ------
    WriteError
        If a file cannot be written.
    """
    saved = [save_block(block, folder) for block in blocks]
    return write_page("discrepancy", {"title": title, "about": about, "blocks": saved}, folder)
