"""The page of a study: blocks of sentences, figures and tables, self-contained, with every number as CSV."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from gaitdisc.report.block import Block, save_block
from gaitdisc.report.page import write_page
from gaitdisc.report.table import as_markdown
from gaitdisc.whole_file import write_whole


def write_blocks(title: str, about: str, blocks: Sequence[Block], folder: Path) -> Path:
    """Write a page of blocks: `report.html`, `figures/` and `tables/`."""
    saved = [save_block(block, folder) for block in blocks]
    return write_page("blocks", {"title": title, "about": about, "blocks": saved}, folder)


def write_markdown(blocks: Sequence[Block], folder: Path) -> Path:
    """Write all tables of a page once more as Markdown, each under the heading of its block: `tables.md`."""
    text = "\n\n".join(f"{block.heading}\n\n{as_markdown(table)}" for block in blocks for table in block.tables)
    return write_whole(folder / "tables.md", text + "\n")
