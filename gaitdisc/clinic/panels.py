"""Panels of a person's sheets: what each shows of the cycles of both legs, and the numbers drawn."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pandas as pd

from gaitdisc.clinic.clinical_reference import ClinicalReading, Contrast
from gaitdisc.processing.leg_curves import FEET, KINEMATICS, NORMAL, VARIABLES, ClinicalVariable
from gaitdisc.processing.pooled_cycles import PooledCycles
from gaitdisc.recording import PERCENT
from gaitdisc.report.curve_panels import MOST_SINGLE, SHORT, Line, Panel, in_rows
from gaitdisc.words import NONE, label, number, sideless

AMPLIFIED_V = 0.005  # surface EMG is below 5 mV on the skin


def sheet(reading: ClinicalReading, *kinds: str) -> list[Panel]:
    """Mean curves of both legs and every cycle faint behind, over the reference's bands; a panel for each variable.

    Beside the title the number of cycles, and of angles the coefficient of multiple correlation.
    """
    panels = []
    for variable in _present(reading, *kinds):
        cycles = {side: leg.cycles[variable.name] for side, leg in reading.legs.items() if variable.name in leg.cycles}
        lines = [Line(side, curve, "single") for side, curves in cycles.items() for curve in curves[:MOST_SINGLE]]
        lines += [Line(side, reading.legs[side].mean(variable.name)) for side in cycles]
        note = ", ".join(f"{SHORT[side]} {len(curves)}" for side, curves in cycles.items())
        known = [reading.consistency.get((variable.name, side), float("nan")) for side in cycles]
        if variable.kind == KINEMATICS and np.isfinite(known).any():
            note += f"; CMC {', '.join(number(cmc, none=NONE) for cmc in known)}"
        panels.append(_panel(reading, variable, tuple(lines), note))
    return in_rows(panels)


def contrast_sheet(contrast: Contrast) -> list[Panel]:
    """Both sets of cycles of both legs over each other, with bars where those of a leg differ."""
    panels = []
    for variable in _present(contrast.second, KINEMATICS):
        lines, sides = [], []
        for side, leg in contrast.second.legs.items():
            before = contrast.first.legs.get(side)
            if before is not None and variable.name in before.cycles and variable.name in leg.cycles:
                sides.append(side)
                lines += [Line(side, before.mean(variable.name), "before"), Line(side, leg.mean(variable.name))]
        if lines:
            panel = _panel(contrast.second, variable, tuple(lines), "")
            spans = [span for span in contrast.spans if span.variable == variable.name]
            differs = tuple((span.side, span.first, span.last, span.matters) for span in spans)
            panels.append(replace(panel, differs=differs, foot_off=tuple(o for o in panel.foot_off if o[0] in sides)))
    return in_rows(panels)


def emg_sheet(pooled: PooledCycles) -> list[Panel]:
    """Envelopes in percent of the leg's own peak, a panel for each muscle, over the bar of normal walking.

    Beside the title the number of cycles, above the curves the peak of the mean, of channels in volts; below the curves
    the raw EMG of one cycle of each leg, less its mean.
    """
    feet, curves, stored = pooled.kept["side"].to_numpy(), pooled.curves, pooled.raw_emg
    raw: dict[str, list[Line]] = {}
    for side in FEET:
        names = [
            sideless(channel.name) for channel in pooled.channels if (channel.quantity, channel.side) == ("emg", side)
        ]
        traces = stored[side].T if side in stored else ()
        for name, trace in zip(names, traces, strict=False):
            if np.isfinite(trace).all():
                raw.setdefault(name, []).append(Line(side, trace - trace.mean()))
    muscles: dict[str, list[tuple[Line, int, float]]] = {}  # curve in percent, its cycles, its peak [V]
    for column, channel in enumerate(pooled.channels):
        if channel.quantity != "emg" or not channel.side:
            continue
        envelopes = curves[feet == channel.side, :, column]
        envelopes = envelopes[np.isfinite(envelopes).all(axis=1)]
        if len(envelopes) and envelopes.mean(axis=0).max() > 0:
            mean = envelopes.mean(axis=0)
            line, volts = Line(channel.side, 100 * mean / mean.max()), mean.max() if channel.unit == "V" else np.nan
            muscles.setdefault(sideless(channel.name), []).append((line, len(envelopes), volts))
    means = {side: float(pooled.kept.loc[feet == side, "stance_percent"].mean()) for side in FEET}
    offs = tuple((side, mean) for side, mean in means.items() if np.isfinite(mean))
    panels = []
    for muscle, lines in muscles.items():
        volts = {line.side: peak for line, _, peak in lines if np.isfinite(peak)}
        factor, unit = (1e6, "µV") if max(volts.values(), default=0.0) < AMPLIFIED_V else (1e3, "mV, amplified")
        peaks = ", ".join(f"{SHORT[side]} {number(factor * volts[side], 0)}" for side in FEET if side in volts)
        traces = tuple(replace(trace, values=factor * trace.values) for trace in raw.get(muscle, ()) if volts)
        raw_unit = unit.partition(",")[0]
        below = f"; below: raw [{raw_unit}]" if traces else ""
        panels.append(
            Panel(
                name=muscle,
                title=label(f"{muscle}_r").removeprefix("EMG ").rpartition(",")[0],
                unit="% of own peak",
                up="",
                down="",
                note=", ".join(sorted(f"{SHORT[line.side]} {count}" for line, count, _ in lines)),
                lines=tuple(line for line, _, _ in lines),
                foot_off=offs,
                normal=NORMAL.get(muscle.removeprefix("emg_"), ()),
                axis=(-5.0, 105.0),
                about=f"peak {peaks} {unit}{below}" if volts else "",
                raw=traces,
                raw_unit=raw_unit,
            )
        )
    return in_rows(panels)


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


def raw_numbers(panels: Sequence[Panel]) -> pd.DataFrame:
    """Raw traces of panels: a column for each, and for each leg one of the percent of its cycle."""
    columns = {}
    for panel in panels:
        for line in panel.raw:
            columns.setdefault(f"percent_{line.side}", pd.Series(np.linspace(0, 100, len(line.values))))
            columns[f"{panel.name}_{line.side} [{panel.raw_unit}]"] = pd.Series(line.values)
    return pd.DataFrame(columns)


def _present(reading: ClinicalReading, *kinds: str) -> list[ClinicalVariable]:
    names = {name for leg in reading.legs.values() for name in leg.cycles}
    return [variable for variable in VARIABLES if variable.kind in kinds and variable.name in names]


def _panel(reading: ClinicalReading, variable: ClinicalVariable, lines: tuple[Line, ...], note: str) -> Panel:
    band = reading.bands.get(variable.name)
    offs = tuple((s, leg.stance_percent) for s, leg in reading.legs.items() if np.isfinite(leg.stance_percent))
    words = (variable.name, variable.words, variable.unit, variable.up, variable.down, note)
    return Panel(*words, lines, band, offs)
