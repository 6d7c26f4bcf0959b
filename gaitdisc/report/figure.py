"""A figure of the report: the numbers, how they are drawn, and the words that go with them."""

from __future__ import annotations

import base64
import io
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import pandas as pd

from gaitdisc.report.curve_panels import ROW
from gaitdisc.report.panels import in_style
from gaitdisc.report.table import save_table
from gaitdisc.whole_file import write_whole

if TYPE_CHECKING:
    import matplotlib.figure

LARGEST_INLINE_SVG = 600_000  # bytes; a larger figure is shown as a picture, its SVG lies beside the report
INLINE_BYTES = 4_000_000  # of all figures of a page together, about; beyond it they are shown as pictures
PNG_DOTS_PER_INCH = 150
PNG_COLOURS = 96


@dataclass(frozen=True, eq=False)
class Figure:
    """What is drawn, with all that a reader needs to use it."""

    name: str
    caption: str  # what is seen, with n, unit and split
    alt: str  # what is seen, for those who cannot see it
    numbers: pd.DataFrame  # the very numbers drawn
    drawn: matplotlib.figure.Figure | str  # as SVG where no PNG is written beside


@dataclass(frozen=True)
class SavedFigure:
    """A figure on disk and as data in the page."""

    name: str
    caption: str
    alt: str
    data: str
    width: float  # natural width [px at 96 dots per inch]


def save_figure(figure: Figure, folder: Path, inline_bytes: int = LARGEST_INLINE_SVG) -> SavedFigure:
    """Write the figure as SVG and PNG, and the numbers drawn as CSV; drawing again gives the same bytes.

    figure: what to save; its drawing is closed for further use
    inline_bytes: largest SVG that is shown in the page; beyond it the smaller of SVG and PNG is
    """
    if isinstance(figure.drawn, str):
        write_whole(folder / f"{figure.name}.svg", figure.drawn)
        save_table(figure.numbers, folder / f"{figure.name}.csv")
        return SavedFigure(figure.name, figure.caption, figure.alt, inline_drawing(figure.drawn, inline_bytes), ROW)
    # each axis measures its ticks to place its label, even one without words
    for axes in figure.drawn.axes:
        for axis in (axes.xaxis, axes.yaxis):
            if not axis.get_label_text():
                axis.set_label_coords(0.5, 0.0)
    svg, png = _svg(figure.drawn), _png(figure.drawn)
    for ending, content in (("svg", svg), ("png", png)):
        write_whole(folder / f"{figure.name}.{ending}", content)
    save_table(figure.numbers, folder / f"{figure.name}.csv")
    data = data_uri("svg+xml", svg) if len(svg) <= max(inline_bytes, len(png)) else data_uri("png", png)
    return SavedFigure(figure.name, figure.caption, figure.alt, data, 96 * figure.drawn.get_figwidth())


def inline_drawing(svg: str, inline_bytes: int) -> str:
    """Drawing of panels as data in a page; where that would be too large, without single cycles."""
    small = svg if len(svg) <= inline_bytes else re.sub(r'<path class="single"[^>]*/>', "", svg)
    return data_uri("svg+xml", small.encode())


def data_uri(kind: str, content: bytes) -> str:
    """Picture of a kind (`png`, `svg+xml`) as it stands in a page."""
    return f"data:image/{kind};base64,{base64.b64encode(content).decode('ascii')}"


def largest_inline(figures: int) -> int:
    """Largest SVG [bytes] that is shown in a page of so many figures."""
    return min(LARGEST_INLINE_SVG, INLINE_BYTES // max(1, figures))


def save_figures(figures: Iterable[Figure], folder: Path, inline_bytes: int = LARGEST_INLINE_SVG) -> list[SavedFigure]:
    """Write figures into the folder `figures/` of a report."""
    return [save_figure(figure, folder / "figures", inline_bytes) for figure in figures]


def file_names(participants: Sequence[str]) -> dict[str, str]:
    """Part of a file name for every participant: letters, digits, `-` and `_`, no two alike.

    >>> file_names(["P 1", "P/1"])
    {'P 1': 'P_1', 'P/1': 'P_1-2'}
    """
    names: dict[str, str] = {}
    for participant in participants:
        plain = re.sub(r"[^A-Za-z0-9_-]", "_", participant) or "_"
        taken, count, name = {n.lower() for n in names.values()}, 1, plain
        while name.lower() in taken:
            count += 1
            name = f"{plain}-{count}"
        names[participant] = name
    return names


@in_style
def _svg(drawn: matplotlib.figure.Figure) -> bytes:
    stream = io.StringIO()
    nothing = dict.fromkeys(("Date", "Creator", "Format", "Type"))
    drawn.savefig(stream, format="svg", metadata=nothing, dpi=PNG_DOTS_PER_INCH)
    text = re.sub(r"<!DOCTYPE[^>]*>\s*", "", stream.getvalue())
    # a hundredth of a point cannot be seen, and the digits beyond it are half of the page
    text = re.sub(r'(?<= d=")[^"]+(?=")', lambda path: re.sub(r"(?<=\.\d\d)\d+", "", path.group()), text)
    return text.encode("utf-8")


@in_style
def _png(drawn: matplotlib.figure.Figure) -> bytes:
    from PIL import Image

    stream = io.BytesIO()
    drawn.savefig(stream, format="rgba", dpi=PNG_DOTS_PER_INCH)
    width = round(drawn.get_figwidth() * PNG_DOTS_PER_INCH)
    pixels = stream.getvalue()
    few = (
        Image.frombytes("RGBA", (width, len(pixels) // (4 * width)), pixels)
        .convert("RGB")
        .quantize(PNG_COLOURS, method=Image.Quantize.FASTOCTREE, dither=Image.Dither.NONE)
    )
    small = io.BytesIO()
    few.save(small, format="png", compress_level=6, dpi=(PNG_DOTS_PER_INCH, PNG_DOTS_PER_INCH))
    return small.getvalue()
