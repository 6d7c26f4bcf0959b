"""Channels that say nothing, or not what was measured: empty, flat, clipped, jumping, drifting, or at a limit.

At a limit of the model a joint angle is flat where a joint would turn, so that accelerations are false.
"""

import itertools
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.stats import theilslopes

from gaitdisc.recording import Finding, Recording
from gaitdisc.recording.arrays import Span, Values, finite_values, robust_sd, runs, spans_s
from gaitdisc.recording.wrapping import unwrap
from gaitdisc.signals.contacts import RISE_N, loaded
from gaitdisc.signals.gaps import gap_findings
from gaitdisc.words import counted

CLIPPED_SHARE = 1e-3
FEWEST_CLIPPED, REST_SHARE = 5, 0.05  # samples; of the largest force: a plate at rest, which holds no peak
JUMP_TIMES = 10.0
REST_QUANTITIES = ("force", "vertical_force", "moment", "pressure_centre", "power")  # zero when the foot is off
OFFSET_N = 10.0
DRIFT_N = 5.0
FEWEST_SWINGS = 5
BAND_SHARE = 0.01  # of the angle's reach: how near the limit counts as on it
DWELL_TIMES = 2.0  # what a sine of the same reach stays in the band
SPREAD_SHARE = 0.006  # of the reach: how much the turning points of a free joint differ at least
CORNER = 0.6  # of the time within 4 % of the reach, spent within 1 %: a parabola has 0.5, a peak with a shoulder less
SHORTEST_S = 0.05
FEWEST = 3  # dwells at a limit
BESIDE_S = 0.05
FEWEST_REACH_DEG = 2.0
NO_MODEL = "ezc3d"  # reader of files whose angles come from segments, not from a model's coordinates


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
    recording = unwrap(recording)
    for column, channel in enumerate(recording.channels):
        x = recording.values[:, column]
        if not np.isfinite(x).any() or channel.quantity == "emg":
            continue
        if np.nanmax(x) == np.nanmin(x):
            what = f"{np.nanmax(x):.4g} {channel.unit} throughout"
            spoils = "the channel as an output: the coordinate is locked, or nothing was measured"
            findings.append(Finding("note", "flat", recording.source.file, what, spoils, channel.name))
            continue
        rests = channel.quantity in REST_QUANTITIES
        stops = mark_clips(x, rests)
        values = " and ".join(f"{value:.4g}" for value in np.unique(x[stops]))
        jumps = np.zeros(len(x), bool) if rests else jumping(x)
        for kind, marks, happens, lost in (
            ("clipped", stops, f"stops at {values} {channel.unit}", "the peaks, which are lost"),
            ("jump", jumps, "jumps from one sample to the next", "velocity and acceleration there"),
        ):
            if marks.any():
                seconds = marks.sum() / recording.rate_hz
                where = f"{happens}, in {counted(len(runs(marks)), 'place')}, {seconds:.2f} s in all"
                file, spans = recording.source.file, spans_s(recording.time, marks)
                findings.append(Finding("warning", kind, file, where, lost, channel.name, spans=spans))
    return findings


def mark_clips(x: Values, rests_at_zero: bool = False) -> NDArray[np.bool_]:
    """Mark the samples (time,) at which the largest or the smallest value is met, if too often to be chance.

    >>> t = np.arange(1000) / 100
    >>> bool(mark_clips(np.sin(6 * t)).any()), bool(mark_clips(np.minimum(np.sin(6 * t), 0.9)).any())
    (False, True)
    """
    marks = np.zeros(len(x), bool)
    for extreme in (np.nanmin(x), np.nanmax(x)):
        if rests_at_zero and abs(extreme) <= REST_SHARE * np.nanmax(np.abs(x)):
            continue
        at = x == extreme
        together = sum(int(end - start) for start, end in runs(at) if end - start > 1)
        if together >= max(FEWEST_CLIPPED, CLIPPED_SHARE * len(x)):
            marks |= at
    return marks


