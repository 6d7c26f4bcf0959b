"""Panels of a person's sheets: curves of both legs over the cycle, each drawn as SVG of a few kilobytes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from html import escape

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from gaitdisc.clinic.clinical_reference import Band, ClinicalReading, Contrast
from gaitdisc.processing.leg_curves import FEET, KINEMATICS, NORMAL, VARIABLES, ClinicalVariable
from gaitdisc.processing.pooled_cycles import PooledCycles
from gaitdisc.recording import PERCENT
from gaitdisc.report.panels import SIDES
from gaitdisc.words import SIDE_WORDS, label, number, sideless

WIDTH, HEIGHT, GAP = 300, 172, 12  # of a third of a sheet, and between two
LEFT, MARGIN, TOP, BOTTOM = 34, 4, 15, 150  # of the axes
DASHES = {"l": "", "r": "5 1.6", "": ""}  # so that left and right differ in grey print too
BAR = 5  # height of a bar below the curves
AMPLIFIED_V = 0.005  # surface EMG is below 5 mV on the skin
SPANS = 6  # parts of a row: a panel takes two or three
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
    axis: tuple[float, float] | None = None  # its ends, wherever no curve goes beyond; fitted where there is none
    span: int = 2  # parts of the row
    about: str = ""  # what else stands above the curves

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
    def bars(self) -> list[tuple[str, int, int]]:
        """Bars below the curves, where a muscle is active, and above them, where sets of cycles differ: kind, ends."""
        bars = [("normal", first, last) for first, last in self.normal]
        return bars + [("matters" if matters else "small", first, last) for first, last, matters in self.differs]

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


def svg(panel: Panel) -> str:
    """Drawing of a panel; every word in it is escaped."""
    low, high = panel.ends()

    def y(value: float | NDArray[np.float64]) -> NDArray[np.float64]:
        return BOTTOM - (np.asarray(value) - low) / (high - low) * (BOTTOM - TOP)

    parts = [
        f'<svg viewBox="0 0 {panel.width} {HEIGHT}" role="img" aria-label="{escape(panel.alt, quote=True)}" '
        f'data-low="{low:.5g}" data-high="{high:.5g}">'
    ]
    for kind, below, above in panel.shades:
        back = _points(panel, y(below)).split(" ")
        pairs = [f"{back[i]} {back[i + 1]}" for i in range(0, len(back), 2)]
        parts.append(f'<path class="{kind}" d="M{_points(panel, y(above))}L{" ".join(reversed(pairs))}Z"/>')
    if panel.band is not None:
        parts.append(f'<path class="middle" d="M{_points(panel, y(panel.band.mean))}"/>')
    parts += _axes(panel, low, high, y)
    for kind, first, last in panel.bars:
        x, end, at = _x(panel, first), _x(panel, last), BOTTOM - BAR if kind == "normal" else TOP
        parts.append(f'<rect class="{kind}" x="{x:.1f}" y="{at}" width="{end - x:.1f}" height="{BAR}"/>')
    for side, percent in panel.foot_off:
        at, colour = _x(panel, percent), SIDES[side].colour
        parts.append(
            f'<path class="off" stroke="{colour}" d="M{at:.1f} {BOTTOM}V{BOTTOM - 14}M{at:.1f} {TOP + 14}V{TOP}"/>'
        )
    parts += [_path(panel, line, y) for line in sorted(panel.lines, key=lambda one: one.look != "single")]
    parts.append(f'<path class="cursor" d="M0 {TOP}V{BOTTOM}"/></svg>')
    return "".join(parts)


def _x(panel: Panel, percent: float) -> float:
    return LEFT + percent / 100 * (panel.width - MARGIN - LEFT)


def _points(panel: Panel, values: Sequence[float] | NDArray[np.float64]) -> str:
    step = 100 / (len(values) - 1)
    held = np.clip(values, TOP, BOTTOM)  # a band or a single cycle may go beyond a fixed axis
    return " ".join(f"{_x(panel, k * step):.1f} {value:.1f}" for k, value in enumerate(held) if np.isfinite(value))


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


def sheet(reading: ClinicalReading, *kinds: str) -> list[Panel]:
    """Mean curves of both legs and every cycle faint behind, over the reference's bands; a panel for each variable.

    Beside the title the number of cycles, and of angles the coefficient of multiple correlation.
    """
    found = []
    for variable in _present(reading, *kinds):
        own = {side: leg for side, leg in reading.legs.items() if variable.name in leg.cycles}
        lines = [
            Line(side, one, "single") for side, leg in own.items() for one in leg.cycles[variable.name][:MOST_SINGLE]
        ]
        lines += [Line(side, leg.mean(variable.name)) for side, leg in own.items()]
        note = ", ".join(f"{SHORT[side]} {len(leg.cycles[variable.name])}" for side, leg in own.items())
        known = [reading.consistency.get((variable.name, side), float("nan")) for side in own]
        if variable.kind == KINEMATICS and np.isfinite(known).any():
            note += f"; CMC {', '.join(number(one, 2) if np.isfinite(one) else '–' for one in known)}"
        found.append(_panel(reading, variable, tuple(lines), note))
    return in_rows(found)


def in_rows(panels: Sequence[Panel]) -> list[Panel]:
    """Panels in rows of three, the last of two where that fills the sheet.

    >>> [one.span for one in in_rows([Panel(*"abcdef", ())] * 7)]
    [2, 2, 2, 3, 3, 3, 3]
    """
    pairs = {0: 0, 1: 4, 2: 2}[len(panels) % 3]
    return [replace(one, span=2 if k < len(panels) - pairs else 3) for k, one in enumerate(panels)]


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
    return in_rows(found)


def emg_sheet(pooled: PooledCycles) -> list[Panel]:
    """Envelopes in percent of the leg's own peak, a panel for each muscle, over the bar of normal walking.

    Beside the title the number of cycles, above the curves the peak of the mean, of channels in volts.
    """
    feet, curves = pooled.kept["side"].to_numpy(), pooled.curves
    muscles: dict[str, list[tuple[Line, int, float]]] = {}  # curve in percent, its cycles, its peak [V]
    for column, channel in enumerate(pooled.channels):
        if channel.quantity != "emg" or not channel.side:
            continue
        own = curves[feet == channel.side, :, column]
        own = own[np.isfinite(own).all(axis=1)]
        if len(own) and own.mean(axis=0).max() > 0:
            mean = own.mean(axis=0)
            line, volts = Line(channel.side, 100 * mean / mean.max()), mean.max() if channel.unit == "V" else np.nan
            muscles.setdefault(sideless(channel.name), []).append((line, len(own), volts))
    kept = pooled.kept
    means = {side: float(kept.loc[kept["side"] == side, "stance_percent"].mean()) for side in FEET}
    offs = tuple((side, mean) for side, mean in means.items() if np.isfinite(mean))
    found = []
    for muscle, own in muscles.items():
        found.append(
            Panel(
                name=muscle,
                title=label(f"{muscle}_r").removeprefix("EMG ").rpartition(",")[0],
                unit="% of own peak",
                up="",
                down="",
                note=", ".join(sorted(f"{SHORT[line.side]} {count}" for line, count, _ in own)),
                lines=tuple(line for line, _, _ in own),
                foot_off=offs,
                normal=NORMAL.get(muscle.removeprefix("emg_"), ()),
                axis=(-5.0, 105.0),
                about=_peak_words({line.side: volts for line, _, volts in own}),
            )
        )
    return in_rows(found)


def _peak_words(volts: dict[str, float]) -> str:
    """Largest of the mean envelope; what was amplified before it was recorded has no microvolts.

    >>> _peak_words({"r": 0.000085, "l": 0.000102}), _peak_words({"r": 0.085})
    ('peak L 102, R 85 µV', 'peak R 85 mV, amplified')
    """
    known = {side: volts[side] for side in FEET if np.isfinite(volts.get(side, np.nan))}
    if not known:
        return ""
    factor, unit = (1e6, "µV") if max(known.values()) < AMPLIFIED_V else (1e3, "mV, amplified")
    return f"peak {', '.join(f'{SHORT[side]} {number(factor * one, 0)}' for side, one in known.items())} {unit}"


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


def _panel(reading: ClinicalReading, variable: ClinicalVariable, lines: tuple[Line, ...], note: str) -> Panel:
    band = reading.bands.get(variable.name)
    offs = tuple((s, leg.stance_percent) for s, leg in reading.legs.items() if np.isfinite(leg.stance_percent))
    words = (variable.name, variable.words, variable.unit, variable.up, variable.down, note)
    return Panel(*words, lines, band, offs)
