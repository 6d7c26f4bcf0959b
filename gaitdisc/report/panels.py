"""Panels in rows and columns in the report's own style; the same thing looks the same, also in grey print.

Left red, right blue; Nominal orange, Augmented green, Exo grey; SHRED blue, SDN green, linear orange. Every colour has
a line style or a mark of its own, so that grey print and colour-blind readers lose nothing.
"""

from __future__ import annotations

import functools
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal, ParamSpec, TypeVar

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    import matplotlib.figure
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes

STYLE = {
    "svg.hashsalt": "gaitdisc",
    "svg.fonttype": "none",
    "font.family": "sans-serif",
    "font.sans-serif": ["DejaVu Sans", "Arial", "Helvetica", "sans-serif"],
    "font.size": 8.0,
    "text.parse_math": False,
    "axes.titlesize": 8.0,
    "axes.titley": 1.0,  # no title looks for its place among the ticks, which costs a tenth of the drawing
    "axes.labelsize": 7.5,
    "xtick.labelsize": 7.0,
    "ytick.labelsize": 7.0,
    "legend.fontsize": 8.0,
    "legend.frameon": False,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.linewidth": 0.6,
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "axes.formatter.useoffset": False,
    "axes.unicode_minus": True,
    "path.simplify_threshold": 0.2,
}
WIDTH = 8.0  # inch; as wide as the text of the page
Item = TypeVar("Item")
Result = TypeVar("Result")
Arguments = ParamSpec("Arguments")


@dataclass(frozen=True)
class Room:
    """Room around and between panels."""

    left: float = 0.75  # margin of the figure [inch]
    right: float = 0.12  # margin of the figure [inch]
    top: float = 0.55  # margin of the figure, in which the legend stands [inch]
    bottom: float = 0.45  # margin of the figure [inch]
    across: float = 0.75  # between two columns [inch]
    down: float = 0.42  # between two rows [inch]


def panels(rows: int, columns: int, height: float, room: Room) -> tuple[matplotlib.figure.Figure, list[list[Axes]]]:
    """Empty panels of equal size, in rows and columns, each of a height [inch]."""
    from matplotlib.figure import Figure as Drawing

    figure_height = room.top + rows * height + (rows - 1) * room.down + room.bottom
    width = (WIDTH - room.left - room.right - (columns - 1) * room.across) / columns
    drawn = Drawing(figsize=(WIDTH, figure_height))
    grid = [
        [
            drawn.add_axes(
                (
                    (room.left + column * (width + room.across)) / WIDTH,
                    1 - (room.top + row * (height + room.down) + height) / figure_height,
                    width / WIDTH,
                    height / figure_height,
                )
            )
            for column in range(columns)
        ]
        for row in range(rows)
    ]
    return drawn, grid


