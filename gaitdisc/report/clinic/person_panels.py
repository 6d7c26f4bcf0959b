"""Panels of a person: kinematics, kinetics, EMG, every cycle, and two sets of cycles one over the other."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pandas as pd

from gaitdisc.recording import PERCENT
from gaitdisc.report.clinic.panel import Line, Panel
from gaitdisc.report.wording import label, number, sideless
from gaitdisc.results import PooledCycles
from gaitdisc.results.clinical_reading import ClinicalReading, Contrast
from gaitdisc.results.clinical_variables import BY_NAME, KINEMATICS, VARIABLES, ClinicalVariable
from gaitdisc.results.emg_timing import NORMAL
from gaitdisc.results.leg_curves import FEET

SHORT = {"l": "L", "r": "R"}
MOST_SINGLE = 12  # cycles of a leg that are drawn one by one


def sheet(reading: ClinicalReading, *kinds: str) -> list[Panel]:
    """Mean curves of both legs over the reference's band, a panel for each variable of these kinds that is there."""
    found = []
    for variable in _present(reading, *kinds):
        lines = tuple(
            Line(side, leg.mean(variable.name)) for side, leg in reading.legs.items() if variable.name in leg.cycles
        )
        found.append(_panel(reading, variable, lines, _counts(reading, variable.name)))
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
    offs = _foot_off_of(pooled)
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


def _counts(reading: ClinicalReading, name: str) -> str:
    each = [
        f"{SHORT[side]} {len(reading.legs[side].cycles[name])}"
        for side in FEET
        if side in reading.legs and name in reading.legs[side].cycles
    ]
    return ", ".join(each)


def _panel(
    reading: ClinicalReading, variable: ClinicalVariable, lines: tuple[Line, ...], note: str, banded: bool = True
) -> Panel:
    one = BY_NAME[variable.name]
    band = reading.bands.get(variable.name) if banded else None
    offs = tuple((s, leg.stance_percent) for s, leg in reading.legs.items() if np.isfinite(leg.stance_percent))
    words = (one.name, one.words, one.unit, one.up, one.down, note)
    return Panel(*words, lines, band, offs, row=one.row, column=one.column)


def _foot_off_of(pooled: PooledCycles) -> tuple[tuple[str, float], ...]:
    kept = pooled.kept
    means = {side: float(kept.loc[kept["side"] == side, "stance_percent"].mean()) for side in FEET}
    return tuple((side, mean) for side, mean in means.items() if np.isfinite(mean))
