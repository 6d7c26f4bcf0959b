"""A page of the report: blocks of sentences, figures and tables in a template; one file that needs nothing else."""

import os
import re
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any, Generic, TypeVar

from gaitdisc._version import __version__
from gaitdisc.own_files import note_outputs, under_this_guard
from gaitdisc.report.curve_panels import TEMPLATES
from gaitdisc.report.figure import Figure, SavedFigure, save_figures
from gaitdisc.report.table import Table, save_tables
from gaitdisc.whole_file import whole_file

Result = TypeVar("Result")
Shown = TypeVar("Shown", Figure, SavedFigure)
MOST_PROCESSES = 4  # that draw; each holds some 400 MB


def write_page(template: str, shown: Mapping[str, Any], folder: Path) -> Path:
    """Write `report.html` of a folder from what the template names, beside the version of this package."""
    with whole_file(folder / "report.html") as part:  # piece by piece: of 500 people some 100 MB
        _template(template).stream(version=__version__, **shown).dump(str(part), "utf-8")
    return folder / "report.html"


def page_text(template: str, shown: Mapping[str, Any]) -> str:
    """Page of a template and what it shows."""
    return _template(template).render(version=__version__, **shown)


@cache
def _template(name: str) -> Any:
    import jinja2

    templates = jinja2.Environment(
        loader=jinja2.FileSystemLoader(TEMPLATES),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    # numbers are bound to their units, so that no line breaks between them
    templates.filters["bound"] = lambda text: re.sub(r"(?<=\d) (?=(?:s|%|Hz)(?!\w))", "\u00a0", text)
    return templates.get_template(f"{name}.html.j2")


@dataclass(frozen=True, eq=False)
class Block(Generic[Shown]):
    """One part, as it is computed, or with its figures and tables on disk."""

    anchor: str
    heading: str
    sentences: tuple[str, ...]  # what the figures and tables say; a block without any is not shown
    figures: tuple[Shown, ...] = ()
    tables: tuple[Table, ...] = ()


def save_block(block: Block[Figure], folder: Path) -> Block[SavedFigure]:
    """Write the figures and tables of a part."""
    figures = tuple(save_figures(block.figures, folder))
    save_tables(block.tables, folder)
    return Block(block.anchor, block.heading, block.sentences, figures, block.tables)


def draw_side_by_side(draw: Callable[..., Result], each: Sequence[tuple[Any, ...]], alone: int) -> list[Result]:
    """Draw for each of many, in processes where there are more than so many.

    draw: can be sent to another process, as its arguments and what it gives
    alone: up to so many are drawn here, one after the other

    >>> draw_side_by_side(max, [(1, 2), (4, 3)], 2)
    [2, 4]
    """
    processes = min(os.cpu_count() or 1, MOST_PROCESSES, len(each))
    if len(each) <= alone or processes < 2:
        return [draw(*arguments) for arguments in each]
    from joblib import Parallel, delayed

    work = under_this_guard(draw)
    try:
        drawn: Any = Parallel(n_jobs=processes, backend="loky", inner_max_num_threads=1)(
            delayed(work)(*arguments) for arguments in each
        )
    except BrokenProcessPool:  # killed, mostly for its memory: one after the other takes the least
        drawn = None
    note_outputs()  # this command may write again what its processes wrote
    return [draw(*arguments) for arguments in each] if drawn is None else list(drawn)