def jumping(x: Values) -> NDArray[np.bool_]:
    """Mark the samples (time,) of a channel that is not filtered beside an implausible second difference.

    >>> x = np.sin(np.arange(1000) / 15)
    >>> x[500] += 1
    >>> np.flatnonzero(jumping(x)).tolist()
    [498, 499, 500, 501, 502]
    """
    bend = np.abs(np.diff(x, 2))
    known = finite_values(bend)
    marks = np.zeros(len(x), bool)
    if len(known) < 100:
        return marks
    for at in np.flatnonzero(bend > JUMP_TIMES * np.percentile(known, 95)):
        marks[max(0, at) : at + 3] = True
    return marks


def swing_baseline(force_n: Values, rate_hz: float) -> Values:
    """Sample and median force [N] of the middle half of every unloaded phase of a plate, (swing, 2).

    >>> step = np.r_[np.full(60, 700.0), np.full(40, 3.0)]
    >>> swing_baseline(np.tile(step, 3), 100.0).tolist()
    [[80.0, 3.0], [180.0, 3.0]]
    """
    resting = np.nanmedian(force_n[np.abs(force_n) <= np.nanpercentile(np.abs(force_n), 25)])
    upward = force_n - resting
    if -np.nanmin(upward) > np.nanmax(upward):
        upward = -upward
    spans = loaded(upward, rate_hz, 2 * RISE_N)
    baseline = []
    for (_, off), (on, _) in itertools.pairwise(spans):
        quarter = (on - off) // 4
        middle = force_n[off + quarter : on - quarter]
        if len(middle) and np.isfinite(middle).any():
            baseline.append(((off + on) / 2, float(np.nanmedian(middle))))
    return np.array(baseline).reshape(-1, 2)


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
                what = f"only {counted(len(baseline), 'unloaded phase')} between steps; the test needs {FEWEST_SWINGS}"
                findings.append(Finding("note", "force drift", forces.source.file, what, "", channel.name))
            continue
        time = forces.time[0] + baseline[:, 0] / forces.rate_hz
        slope, _, low, high = np.asarray(theilslopes(baseline[:, 1], time), float).tolist()
        drift, offset = slope * (time[-1] - time[0]), float(np.median(baseline[:, 1]))
        drifts = abs(drift) > DRIFT_N and low * high > 0
        if not drifts and abs(offset) <= OFFSET_N:
            continue
        what = f"reads {offset:+.1f} N when unloaded (median of {len(baseline)} swings)"
        if drifts:
            what += f" and drifts by {drift:+.1f} N in {time[-1] - time[0]:.0f} s ({60 * slope:+.1f} N per minute)"
        spoils = f"contacts near the threshold of {RISE_N:g} N, and moments; subtract the baseline"
        spans = (Span(float(time[0]), float(time[-1])),)
        findings.append(Finding("warning", "force drift", forces.source.file, what, spoils, channel.name, spans=spans))
    return findings


@dataclass(frozen=True, eq=False)
class Plateau:
    """A limit at which one angle stops."""

    channel: str
    limit: float  # value at the plateau [deg]
    marks: NDArray[np.bool_]  # (time,), samples on it