def panels_for(count: int, columns: int, height: float, room: Room) -> tuple[matplotlib.figure.Figure, list[Axes]]:
    """Panels of a height [inch] for so many things, row by row, in so many columns at most."""
    columns = min(columns, count)
    drawn, grid = panels(-(-count // columns), columns, height, room)
    cells = [axes for row in grid for axes in row]
    for axes in cells[count:]:
        axes.set_visible(False)
    return drawn, cells[:count]


def legend(drawn: matplotlib.figure.Figure, handles: Sequence[Artist], down: float = 0.0) -> None:
    """Write one row of a legend above all panels, so far below the figure's top [inch]."""
    top = (0.5, 1.0 - down / drawn.get_figheight())
    drawn.legend(handles=list(handles), loc="upper center", ncols=len(handles), bbox_to_anchor=top)


def legend_lines(looks: Mapping[str, Look | Mapping[str, Any]]) -> list[Artist]:
    """Handles of a legend that explains lines by their look, or lines and marks by the style that each is drawn in."""
    from matplotlib.lines import Line2D

    plain = {w: {"color": k.colour, "linestyle": k.line} if isinstance(k, Look) else k for w, k in looks.items()}
    return [Line2D([], [], label=words, **style) for words, style in plain.items()]


def in_style(draw: Callable[Arguments, Result]) -> Callable[Arguments, Result]:
    """Let a function draw in the report's style, whatever the user's own style is."""

    @functools.wraps(draw)
    def styled(*args: Arguments.args, **kwargs: Arguments.kwargs) -> Result:
        import matplotlib as mpl

        with mpl.rc_context():
            mpl.rcdefaults()
            mpl.rcParams.update(STYLE)  # type: ignore[arg-type]
            return draw(*args, **kwargs)

    return styled


def sheets(items: Sequence[Item], most: int, name: str) -> dict[str, list[Item]]:
    """Split what would make too long a figure into parts of nearly equal length, numbered where there are several.

    >>> sheets("abcdef", 4, "r2")
    {'r2-1': ['a', 'b', 'c'], 'r2-2': ['d', 'e', 'f']}
    >>> sheets("abc", 4, "r2")
    {'r2': ['a', 'b', 'c']}
    """
    if not items:
        return {}
    count = -(-len(items) // most)
    parts = [[items[i] for i in part] for part in np.array_split(np.arange(len(items)), count)]
    return {f"{name}-{i}": part for i, part in enumerate(parts, 1)} if count > 1 else {name: parts[0]}


def draw_box(
    axes: Axes,
    values: NDArray[np.float64],
    place: float,
    colour: str,
    orientation: Literal["vertical", "horizontal"] = "vertical",
) -> None:
    """Draw a box of finite values (participant,) whose whiskers reach the smallest and the largest of them."""
    line = {"color": colour, "linewidth": 0.9}
    axes.boxplot(
        [values],
        positions=[place],
        orientation=orientation,
        widths=0.2,
        whis=(0, 100),
        showfliers=False,
        manage_ticks=False,
        boxprops=line,
        whiskerprops=line,
        capprops=line,
        medianprops={"color": colour, "linewidth": 2.0},
    )


def axes_or_new(axes: Axes | None) -> Axes:
    """Axes that were given, or those of a new figure of pyplot, which a notebook shows."""
    if axes is not None:
        return axes
    import matplotlib.pyplot as plt

    return plt.subplots(layout="constrained")[1]


def fonts_found() -> list[str]:
    """Of the fonts that figures are drawn with, those that are here."""
    from matplotlib import font_manager

    known = {font.name for font in font_manager.fontManager.ttflist}
    return [name for name in STYLE["font.sans-serif"] if name in known]


@dataclass(frozen=True)
class Look:
    """How one thing is drawn."""

    colour: str
    line: Any  # Matplotlib's line style: a word, or lengths of dashes
    mark: str


MODELS = {
    "nominal": Look("#d97700", (0, (4.0, 1.6)), "o"),
    "augmented": Look("#00875a", "-", "s"),
    "exo": Look("#7a7a7a", (0, (1.2, 1.2)), "^"),
}
RECONSTRUCTED = {
    "shred": Look("#1f4fc8", "-", "o"),
    "shallow decoder": Look("#00875a", (0, (5.0, 1.5)), "s"),
    "linear": Look("#d97700", (0, (4.0, 1.6)), "^"),
    "delay ridge": Look("#7a3fa0", (0, (3.0, 1.0, 1.0, 1.0)), "v"),
    "fourier ridge": Look("#a8326e", (0, (1.4, 1.0)), "D"),
    "masked shred": Look("#1f4fc8", ":", "*"),
    "shred ensemble": Look("#1f4fc8", "-.", "P"),
    "shred-text": Look("#7a3fb0", "-.", "X"),
}
SIDES = {
    "l": Look("#c8102e", "-", "v"),
    "r": Look("#1f4fc8", "-", "o"),
    "": Look("#222222", "-", "s"),
}
MEASURED = Look("#111111", "-", "")
WITHOUT_DEVICE = Look("#555555", (0, (4.0, 1.6)), "")
NULL = Look("#444444", (0, (2.0, 2.0)), "")
KEPT = Look("#8fa1b8", "-", "")
DROPPED = Look("#111111", "-", "x")
