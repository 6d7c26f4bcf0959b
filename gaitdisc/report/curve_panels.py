"""Curves of both legs over the cycle in panels, each drawn as SVG of a few kilobytes in a few milliseconds."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from html import escape
from math import isfinite
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gaitdisc.report.panels import SIDES
from gaitdisc.words import SIDE_WORDS, number

TEMPLATES = Path(__file__).parent / "templates"
WIDTH, HEIGHT, GAP = 300, 160, 12  # of a third of a sheet, and between two
LEFT, MARGIN, TOP, BOTTOM = 34, 4, 15, 138  # of the axes
DASHES = {"l": "", "r": "5 1.6", "": ""}  # so that left and right differ in grey print too
ROW, DOWN = 3 * WIDTH + 2 * GAP, HEIGHT + 20  # of one drawing of many panels: its width, and from row to row
MOST_SINGLE = 12  # cycles of a leg that are drawn one by one
BAR = 5  # height of a bar below the curves
STRIP = 30  # height of a raw trace below a panel, of one leg
BINS = 500  # of a raw trace, each drawn from its smallest to its largest sample
SHORT = {"l": "L", "r": "R"}


@dataclass(frozen=True, eq=False)
class Band:
    """Mean and standard deviation of a curve over the legs of a reference."""

    mean: NDArray[np.float64]
    sd: NDArray[np.float64]
    people: int
    at_speed: bool = False  # whether both are those at the person's speed, as the limits of single values are


@dataclass(frozen=True, eq=False)
class Line:
    """A curve of a panel."""

    side: str
    values: NDArray[np.float64]
    look: str = "mean"  # `mean`, `single` (one cycle, faint) or `before` (thin, of the first of two)
    sd: NDArray[np.float64] | None = None  # spread around it, shaded in its colour


@dataclass(frozen=True, eq=False)
class Panel:
    """What a panel shows."""

    name: str
    title: str
    unit: str
    up: str
    down: str
    note: str  # counts and scores, beside the title
    lines: tuple[Line, ...]
    band: Band | None = None
    foot_off: tuple[tuple[str, float], ...] = ()  # tuple of (str, float), side and [% of the cycle]
    # tuple of (int, int), when a muscle is active in normal walking [% of the cycle]
    normal: tuple[tuple[int, int], ...] = ()
    # tuple of (str, int, int, bool), side, where two sets of its cycles differ, and whether by as much as matters
    differs: tuple[tuple[str, int, int, bool], ...] = ()
    axis: tuple[float, float] | None = None  # its ends, wherever no curve goes beyond; fitted where there is none
    span: int = 2  # parts of the six of a row
    about: str = ""  # what else stands above the curves
    raw: tuple[Line, ...] = ()  # raw traces of one cycle of each leg, below the curves, each (sample,)
    raw_unit: str = ""

    @property
    def signs(self) -> str:
        """What up and down mean, above the curves; and whether the axis is another than elsewhere."""
        words = [f"{arrow} {word}" for arrow, word in (("↑", self.up), ("↓", self.down)) if word]
        return "   ".join([*words, *([self.about] if self.about else []), *(["(wider axis)"] if self.is_wider else [])])

    @property
    def shades(self) -> list[tuple[str, NDArray[np.float64], NDArray[np.float64]]]:
        """Bands of the reference, the wider first: what each is called, its lower and its upper end."""
        if self.band is None:
            return []
        mean, sd = self.band.mean, self.band.sd
        return [(kind, mean - many * sd, mean + many * sd) for kind, many in (("band2", 2), ("band", 1))]

    @property
    def alt(self) -> str:
        """What is seen, for those who cannot see it."""
        parts = []
        for line in self.lines:
            if line.look == "single":
                continue
            word = f"{SIDE_WORDS[line.side]}{', first' if line.look == 'before' else ''}".strip()
            low, high = float(np.nanmin(line.values)), float(np.nanmax(line.values))
            at = int(np.nanargmax(line.values))
            parts.append(f"{word} {number(low, 1)} to {number(high, 1)}, peak at {at} %")
        if self.band is not None:
            low, high = float(np.nanmin(self.band.mean)), float(np.nanmax(self.band.mean))
            parts.append(f"reference {number(low, 1)} to {number(high, 1)}, {self.band.people} people")
        return f"{self.title} [{self.unit}] over the cycle: {'; '.join(parts)}"

    def ends(self) -> tuple[float, float]:
        """Lowest and highest value of the axis: as given, or farther where a mean curve goes beyond."""
        parts = [line.values for line in self.lines if self.axis is None or line.look != "single"]
        parts += [end for _, *both in self.shades for end in both] if self.axis is None else []
        parts += [line.values + by * line.sd for line in self.lines if line.sd is not None for by in (-1, 1)]
        low, high = min(float(np.nanmin(p)) for p in parts), max(float(np.nanmax(p)) for p in parts)
        pad = 0.06 * max(high - low, 1e-6)
        if self.axis is None:
            return low - pad, high + pad
        first, last = self.axis
        return (low - pad if low < first else first), (high + pad if high > last else last)

    @property
    def is_wider(self) -> bool:
        """Whether a curve goes beyond the ends that the axis has on other pages."""
        return self.axis is not None and self.ends() != self.axis

    @property
    def width(self) -> int:
        """Width of the drawing, as much wider as its parts of the row are."""
        return self.span * WIDTH // 2 + (self.span - 2) * GAP // 2


def ticks(low: float, high: float) -> list[float]:
    """Round numbers between two values, in at most five steps."""
    rough = (high - low) / 5
    power = 10.0 ** np.floor(np.log10(rough))
    step = next(float(k * power) for k in (1, 2, 5, 10, 20) if (high - low) / (k * power) <= 5)
    first = np.ceil(low / step)
    return [float(round(k * step, 10)) + 0.0 for k in np.arange(first, np.floor(high / step) + 1)]


def svg(panel: Panel, place: str = "") -> str:
    """Drawing of a panel, at a place (`x="0" y="14" ...`) of a larger drawing; every word in it is escaped."""
    low, high = panel.ends()

    def y(value: float | NDArray[np.float64]) -> NDArray[np.float64]:
        return BOTTOM - (np.asarray(value) - low) / (high - low) * (BOTTOM - TOP)

    height = HEIGHT + STRIP * len(panel.raw)
    parts = [
        f'<svg {place}viewBox="0 0 {panel.width} {height}" role="img" aria-label="{escape(panel.alt, quote=True)}" '
        f'data-low="{low:.5g}" data-high="{high:.5g}">'
    ]
    for kind, below, above in panel.shades:
        parts.append(f'<path class="{kind}" d="{_outline(panel, y(below), y(above))}"/>')
    for line in panel.lines:
        if line.sd is not None:
            ends = y(line.values - line.sd), y(line.values + line.sd)
            parts.append(f'<path class="spread" style="fill: {SIDES[line.side].colour}" d="{_outline(panel, *ends)}"/>')
    if panel.band is not None:
        parts.append(f'<path class="middle" d="M{_points(panel, y(panel.band.mean))}"/>')
    parts += _axes(panel, low, high, y)
    for first, last in panel.normal:
        parts.append(f'<rect class="normal" {_bar(panel, first, last, BOTTOM - BAR)}/>')
    for side, first, last, matters in panel.differs:
        kind, at = "matters" if matters else "small", TOP + (BAR + 1) * (side == "r")
        parts.append(f'<rect class="{kind}" fill="{SIDES[side].colour}" {_bar(panel, first, last, at)}/>')
    for side, percent in panel.foot_off:
        at, colour = _x(panel, percent), SIDES[side].colour
        parts.append(
            f'<path class="off" stroke="{colour}" d="M{at:.1f} {BOTTOM}V{BOTTOM - 14}M{at:.1f} {TOP + 14}V{TOP}"/>'
        )
    parts += [_path(panel, line, y) for line in sorted(panel.lines, key=lambda line: line.look != "single")]
    parts += _raw(panel)
    parts.append(f'<path class="cursor" d="M0 {TOP}V{BOTTOM}"/></svg>')
    return "".join(parts)


def _bar(panel: Panel, first: float, last: float, top: float) -> str:
    x = _x(panel, first)
    return f'x="{x:.1f}" y="{top}" width="{_x(panel, last) - x:.1f}" height="{BAR}"'


def _raw(panel: Panel) -> list[str]:
    """Raw traces below one another, each to its largest value, which stands beside it."""
    parts = []
    for place, line in enumerate(panel.raw):
        middle, half = HEIGHT + STRIP * (place + 0.5), STRIP / 2 - 1
        most = max(float(np.abs(line.values).max()), 1e-9)
        starts = np.linspace(0, len(line.values), min(BINS, len(line.values)), endpoint=False).astype(int)
        ends = np.stack([extreme.reduceat(line.values, starts) for extreme in (np.minimum, np.maximum)], axis=1)
        y = middle - half * ends.ravel() / most
        x = _x(panel, 100 * np.repeat(starts, 2) / len(line.values))
        points = " ".join(f"{across:.1f} {down:.1f}" for across, down in zip(x, y, strict=True))
        parts.append(f'<path class="zero" d="M{LEFT} {middle:.1f}H{panel.width - MARGIN}"/>')
        parts.append(f'<path class="raw" stroke="{SIDES[line.side].colour}" d="M{points}"/>')
        for down, words in ((-1, SHORT[line.side]), (8, f"±{number(most, 0)}")):
            parts.append(f'<text class="sign" x="{LEFT - 3}" y="{middle + down}" text-anchor="end">{words}</text>')
    return parts


def _x(panel: Panel, percent: Any) -> Any:
    return LEFT + percent / 100 * (panel.width - MARGIN - LEFT)


def _points(panel: Panel, values: Sequence[float] | NDArray[np.float64]) -> str:
    across = _x(panel, np.arange(len(values)) * (100 / (len(values) - 1))).tolist()
    held = np.clip(values, TOP, BOTTOM).tolist()  # a band or a single cycle may go beyond a fixed axis
    return " ".join(f"{x:.1f} {y:.1f}" for x, y in zip(across, held, strict=True) if isfinite(y))


def _outline(panel: Panel, below: NDArray[np.float64], above: NDArray[np.float64]) -> str:
    back = _points(panel, below[::2]).split(" ")
    pairs = [f"{back[i]} {back[i + 1]}" for i in range(0, len(back), 2)]
    return f"M{_points(panel, above[::2])}L{' '.join(reversed(pairs))}Z"


def _path(panel: Panel, line: Line, y) -> str:
    values = line.values[:: 2 if line.look == "single" else 1]
    dash = DASHES[line.side] if line.look == "mean" else "2 2" if line.look == "before" else ""
    dashed = f' stroke-dasharray="{dash}"' if dash else ""
    return (
        f'<path class="{line.look}" data-side="{line.side}" stroke="{SIDES[line.side].colour}"{dashed} '
        f'd="M{_points(panel, y(values))}"/>'
    )


def _axes(panel: Panel, low: float, high: float, y) -> list[str]:
    right = panel.width - MARGIN
    parts = [f'<path class="axis" d="M{LEFT} {TOP}V{BOTTOM}H{right}"/>']
    places = ticks(low, high)
    digits = next(d for d in range(12) if all(round(value, d) == value for value in places))
    for value in places:
        at = float(y(value))
        if value == 0:
            parts.append(f'<path class="zero" d="M{LEFT} {at:.1f}H{right}"/>')
        parts.append(f'<path class="axis" d="M{LEFT - 3} {at:.1f}H{LEFT}"/>')
        parts.append(f'<text x="{LEFT - 5}" y="{at + 3.6:.1f}" text-anchor="end">{number(value, digits)}</text>')
    for percent, anchor in ((0, "start"), (50, "middle"), (100, "end")):
        words = f"{percent} %" if percent == 100 else str(percent)
        parts.append(f'<text x="{_x(panel, percent):.1f}" y="{BOTTOM + 13}" text-anchor="{anchor}">{words}</text>')
    if panel.signs:
        parts.append(f'<text class="sign" x="{LEFT}" y="{TOP - 5}">{escape(panel.signs)}</text>')
    return parts


def draw_rows(panels: Sequence[Panel]) -> str:
    """One drawing of panels in rows of three, each below its title; it needs no style of a page."""
    rows = -(-len(panels) // 3)
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {ROW} {rows * DOWN}" width="{ROW}">'
        f"<style>{(TEMPLATES / 'curves.css').read_text(encoding='utf-8')}</style>"
        '<rect width="100%" height="100%" fill="#fff"/>'
    ]
    for place, panel in enumerate(panels):
        x, y = place % 3 * (WIDTH + GAP), place // 3 * DOWN
        about = escape(f"[{panel.unit}] {panel.note}".strip())
        parts.append(f'<text x="{x}" y="{y + 11}"><tspan class="title">{escape(panel.title)}</tspan> {about}</text>')
        parts.append(svg(panel, f'x="{x}" y="{y + 14}" width="{WIDTH}" height="{HEIGHT}" '))
    return "".join((*parts, "</svg>\n"))


def in_rows(panels: Sequence[Panel]) -> list[Panel]:
    """Panels in rows of three, the last of two where that fills the sheet.

    >>> [panel.span for panel in in_rows([Panel(*"abcdef", ())] * 7)]
    [2, 2, 2, 3, 3, 3, 3]
    """
    pairs = {0: 0, 1: 4, 2: 2}[len(panels) % 3]
    return [replace(panel, span=2 if k < len(panels) - pairs else 3) for k, panel in enumerate(panels)]
