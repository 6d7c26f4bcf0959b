"""Channels that say nothing, or not what was measured: empty, flat, clipped, jumping, plates that drift."""

from __future__ import annotations

import itertools

import numpy as np
from numpy.typing import NDArray
from scipy.stats import theilslopes

from gaitdisc.recording import Finding, Recording
from gaitdisc.recording.runs import runs, spans_s
from gaitdisc.recording.wrapping import unwrapped
from gaitdisc.signals.contacts import RISE_N, loaded
from gaitdisc.signals.gaps import gap_findings

CLIPPED_SHARE = 1e-3
FEWEST_CLIPPED = 5
JUMP_TIMES = 10.0
REST_QUANTITIES = ("force", "vertical_force", "moment", "pressure_centre", "power")  # zero when the foot is off
OFFSET_N = 10.0
DRIFT_N = 5.0
FEWEST_SWINGS = 5


def channel_findings(recording: Recording) -> list[Finding]:
    """Say which channels are empty, flat, clipped or jumping, and where the gaps are.

    - flat: one value throughout, as a locked coordinate has; a note, since it is often meant.
    - clipped: the largest or smallest value is met, exactly, in five samples and one in a thousand or more.
    - jump: a second difference ten times as large as its 95th percentile (in clean trials the largest is two to seven
      times): swapped markers, or inverse kinematics that lost its way for a frame.

    recording: as read, not filtered. EMG has rules of its own (`emg_findings`); its channels are looked at for gaps
        only
    """
    findings = gap_findings(recording)
    recording = unwrapped(recording)
    for column, channel in enumerate(recording.channels):
        x = recording.values[:, column]
        if not np.isfinite(x).any() or channel.quantity == "emg":
            continue
        if np.nanmax(x) == np.nanmin(x):
            findings.append(
                Finding(
                    "note",
                    "flat",
                    recording.source.file,
                    f"{np.nanmax(x):.4g} {channel.unit} throughout",
                    "the channel as something to predict: a locked coordinate, or nothing was measured",
                    channel.name,
                )
            )
            continue
        rests = channel.quantity in REST_QUANTITIES
        for kind, marks in (
            ("clipped", clipped(x, rests)),
            ("jump", np.zeros(len(x), bool) if rests else jumping(x)),
        ):
            if marks.any():
                findings.append(_finding(recording, column, kind, marks))
    return findings


def clipped(x: NDArray[np.float64], rests_at_zero: bool = False) -> NDArray[np.bool_]:
    """Mark where the largest or the smallest value is met, if it is met too often to be chance.

    x (time,): one channel

    >>> t = np.arange(1000) / 100
    >>> bool(clipped(np.sin(6 * t)).any()), bool(clipped(np.minimum(np.sin(6 * t), 0.9)).any())
    (False, True)
    """
    marks = np.zeros(len(x), bool)
    for extreme in (np.nanmin(x), np.nanmax(x)):
        if rests_at_zero and extreme == 0:
            continue
        at = x == extreme
        together = sum(int(end - start) for start, end in runs(at) if end - start > 1)
        if together >= max(FEWEST_CLIPPED, CLIPPED_SHARE * len(x)):
            marks |= at
    return marks


def jumping(x: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Mark the samples beside an implausible second difference.

    x (time,): one channel, not filtered

    >>> x = np.sin(np.arange(1000) / 15)
    >>> x[500] += 1
    >>> np.flatnonzero(jumping(x)).tolist()
    [498, 499, 500, 501, 502]
    """
    bend = np.abs(np.diff(x, 2))
    known = bend[np.isfinite(bend)]
    marks = np.zeros(len(x), bool)
    if len(known) < 100:
        return marks
    for at in np.flatnonzero(bend > JUMP_TIMES * np.percentile(known, 95)):
        marks[max(0, at) : at + 3] = True
    return marks


def _finding(recording: Recording, column: int, kind: str, marks: NDArray[np.bool_]) -> Finding:
    channel, x = recording.channels[column], recording.values[:, column]
    places = len(runs(marks))
    seconds = marks.sum() / recording.rate_hz
    stops = " and ".join(f"{value:.4g}" for value in np.unique(x[marks]))
    words = {
        "clipped": (f"stops at {stops} {channel.unit}", "the peaks, which are lost"),
        "jump": ("leaps from one sample to the next", "velocity and acceleration there"),
    }
    what, spoils = words[kind]
    where = f"in {places} place{'s' if places > 1 else ''}, {seconds:.2f} s in all"
    return Finding(
        "warning",
        kind,
        recording.source.file,
        f"{what}, {where}",
        spoils,
        channel.name,
        spans_s(recording.time, marks),
    )


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
