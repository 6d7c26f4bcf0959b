"""Strides cut at initial contacts; every stride that is not used says why."""

from __future__ import annotations

import numpy as np

from gaitdisc.errors import StrideError
from gaitdisc.recording import DroppedStride, Recording, Strides
from gaitdisc.recording.arrays import runs
from gaitdisc.signals.contacts import Contacts
from gaitdisc.signals.gaps import filled

MIN_S, MAX_S = 0.4, 2.5
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
    (4, '2.10 s differs from the median stride of 1.00 s by more than 15 % and 6 robust sd: a contact was missed')
    """
    if len(contacts) < 2:
        raise StrideError(
            "a stride needs two initial contacts of one foot",
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
            f"strides of side {contacts.side!r} need {min_s:g} to {max_s:g} s between contacts, without gaps",
            f"none of {len(start)} is left; the first at {start[0]:.2f} s: {reasons[0]}",
            "Check the contacts and the gaps, or change the limits in [strides].",
        )
    return Strides(start[kept], end[kept], contacts.side, contacts.detector, dropped)


def duration_reasons(duration: np.ndarray, min_s: float, max_s: float) -> list[str]:
    """Why strides of such durations are left out: a sentence for each, empty where it is kept.

    duration (stride,) [s]: of one foot, or of several trials of one person
    min_s, max_s: limits of a stride's duration [s]

    >>> duration_reasons(np.array([1.0, 0.2]), 0.4, 2.5)
    ['', '0.20 s is shorter than 0.4 s: a contact too many']
    """
    plausible = (duration >= min_s) & (duration <= max_s)
    median = float(np.median(duration[plausible])) if plausible.any() else float("nan")
    spread = 1.4826 * float(np.median(np.abs(duration[plausible] - median))) if plausible.any() else float("nan")
    limit = max(OUTLIER_SD * spread, OUTLIER_SHARE * median) if plausible.sum() >= 4 else float("inf")
    reasons = []
    for length in duration:
        if length < min_s:
            reasons.append(f"{length:.2f} s is shorter than {min_s:g} s: a contact too many")
        elif length > max_s:
            reasons.append(f"{length:.2f} s is longer than {max_s:g} s: a pause, or a contact was missed")
        elif abs(length - median) > limit:
            cause = "a contact was missed" if length > 1.7 * median else "a stumble, or a false contact"
            reasons.append(
                f"{length:.2f} s differs from the median stride of {median:.2f} s by more than "
                f"{100 * OUTLIER_SHARE:.0f} % and {OUTLIER_SD:g} robust sd: {cause}"
            )
        else:
            reasons.append("")
    return reasons


def gap_reasons(start: np.ndarray, end: np.ndarray, recording: Recording) -> list[str]:
    """Why strides are left out for what a recording lacks in them: a sentence for each, empty where it lacks nothing.

    start, end (stride,) [s]: initial contacts
    recording: channels without any value do not count; gaps of up to 0.1 s are bridged
    """
    missing = ~np.isfinite(filled(recording).values)
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
