"""One panel of a sheet: curves of both legs over the cycle, drawn as SVG of a few kilobytes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from html import escape

import numpy as np
from numpy.typing import NDArray

from gaitdisc.report.palette import SIDES
from gaitdisc.report.wording import SIDE_WORDS, number
from gaitdisc.results.clinical_reading import Band

WIDTH, HEIGHT = 240, 165
LEFT, RIGHT, TOP, BOTTOM = 34, 236, 8, 143  # of the axes
DASHES = {"l": "", "r": "5 1.6", "": ""}  # so that grey print tells left from right
BAR = 5  # height of a bar below the curves


@dataclass(frozen=True, eq=False)
class Line:
    """A curve of a panel."""

    side: str
    values: NDArray[np.float64]
    look: str = "mean"  # `mean`, `single` (one cycle, faint) or `before` (thin, of the first of two)


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
    # tuple of (int, int, bool), where two sets of cycles differ, and whether that is as large as what matters
    differs: tuple[tuple[int, int, bool], ...] = ()
    row: int = 0  # place in the sheet
    column: int = 0  # place in the sheet

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

    def span(self) -> tuple[float, float]:
        """Lowest and highest value of the axis."""
        parts = [line.values for line in self.lines]
        if self.band is not None:
            parts += [self.band.mean - self.band.sd, self.band.mean + self.band.sd]
        low, high = min(float(np.nanmin(p)) for p in parts), max(float(np.nanmax(p)) for p in parts)
        pad = 0.06 * max(high - low, 1e-6)
        low, high = low - pad, high + pad
        return (min(low, 0.0), high) if self.normal else (low, high)


def ticks(low: float, high: float, most: int = 4) -> list[float]:
    """Round numbers between two values, at most so many.

    >>> ticks(-4.2, 61.0)
    [0.0, 20.0, 40.0, 60.0]
    """
    rough = (high - low) / most
    power = 10.0 ** np.floor(np.log10(rough))
    step = next(float(k * power) for k in (1, 2, 5, 10, 20) if (high - low) / (k * power) <= most)
    first = np.ceil(low / step)
    return [float(round(k * step, 10)) + 0.0 for k in np.arange(first, np.floor(high / step) + 1)]


def svg(panel: Panel) -> str:
    """Drawing of a panel; every word in it is escaped."""
    low, high = panel.span()

    def y(value: float | NDArray[np.float64]) -> NDArray[np.float64]:
        return BOTTOM - (np.asarray(value) - low) / (high - low) * (BOTTOM - TOP)

    parts = [
        f'<svg viewBox="0 0 {WIDTH} {HEIGHT}" role="img" aria-label="{escape(panel.alt, quote=True)}" '
        f'data-low="{low:.5g}" data-high="{high:.5g}">'
    ]
    parts += _band(panel, y)
    parts += _axes(panel, low, high, y)
    for first, last in panel.normal:
        parts.append(
            f'<rect class="normal" x="{_x(first):.1f}" y="{BOTTOM - BAR}" {_wide(first, last)} height="{BAR}"/>'
        )
    for first, last, matters in panel.differs:
        kind = "matters" if matters else "small"
        parts.append(f'<rect class="{kind}" x="{_x(first):.1f}" y="{TOP}" {_wide(first, last)} height="{BAR}"/>')
    for side, percent in panel.foot_off:
        at, colour = _x(percent), SIDES[side].colour
        parts.append(
            f'<path class="off" stroke="{colour}" d="M{at:.1f} {BOTTOM}V{BOTTOM - 14}M{at:.1f} {TOP + 14}V{TOP}"/>'
        )
    parts += [_path(line, y) for line in sorted(panel.lines, key=lambda one: one.look != "single")]
    parts.append(f'<path class="cursor" d="M0 {TOP}V{BOTTOM}"/></svg>')
    return "".join(parts)


def _x(percent: float) -> float:
    return LEFT + percent / 100 * (RIGHT - LEFT)


def _wide(first: float, last: float) -> str:
    return f'width="{_x(last) - _x(first):.1f}"'


def _points(values: Sequence[float] | NDArray[np.float64]) -> str:
    step = 100 / (len(values) - 1)
    return " ".join(f"{_x(k * step):.1f} {value:.1f}" for k, value in enumerate(values) if np.isfinite(value))


def _path(line: Line, y) -> str:
    dash = DASHES[line.side] if line.look == "mean" else "2 2" if line.look == "before" else ""
    dashed = f' stroke-dasharray="{dash}"' if dash else ""
    return (
        f'<path class="{line.look}" data-side="{line.side}" stroke="{SIDES[line.side].colour}"{dashed} '
        f'd="M{_points(y(line.values))}"/>'
    )


def _band(panel: Panel, y) -> list[str]:
    if panel.band is None:
        return []
    above, below = y(panel.band.mean + panel.band.sd), y(panel.band.mean - panel.band.sd)
    back = _points(below).split(" ")
    pairs = [f"{back[i]} {back[i + 1]}" for i in range(0, len(back), 2)]
    return [
        f'<path class="band" d="M{_points(above)}L{" ".join(reversed(pairs))}Z"/>',
        f'<path class="middle" d="M{_points(y(panel.band.mean))}"/>',
    ]


def _axes(panel: Panel, low: float, high: float, y) -> list[str]:
    parts = [f'<path class="axis" d="M{LEFT} {TOP}V{BOTTOM}H{RIGHT}"/>']
    places = ticks(low, high)
    digits = next(d for d in range(12) if all(round(value, d) == value for value in places))
    for value in places:
        at = float(y(value))
        if value == 0:
            parts.append(f'<path class="zero" d="M{LEFT} {at:.1f}H{RIGHT}"/>')
        parts.append(f'<path class="axis" d="M{LEFT - 3} {at:.1f}H{LEFT}"/>')
        parts.append(f'<text x="{LEFT - 5}" y="{at + 3.6:.1f}" text-anchor="end">{number(value, digits)}</text>')
    for percent, anchor in ((0, "start"), (50, "middle"), (100, "end")):
        words = f"{percent} %" if percent == 100 else str(percent)
        parts.append(f'<text x="{_x(percent):.1f}" y="{BOTTOM + 13}" text-anchor="{anchor}">{words}</text>')
    if panel.up:
        parts.append(f'<text class="sign" x="{LEFT + 4}" y="{TOP + 6}">↑ {escape(panel.up)}</text>')
    if panel.down:
        parts.append(f'<text class="sign" x="{LEFT + 4}" y="{BOTTOM - 4}">↓ {escape(panel.down)}</text>')
    return parts
