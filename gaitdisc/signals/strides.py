"""Strides cut at initial contacts, each unused one with its reason; whether a trial is walking at all."""

from dataclasses import dataclass

import numpy as np

from gaitdisc.errors import StrideError
from gaitdisc.recording import DroppedStride, Recording, Strides
from gaitdisc.recording.arrays import Values, finite_values, robust_sd, runs
from gaitdisc.signals.contacts import Contacts
from gaitdisc.signals.gaps import fill_gaps
from gaitdisc.words import counted

MIN_S, MAX_S = 0.4, 2.5  # of a stride in walking and running
OUTLIER_SD = 6.0
OUTLIER_SHARE = 0.15  # of the median; the larger of both limits counts


def cut_strides(
    contacts: Contacts, recording: Recording | None = None, min_s: float = MIN_S, max_s: float = MAX_S
) -> Strides:
    """Strides from each contact to the next of the same foot.

    Dropped, with the reason in words: strides shorter than `min_s` or longer than `max_s`; strides whose duration
    differs from the median of the rest by more than 15 % and more than 6 robust standard deviations (a missed or a
    false contact, a stumble); strides in which a channel has a gap that cannot be filled, or which the recording does
    not cover.

    recording: what will be analysed in the strides; channels without any value do not count
    min_s, max_s: limits of a stride's duration [s]

    >>> strides = cut_strides(Contacts(np.array([0.0, 1.0, 2.0, 3.1, 5.2, 6.2]), "r", "force"))
    >>> len(strides), strides.dropped[0].reason
    (4, '2.10 s differs from the median stride of 1.00 s by more than 15 % and 6 robust SD: a contact was missed')
    """
    if len(contacts) < 2:
        raise StrideError(
            "a stride must have two initial contacts of the same foot",
            f"{contacts.detector} found {len(contacts)} of side {contacts.side!r}",
            "Record longer, or choose another detector in [strides].",
        )
    start, end = contacts.time[:-1], contacts.time[1:]
    reasons = duration_reasons(end - start, min_s, max_s)
    if recording is not None:
        for stride, reason in enumerate(gap_reasons(start, end, recording)):
            reasons[stride] = reasons[stride] or reason
    kept = np.array([not reason for reason in reasons])
    dropped = tuple(DroppedStride(float(start[k]), float(end[k]), reason) for k, reason in enumerate(reasons) if reason)
    if not kept.any():
        raise StrideError(
            f"strides of side {contacts.side!r} must have {min_s:g} to {max_s:g} s between contacts, without gaps",
            f"none of {len(start)} qualifies; the first, at {start[0]:.2f} s: {reasons[0]}",
            "Check the contacts and the gaps, or change the limits in [strides].",
        )
    return Strides(start[kept], end[kept], contacts.side, contacts.detector, dropped)


def duration_reasons(duration: np.ndarray, min_s: float, max_s: float) -> list[str]:
    """Why strides of such durations are left out: a sentence for each, empty where it is kept.

    duration (stride,) [s]: of one foot, or of several trials of one person

    >>> duration_reasons(np.array([1.0, 0.2]), 0.4, 2.5)
    ['', '0.20 s is shorter than 0.4 s: one contact is probably false']
    """
    plausible = (duration >= min_s) & (duration <= max_s)
    median = float(np.median(duration[plausible])) if plausible.any() else float("nan")
    spread = robust_sd(duration[plausible]) if plausible.any() else float("nan")
    limit = max(OUTLIER_SD * spread, OUTLIER_SHARE * median) if plausible.sum() >= 4 else float("inf")
    reasons = []
    for length in duration:
        if length < min_s:
            reasons.append(f"{length:.2f} s is shorter than {min_s:g} s: one contact is probably false")
        elif length > max_s:
            reasons.append(f"{length:.2f} s is longer than {max_s:g} s: the person paused, or a contact was missed")
        elif abs(length - median) > limit:
            cause = "a contact was missed" if length > 1.7 * median else "a stumble, or a false contact"
            reasons.append(
                f"{length:.2f} s differs from the median stride of {median:.2f} s by more than "
                f"{100 * OUTLIER_SHARE:.0f} % and {OUTLIER_SD:g} robust SD: {cause}"
            )
        else:
            reasons.append("")
    return reasons


def gap_reasons(start: np.ndarray, end: np.ndarray, recording: Recording) -> list[str]:
    """Why strides are left out for what a recording lacks in them: a sentence for each, empty where it lacks nothing.

    recording: channels without any value do not count; gaps of up to 0.1 s are bridged
    """
    missing = ~np.isfinite(fill_gaps(recording).values)
    columns = np.flatnonzero(~missing.all(axis=0))
    step = 1.0 / recording.rate_hz
    reasons = []
    for a, b in zip(start, end, strict=True):
        if a < recording.time[0] - step / 2 or b > recording.time[-1] + step / 2:
            reasons.append(f"the recording covers {recording.time[0]:.2f} to {recording.time[-1]:.2f} s only")
            continue
        first, last = np.searchsorted(recording.time, [a - step / 2, b + step / 2])
        holes = {
            recording.names[column]: max(e - s for s, e in runs(missing[first:last, column])) * step
            for column in columns
            if missing[first:last, column].any()
        }
        if holes:
            worst = max(holes, key=lambda name: holes[name])
            more = f" and {len(holes) - 1} more channels" if len(holes) > 1 else ""
            reasons.append(f"{worst}{more} missing for {holes[worst]:.2f} s")
        else:
            reasons.append("")
    return reasons


