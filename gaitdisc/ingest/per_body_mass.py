"""Ground forces and joint moments of a walk that are too small for newtons: they are divided by body mass."""

from __future__ import annotations

import re
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from gaitdisc.recording import Finding, Recording
from gaitdisc.recording.runs import runs

FORCE_N = (
    5.0,
    40.0,
)  # peak of the vertical force: half to four body weights in N/kg; a child of 5 kg has 50 N and more
MOMENT_NM = (0.4, 6.0)  # peak of hip, knee and ankle in N m/kg; a child of 15 kg has 15 N m and more at push-off
STANCE_S = (0.15, 3.0)  # a plate is loaded for as long as a step lasts; drift is longer, noise shorter
SHARE = 0.5  # of the peak: above it while loaded
EMPTY = 0.1  # of the peak: below it while the foot swings
_LEG = re.compile(r"(ankle_angle|knee_angle|hip_flexion)_[rl]_moment")


def per_kg_findings(streams: Mapping[str, Recording]) -> list[Finding]:
    """Say that ground forces or joint moments stated in N or N m are per kg of body mass.

    >>> from gaitdisc.channel import vocabulary
    >>> steps = np.tile(np.r_[np.full(60, 9.8), np.zeros(40)], 3)[:, None]
    >>> belt = Recording(np.arange(300) / 100, steps, (vocabulary().named("ground_force_r_vy"),))
    >>> [finding.kind for finding in per_kg_findings({"forces": belt})]
    ['per body mass']
    """
    found = []
    if "forces" in streams:
        found += _forces(streams["forces"])
    if "moments" in streams:
        found += _moments(streams["moments"])
    return found


def _forces(forces: Recording) -> list[Finding]:
    upright = [c.name for c in forces.channels if (c.quantity, c.unit) == ("vertical_force", "N")]
    peaks = {name: _peak(forces[name]) for name in upright}
    most = max(peaks, key=lambda name: peaks[name], default="")
    if not most or not FORCE_N[0] <= peaks[most] <= FORCE_N[1] or not _like_steps(forces, most):
        return []
    what = (
        f"peaks at {peaks[most]:.3g} N and is loaded as in steps, where a person presses with hundreds of N: it looks "
        "like N per kg of body mass"
    )
    spoils = "contacts by force, moments and powers; multiply by body mass and export in N"
    return [Finding("warning", "per body mass", forces.source.file, what, spoils, most)]


def _like_steps(forces: Recording, name: str) -> bool:
    force = np.abs(np.nan_to_num(forces[name]))
    peak = float(force.max())
    lengths = [(end - start) / forces.rate_hz for start, end in runs(force > SHARE * peak)]
    empty = float(np.mean(force < EMPTY * peak))
    return empty > EMPTY and max(lengths, default=0.0) >= STANCE_S[0] and max(lengths, default=0.0) <= STANCE_S[1]


def _moments(moments: Recording) -> list[Finding]:
    legs = [c.name for c in moments.channels if c.unit == "N m" and _LEG.fullmatch(c.name)]
    peaks = {name: _peak(moments[name]) for name in legs}
    most = max(peaks, key=lambda name: peaks[name], default="")
    if not most or not MOMENT_NM[0] <= peaks[most] <= MOMENT_NM[1] or moments.duration_s < STANCE_S[0]:
        return []
    what = (
        f"is the largest moment of the legs, {peaks[most]:.3g} N m, where walking needs tens of N m: it looks like N m "
        "per kg of body mass"
    )
    spoils = "moments and powers; state N m/kg, or multiply by body mass"
    return [Finding("warning", "per body mass", moments.source.file, what, spoils, most)]


def _peak(values: NDArray[np.float64]) -> float:
    finite = np.abs(values[np.isfinite(values)])
    return float(np.quantile(finite, 0.999)) if finite.size else 0.0