def plateaus(kinematics: Recording) -> list[Plateau]:
    """Find the limits at which joint angles stop, from the angles themselves.

    A joint that turns freely turns at another angle in every stride and dwells near it for a moment only: within 1 % of
    its reach a sine stays 6 % of the time. An angle is at a limit where its dwells near its largest or smallest value
    (1) come three times or more, (2) last 0.05 s or longer, twice the sine's share of the time in all, (3) end at
    values that differ by less than 0.6 % of the reach (robust standard deviation), where free joints differ by more,
    and (4) begin and end at a corner: of the time within 4 % of the reach, 60 % or more is spent within 1 %. The hips
    of treadmill_walk_ik, whose model's limit is soft, have 74 to 88 % there, knees at their limit 70 to 74 %, ordinary
    peaks of C3D files that pass (1) to (3) 11 to 28 %. Angles of a C3D file come from no model with limits: none is
    looked for.

    >>> from gaitdisc.channel import Channel
    >>> t, rng = np.arange(2000) / 100, np.random.default_rng(0)
    >>> hip = 30 * np.cos(2 * np.pi * t) * (1 + 0.03 * np.repeat(rng.normal(size=20), 100))
    >>> x = np.column_stack([hip, np.maximum(hip, -20)])
    >>> names = (Channel("hip_flexion_r", "angle", "deg", "r"), Channel("hip_flexion_l", "angle", "deg", "l"))
    >>> [(p.channel, round(p.limit, 1)) for p in plateaus(Recording(t, x, names))]
    [('hip_flexion_l', -20.0)]
    """
    if kinematics.source.reader.startswith(NO_MODEL):
        return []
    limits = []
    for column, channel in enumerate(kinematics.channels):
        if channel.quantity != "angle":
            continue
        x = kinematics.values[:, column]
        known = finite_values(x)
        if len(known) < 10 or np.subtract(*np.percentile(known, [99, 1])) < FEWEST_REACH_DEG:
            continue
        for sign in (-1.0, 1.0):
            marks = _dwells(sign * x, kinematics.rate_hz)
            if marks is not None:
                limits.append(Plateau(channel.name, float(np.median(x[marks])), marks))
    return limits


def plateau_findings(kinematics: Recording) -> list[Finding]:
    """Say which angles stop at a limit of the model, where, and for how much of the time."""
    findings, file = [], kinematics.source.file
    spoils = "velocity and acceleration there; widen the coordinate's range in the model and repeat inverse kinematics"
    for plateau in plateaus(kinematics):
        places, percent = len(runs(plateau.marks)), 100 * plateau.marks.mean()
        what = f"stops at {plateau.limit:.1f} deg in {places} places, in {percent:.0f} % of the samples"
        spans = spans_s(kinematics.time, plateau.marks)
        findings.append(Finding("warning", "plateau", file, what, spoils=spoils, channel=plateau.channel, spans=spans))
    return findings


def plateau_marked(kinematics: Recording) -> Recording:
    """Mark what lies on a plateau, or within 0.05 s of one, as suspect; before filtering, while limits are sharp."""
    marks = np.zeros(kinematics.values.shape, bool)
    beside = round(BESIDE_S * kinematics.rate_hz)
    for plateau in plateaus(kinematics):
        column = kinematics.index(plateau.channel)
        for start, end in runs(plateau.marks):
            marks[max(0, start - beside) : end + beside, column] = True
    return kinematics.with_values(kinematics.values, marks)


def _dwells(x: Values, rate_hz: float) -> NDArray[np.bool_] | None:
    """Samples on a plateau at the top of x, or None."""
    known = finite_values(x)
    reach = float(known.max() - np.percentile(known, 1))
    top = float(np.percentile(known, 99.5))
    near = np.isfinite(x) & (x >= top - BAND_SHARE * reach)
    spans = [(a, b) for a, b in runs(near) if (b - a) / rate_hz >= SHORTEST_S]
    if len(spans) < FEWEST:
        return None
    marks = np.zeros(len(x), bool)
    for start, end in spans:
        marks[start:end] = True
    highest = np.array([x[start:end].max() for start, end in spans])
    sine = 2 / np.pi * float(np.arcsin(np.sqrt(BAND_SHARE)))
    if marks.mean() < DWELL_TIMES * sine or robust_sd(highest) > SPREAD_SHARE * reach:
        return None
    wide = np.empty((len(spans), 2))  # samples in a row about each peak within 1 % of the reach, and within 4 %
    for dwell, (start, end) in enumerate(spans):
        peak = start + int(np.argmax(x[start:end]))
        for column, share in enumerate((BAND_SHARE, 4 * BAND_SHARE)):
            wide[dwell, column] = next(b - a for a, b in runs(x >= x[peak] - share * reach) if a <= peak < b)
    return marks if np.median(wide[:, 0] / wide[:, 1]) >= CORNER else None
