"""Panels of a person's sheets: curves of both legs over the cycle, each drawn as SVG of a few kilobytes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from html import escape

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from gaitdisc.recording import PERCENT
from gaitdisc.report.panels import SIDES
from gaitdisc.results.clinical_reference import Band, ClinicalReading, Contrast
from gaitdisc.results.leg_curves import FEET, KINEMATICS, NORMAL, VARIABLES, ClinicalVariable
from gaitdisc.results.pooled_cycles import PooledCycles
from gaitdisc.words import SIDE_WORDS, label, number, sideless

WIDTH, HEIGHT = 240, 165
LEFT, RIGHT, TOP, BOTTOM = 34, 236, 8, 143  # of the axes
DASHES = {"l": "", "r": "5 1.6", "": ""}  # so that left and right differ in grey print too
BAR = 5  # height of a bar below the curves
SHORT = {"l": "L", "r": "R"}
MOST_SINGLE = 12  # cycles of a leg that are drawn one by one


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
    """Round numbers between two values, at most so many."""
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


def sheet(reading: ClinicalReading, *kinds: str) -> list[Panel]:
    """Mean curves of both legs over the reference's band, a panel for each variable of these kinds that is there."""
    found = []
    for variable in _present(reading, *kinds):
        own = {side: leg for side, leg in reading.legs.items() if variable.name in leg.cycles}
        lines = tuple(Line(side, leg.mean(variable.name)) for side, leg in own.items())
        counts = ", ".join(f"{SHORT[side]} {len(leg.cycles[variable.name])}" for side, leg in own.items())
        found.append(_panel(reading, variable, lines, counts))
    return found


def consistency_sheet(reading: ClinicalReading) -> list[Panel]:
    """Every cycle faint behind the mean, with the coefficient of multiple correlation of each leg."""
    found = []
    for variable in _present(reading, KINEMATICS):
        lines: list[Line] = []
        words = []
        for side, leg in reading.legs.items():
            if variable.name not in leg.cycles:
                continue
            each = leg.cycles[variable.name]
            lines += [Line(side, one, "single") for one in each[:MOST_SINGLE]]
            lines.append(Line(side, each.mean(axis=0)))
            known = reading.consistency.get((variable.name, side), float("nan"))
            words.append(f"{SHORT[side]} {number(known, 2) if np.isfinite(known) else '–'}")
        found.append(_panel(reading, variable, tuple(lines), f"CMC {', '.join(words)}", banded=False))
    return found


def contrast_sheet(contrast: Contrast, side: str) -> list[Panel]:
    """Both sets of cycles of one leg over each other, with bars where they differ."""
    found = []
    for variable in _present(contrast.second, KINEMATICS):
        pair = [reading.legs.get(side) for reading in (contrast.first, contrast.second)]
        if any(leg is None or variable.name not in leg.cycles for leg in pair):
            continue
        first, second = (leg.mean(variable.name) for leg in pair if leg is not None)
        spans = [one for one in contrast.spans if (one.side, one.variable) == (side, variable.name)]
        lines = (Line(side, first, "before"), Line(side, second))
        panel = _panel(contrast.second, variable, lines, "")
        differs = tuple((one.first, one.last, one.matters) for one in spans)
        found.append(replace(panel, differs=differs, foot_off=tuple(o for o in panel.foot_off if o[0] == side)))
    return found


def emg_sheet(pooled: PooledCycles) -> list[Panel]:
    """Envelopes in percent of the leg's own peak, a panel for each muscle, over the bar of normal walking."""
    feet, curves = pooled.kept["side"].to_numpy(), pooled.curves
    panels: dict[str, list[Line]] = {}
    counts: dict[str, list[str]] = {}
    for column, channel in enumerate(pooled.channels):
        if channel.quantity != "emg" or not channel.side:
            continue
        own = curves[feet == channel.side, :, column]
        own = own[np.isfinite(own).all(axis=1)]
        if len(own) and own.mean(axis=0).max() > 0:
            mean = own.mean(axis=0)
            panels.setdefault(sideless(channel.name), []).append(Line(channel.side, 100 * mean / mean.max()))
            counts.setdefault(sideless(channel.name), []).append(f"{SHORT[channel.side]} {len(own)}")
    kept = pooled.kept
    means = {side: float(kept.loc[kept["side"] == side, "stance_percent"].mean()) for side in FEET}
    offs = tuple((side, mean) for side, mean in means.items() if np.isfinite(mean))
    found = []
    for place, (muscle, lines) in enumerate(panels.items()):
        short = muscle.removeprefix("emg_")
        note = ", ".join(counts[muscle])
        title = label(f"{muscle}_r").removeprefix("EMG ").rpartition(",")[0]
        shown = (muscle, title, "% of own peak", "", "", note, tuple(lines), None, offs, NORMAL.get(short, ()))
        found.append(Panel(*shown, row=place // 4, column=place % 4))
    return found


def panel_numbers(panels: list[Panel]) -> pd.DataFrame:
    """Numbers drawn in panels: one row a percent, a column for each curve, the reference's mean and spread beside."""
    columns = {"percent": PERCENT}
    for panel in panels:
        for count, line in enumerate(panel.lines, 1):
            word = {"mean": f"{line.side}_mean", "before": f"{line.side}_first"}.get(line.look, f"{line.side}_{count}")
            columns[f"{panel.name}_{word} [{panel.unit}]"] = line.values
        if panel.band is not None:
            columns[f"{panel.name}_reference_mean [{panel.unit}]"] = panel.band.mean
            columns[f"{panel.name}_reference_sd [{panel.unit}]"] = panel.band.sd
    return pd.DataFrame(columns)


def _present(reading: ClinicalReading, *kinds: str) -> list[ClinicalVariable]:
    names = {name for leg in reading.legs.values() for name in leg.cycles}
    return [variable for variable in VARIABLES if variable.kind in kinds and variable.name in names]


def _panel(
    reading: ClinicalReading, variable: ClinicalVariable, lines: tuple[Line, ...], note: str, banded: bool = True
) -> Panel:
    band = reading.bands.get(variable.name) if banded else None
    offs = tuple((s, leg.stance_percent) for s, leg in reading.legs.items() if np.isfinite(leg.stance_percent))
    words = (variable.name, variable.words, variable.unit, variable.up, variable.down, note)
    return Panel(*words, lines, band, offs, row=variable.row, column=variable.column)
