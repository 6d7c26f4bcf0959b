"""The page of a study of chapter 3: sentences, figures and tables, self-contained, with every number as CSV."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import gaitdisc
from gaitdisc.report.block import Block, save_block
from gaitdisc.report.page import templates
from gaitdisc.whole_file import write_whole


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
    text = templates().get_template("discrepancy.html.j2").render(
        title=title, about=about, blocks=saved, version=gaitdisc.__version__
    )  # fmt: skip
    return write_whole(folder / "report.html", text)
