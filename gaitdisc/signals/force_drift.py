"""Drift of a force plate or belt, seen while nobody stands on it."""

from __future__ import annotations

import itertools

import numpy as np
from numpy.typing import NDArray
from scipy.stats import theilslopes

from gaitdisc.recording import Finding, Recording
from gaitdisc.signals.contact_force import RISE_N, loaded

OFFSET_N = 10.0
DRIFT_N = 5.0
FEWEST_SWINGS = 5


def swing_baseline(force_n: NDArray[np.float64], rate_hz: float) -> NDArray[np.float64]:
    """Force in the middle half of every unloaded phase: its sample and its median.

    force_n (time,) [N]: vertical force of one plate, of either sign
    returns (swing, 2) [sample, N]

    >>> step = np.r_[np.full(60, 700.0), np.full(40, 3.0)]
    >>> swing_baseline(np.tile(step, 3), 100.0).tolist()
    [[80.0, 3.0], [180.0, 3.0]]
    """
    resting = np.nanmedian(force_n[np.abs(force_n) <= np.nanpercentile(np.abs(force_n), 25)])
    upward = force_n - resting
    if -np.nanmin(upward) > np.nanmax(upward):
        upward = -upward
    spans = loaded(upward, rate_hz, 2 * RISE_N)
    found = []
    for (_, off), (on, _) in itertools.pairwise(spans):
        quarter = (on - off) // 4
        middle = force_n[off + quarter : on - quarter]
        if len(middle) and np.isfinite(middle).any():
            found.append(((off + on) / 2, float(np.nanmedian(middle))))
    return np.array(found).reshape(-1, 2)


def drift_findings(forces: Recording) -> list[Finding]:
    """Say which plates do not rest at zero, or drift.

    The drift is the Theil-Sen slope of the swing baseline times the length of the trial, so single swings with the
    other foot on the belt do not count.

    forces: channels of quantity `vertical_force` [N]; others are passed over
    returns: a warning for an offset above 10 N or a drift above 5 N; a note where fewer than five swings show it
    """
    findings = []
    for channel in forces.channels:
        if channel.quantity != "vertical_force":
            continue
        baseline = swing_baseline(forces[channel.name], forces.rate_hz)
        if len(baseline) < FEWEST_SWINGS:
            if len(baseline):
                what = f"{len(baseline)} unloaded phases between steps where {FEWEST_SWINGS} are needed to see a drift"
                findings.append(Finding("note", "force drift", forces.source.file, what, "", channel.name))
            continue
        time = forces.time[0] + baseline[:, 0] / forces.rate_hz
        slope, _, low, high = np.asarray(theilslopes(baseline[:, 1], time), float).tolist()
        drift, offset = slope * (time[-1] - time[0]), float(np.median(baseline[:, 1]))
        drifts = abs(drift) > DRIFT_N and low * high > 0
        if not drifts and abs(offset) <= OFFSET_N:
            continue
        what = f"rests at {offset:+.1f} N (median of {len(baseline)} swings)"
        if drifts:
            what += f" and drifts by {drift:+.1f} N in {time[-1] - time[0]:.0f} s ({60 * slope:+.1f} N a minute)"
        findings.append(
            Finding(
                "warning",
                "force drift",
                forces.source.file,
                what,
                f"contacts near the threshold of {RISE_N:g} N, and moments: subtract the baseline",
                channel.name,
                ((float(time[0]), float(time[-1])),),
            )
        )
    return findings
