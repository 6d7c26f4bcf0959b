"""What studies of chapters have in common: their result and its page, tables computed one by one, kept, and printed."""

from __future__ import annotations

import sys
import time
import warnings
from argparse import Namespace
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
from markdown_table import as_markdown, markdown_table
from matplotlib.axes import Axes
from matplotlib.ticker import LogLocator, NullFormatter

from gaitdisc.report.page import Block, save_block
from gaitdisc.report.page import write_page as write_report
from gaitdisc.report.table import Table, save_table


class Number(NamedTuple):
    """One number of a table; those of one row and column differ in `who`: a person, a walk, a seed, a fold."""

    row: str
    column: str
    who: str
    value: float


class Made(NamedTuple):
    """A table: how it is computed, quickly or whole; its heading says unit and split, and `of` what n counts."""

    computed: Callable[[bool], Iterator[Number]]
    heading: str
    of: str = "people"


def main(given: Namespace, tables: Mapping[str, Made], kept: Path) -> None:
    """Compute the tables that are not in the folder, print all of them, and keep them where that is wanted."""
    if given.print:
        print(printed(read(kept), given.print, tables[given.print]))
        return
    given.folder.mkdir(parents=True, exist_ok=True)
    for name in given.tables:
        place = given.folder / f"{name}.csv"
        if not place.exists():
            begun = time.process_time()
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                found = pd.DataFrame(tables[name].computed(given.quick)).assign(table=name)
            save_table(found[["table", *Number._fields]], place)
            print(f"{name}: {time.process_time() - begun:.0f} s of processor time", file=sys.stderr, flush=True)
    every = {name: read(given.folder / f"{name}.csv") for name in tables if (given.folder / f"{name}.csv").exists()}
    print("\n\n".join(printed(found, name, tables[name]) for name, found in every.items()))
    if given.keep:  # in place of what was kept of these tables; the others stay
        others = [read(kept).query("table not in @every")] if kept.exists() else []
        save_table(pd.concat([*every.values(), *others], ignore_index=True), kept)


def read(path: Path) -> pd.DataFrame:
    """Kept numbers; a row may be called null."""
    return pd.read_csv(path, keep_default_na=False, na_values={"value": [""]})


def printed(found: pd.DataFrame, name: str, made: Made) -> str:
    """One table: median [least, greatest], and how many numbers that is of where it is not one."""
    some = found[found["table"] == name]
    columns, rows = dict.fromkeys(some["column"]), []
    for row in dict.fromkeys(some["row"]):
        own = some[some["row"] == row]
        cells = [own.loc[own["column"] == column, "value"].to_numpy(float) for column in columns]
        rows.append((str(row), *(_said(values, made.of) for values in cells)))
    return markdown_table(" | ".join((made.heading, *map(str, columns))), rows)


def _said(values: np.ndarray, of: str) -> str:
    known = values[np.isfinite(values)]
    if not len(values):
        return ""
    if not len(known):
        return "diverged"
    lost = f", {len(values) - len(known)} diverged" * (len(known) < len(values))
    if len(known) == 1:
        return f"{known[0]:.3g}{lost}"
    return f"{np.median(known):.3g} [{known.min():.3g}, {known.max():.3g}], n = {len(known)} {of}{lost}"


class Result(NamedTuple):
    """A study that has a page."""

    cells: Any  # what was computed
    tables: tuple[Table, ...]
    page: Path


def write_page(cells: Any, blocks: Sequence[Block], title: str, about: str, folder: Path) -> Result:
    """Write page, figures, tables, and all tables once more as Markdown."""
    folder.mkdir(parents=True, exist_ok=True)
    saved = [save_block(block, folder) for block in blocks]
    page = write_report("blocks", {"title": title, "about": f"Ebers 2023, {about}", "blocks": saved}, folder)
    text = "\n\n".join(f"{block.heading}\n\n{as_markdown(table)}" for block in blocks for table in block.tables)
    (folder / "tables.md").write_text(text + "\n", encoding="utf-8")
    return Result(cells, tuple(table for block in blocks for table in block.tables), page)


def result_text(result: Result) -> str:
    """Every table of a study's result below its caption, and where its page is."""
    return "\n\n".join([*(f"{one.caption}\n\n{as_markdown(one)}" for one in result.tables), str(result.page)])


def decades(axes: Axes) -> None:
    """Make the vertical axis logarithmic, with plain numbers at 1, 2 and 5 of every decade."""
    axes.set_yscale("log")
    axes.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axes.yaxis.set_major_formatter(lambda value, _: f"{value:g}")
    axes.yaxis.set_minor_formatter(NullFormatter())
