"""Cycles of one leg as a clinic reads them: the clinical variables, cycle by cycle, and spatiotemporal values."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gaitdisc.recording import PERCENT
from gaitdisc.recording.arrays import mean_where_known
from gaitdisc.results.clinical_variables import FORCES, MOMENTS, POWERS, VARIABLES
from gaitdisc.results.pooled_cycles import SPATIOTEMPORAL, PooledCycles

FEET = ("l", "r")
TURNED_DEG = 20.0  # by which the pelvis turns in the laboratory from contact to contact where somebody walks a curve
LIGHTEST_N = 50.0  # mean force of both feet; below it nobody stands on the belts
KNOWN_UNTIL = (
    91  # points of a moment or power; after the next foot meets a plate that is not known its end may be empty
)
ALONG_THE_PATH = ("pelvis_rotation", "foot_progression")  # angles about a straight line of walking


@dataclass(frozen=True, eq=False)
class LegCurves:
    """Kept cycles of one leg."""

    side: str
    count: int
    stance_percent: float  # mean foot off [% of the cycle]; NaN where none is known
    # each (cycle, phase), clinical variable -> curves on 101 points, in the variable's unit and sign; complete, but for
    # the end of a moment or power
    cycles: Mapping[str, NDArray[np.float64]]
    # each (cycle,), spatiotemporal value -> of the cycles in which it is known
    values: Mapping[str, NDArray[np.float64]]
    # mean turn of the pelvis from contact to contact; beyond TURNED_DEG angles about the line of walking are left
    turned_deg: float = 0.0

    def mean(self, name: str) -> NDArray[np.float64]:
        """Mean curve of a variable; NaN where no cycle has a value."""
        return mean_where_known(self.cycles[name])


def legs_of(pooled: PooledCycles) -> dict[str, LegCurves]:
    """Both legs of a person, session and condition; a leg without a kept cycle is not there."""
    places = {channel.name: column for column, channel in enumerate(pooled.channels)}
    units = {channel.name: channel.unit for channel in pooled.channels}
    kept, curves = pooled.kept, pooled.curves
    weight = _percent_per_newton(pooled)
    found = {}
    for side in FEET:
        own = (kept["side"] == side).to_numpy()
        if not own.any():
            continue
        cycles = {}
        for variable in VARIABLES:
            channel = variable.channel(side)
            newtons = variable.kind == FORCES and units.get(channel) == "N"
            factor = weight if newtons else 1.0
            if factor is not None and (newtons or units.get(channel) == variable.unit):
                each = curves[own, :, places[channel]] * factor
                must = KNOWN_UNTIL if variable.kind in (MOMENTS, POWERS) else len(PERCENT)
                whole = each[np.isfinite(each[:, :must]).all(axis=1)]
                if len(whole):
                    cycles[variable.name] = variable.sign(side) * whole
        turned = (
            float(np.abs(np.ptp(cycles["pelvis_rotation"][:, [0, -1]], axis=1)).mean())
            if "pelvis_rotation" in cycles
            else 0.0
        )
        if turned > TURNED_DEG:
            cycles = {name: each for name, each in cycles.items() if name not in ALONG_THE_PATH}
        values = {value: kept.loc[own, value].dropna().to_numpy(float) for value in SPATIOTEMPORAL}
        known = {value: each for value, each in values.items() if len(each)}
        stance = float(known["stance_percent"].mean()) if "stance_percent" in known else float("nan")
        found[side] = LegCurves(side, int(own.sum()), stance, cycles, known, turned)
    return found


def _percent_per_newton(pooled: PooledCycles) -> float | None:
    """Percent of body weight a newton is, of belts under each foot: over whole strides both carry the weight."""
    feet, names = pooled.kept["side"].to_numpy(), [channel.name for channel in pooled.channels]
    carried = 0.0
    for side in FEET:
        name = f"ground_force_{side}_vy"
        if name not in names or pooled.channels[names.index(name)].unit != "N" or not (feet == side).any():
            return None
        carried += float(np.nanmean(pooled.curves[feet == side, :, names.index(name)]))
    return 100.0 / carried if carried > LIGHTEST_N else None
