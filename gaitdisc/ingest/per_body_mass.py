"""Ground forces and joint moments of a walk that are too small for newtons: they are divided by body mass."""

from __future__ import annotations

import re
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from gaitdisc.recording import Finding, Recording
from gaitdisc.recording.runs import runs

FORCE_N = (5.0, 40.0)  # peak of the vertical force: half to four body weights in N/kg; a child of 5 kg has 50 N
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
    for key, quantity, unit, (low, high), like in (
        ("forces", "vertical_force", "N", FORCE_N, "is loaded as in steps, where a person presses with hundreds of N"),
        ("moments", "moment", "N m", MOMENT_NM, "is the largest moment of the legs, where walking needs tens of N m"),
    ):
        if key not in streams:
            continue
        recording = streams[key]
        meant = [c.name for c in recording.channels if (c.quantity, c.unit) == (quantity, unit)]
        peaks = {name: _peak(recording[name]) for name in meant if key == "forces" or _LEG.fullmatch(name)}
        most = max(peaks, key=lambda name: peaks[name], default="")
        walks = recording.duration_s >= STANCE_S[0] and (key == "moments" or (most and _like_steps(recording, most)))
        if most and low <= peaks[most] <= high and walks:
            what = f"peaks at {peaks[most]:.3g} {unit} and {like}: it looks like {unit} per kg of body mass"
            spoils = f"contacts by force, moments and powers; state {unit}/kg, or multiply by body mass"
            found.append(Finding("warning", "per body mass", recording.source.file, what, spoils, most))
    return found


def _like_steps(forces: Recording, name: str) -> bool:
    force = np.abs(np.nan_to_num(forces[name]))
    peak = float(force.max())
    lengths = [(end - start) / forces.rate_hz for start, end in runs(force > SHARE * peak)]
    empty = float(np.mean(force < EMPTY * peak))
    return empty > EMPTY and max(lengths, default=0.0) >= STANCE_S[0] and max(lengths, default=0.0) <= STANCE_S[1]


def _peak(values: NDArray[np.float64]) -> float:
    finite = np.abs(values[np.isfinite(values)])
    return float(np.quantile(finite, 0.999)) if finite.size else 0.0