FEWEST_STRIDES = 3
LEAST_REGULARITY = 0.72
LEAST_COVERAGE = 0.6
LEAST_KNEE_DEG = 25.0


@dataclass(frozen=True)
class Walking:
    """How steadily somebody walks."""

    strides: int
    stride_s: float  # median duration [s]
    coverage: float  # share of the time between first and last sample that strides cover
    # median over hips and knees of the correlation with the same angle one stride later; NaN where the recording is
    # shorter than four strides
    regularity: float
    knee_deg: float  # excursion of the knee that bends more, 5th to 95th percentile; NaN without a knee


def verify_walking(
    kinematics: Recording, strides: Strides, fewest: int = FEWEST_STRIDES, least_coverage: float = LEAST_COVERAGE
) -> Walking:
    """Refuse a trial that is not walking or running.

    Walking means: at least `fewest` strides, which cover 60 % of the trial, repeat with a correlation of 0.72 or more,
    and bend a knee by 25 deg or more. On treadmill_walk_ik the twelve walks, each with a stumble, have 0.82 to 0.98
    and cover 84 to 96 %; the two range-of-motion trials 0.58 and 0.64 and cover below 20 %.

    least_coverage: share of the trial; 0 for walks over ground that begin and end within the trial
    """
    hips_and_knees = {f"{joint}_{side}" for joint in ("hip_flexion", "knee_angle") for side in "rl"}
    known = {n: x for n in kinematics.names if n in hips_and_knees and len(x := finite_values(kinematics[n]))}
    median = float(np.median(strides.duration_s)) if len(strides) else float("nan")
    regularity = float("nan")
    if known and kinematics.duration_s > 4 * median:
        regularity = float(np.median([stride_period(kinematics[name], kinematics.rate_hz)[1] for name in known]))
    knees = [float(np.subtract(*np.percentile(x, [95, 5]))) for name, x in known.items() if name.startswith("knee")]
    walking = Walking(
        len(strides),
        median,
        float(np.sum(strides.duration_s) / kinematics.duration_s),
        regularity,
        max(knees) if knees else float("nan"),  # of the better leg: a stiff knee walks too
    )
    fails = []
    if walking.strides < fewest:
        fails.append(f"{counted(walking.strides, 'stride')}, but {fewest} are needed")
    if walking.coverage < least_coverage:
        fails.append(f"strides cover {100 * walking.coverage:.0f} % of {kinematics.duration_s:.1f} s")
    if walking.regularity < LEAST_REGULARITY:
        fails.append(f"hip and knee angles repeat with a correlation of {walking.regularity:.2f}")
    if walking.knee_deg < LEAST_KNEE_DEG:
        fails.append(f"the larger of the two knee ranges of motion is {walking.knee_deg:.0f} deg")
    if fails:
        covering = f" over at least {100 * least_coverage:.0f} % of the trial" if least_coverage else ""
        raise StrideError(
            f"a walk must have at least {counted(fewest, 'stride')}{covering}, a stride-to-stride correlation of at "
            f"least {LEAST_REGULARITY:g}, and a knee range of motion of at least {LEAST_KNEE_DEG:g} deg on one side",
            f"{kinematics.source.file or 'the recording'}: {'; '.join(fails)}",
            "Remove calibration and range-of-motion trials from the study, or cut the trial to its walking part.",
        )
    return walking


def stride_period(x: Values, rate_hz: float) -> tuple[float, float]:
    """Period at which an angle repeats, and how well.

    The autocorrelation is that of the two overlapping parts (each lag has its own means and variances), so a perfectly
    repeated stride gives 1 at every multiple of its period. The shortest lag whose peak comes within 0.1 of the highest
    one is the period.

    x (time,): NaN allowed; lags use the pairs that are there
    returns period_s, regularity: NaN and 0 where nothing repeats or the recording is shorter than 1.7 strides.
        Regularity is the correlation at the period, -1 to 1

    >>> t = np.arange(1000) / 100
    >>> period, regularity = stride_period(np.sin(2 * np.pi * t) + 0.5 * np.sin(4 * np.pi * t), 100.0)
    >>> round(period, 2), round(regularity, 2)
    (1.0, 1.0)
    """
    first = max(1, round(MIN_S * rate_hz))
    last = min(round(MAX_S * rate_hz), int(0.6 * len(x)))
    if last <= first + 1 or np.isfinite(x).sum() < first:
        return float("nan"), 0.0
    lags = np.arange(first - 1, last + 2)
    r = np.zeros(len(lags))
    for place, lag in enumerate(lags):
        both = np.isfinite(x[:-lag]) & np.isfinite(x[lag:])
        if np.count_nonzero(both) >= 10:
            a, b = (part - part.mean() for part in (x[:-lag][both], x[lag:][both]))
            size = float(np.sqrt((a @ a) * (b @ b)))
            r[place] = float(a @ b) / size if size > 0 else 0.0
    inner = r[1:-1]
    peaks = np.flatnonzero((inner > r[:-2]) & (inner >= r[2:]) & (inner > 0)) + 1
    if not len(peaks):
        return float("nan"), 0.0
    first_high = peaks[np.flatnonzero(r[peaks] >= r[peaks].max() - 0.1)[0]]
    left, centre, right = r[first_high - 1 : first_high + 2]
    shift = 0.5 * (left - right) / (left - 2 * centre + right)
    return float((lags[first_high] + shift) / rate_hz), float(centre)
