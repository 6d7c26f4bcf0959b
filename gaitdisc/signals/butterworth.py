"""Butterworth filter without lag, and what "fourth order" and "6 Hz" mean here.

"Fourth order" is the order of ONE pass; the filter runs forwards and backwards, so the roll-off is that of eighth order
and the phase is zero. `cutoff_hz` is the -3 dB frequency of one pass; two passes are 6 dB down there, and 3 dB down at
`effective_cutoff_hz`: 5.39 Hz for a low-pass of order 4 at 6 Hz and 100 samples a second. The dissertation states
neither (section 4.2.1: "low-pass filtered at 6Hz using a fourth-order Butterworth filter"). Laboratories that call two
passes of a second-order filter "fourth order" set `order=2`.
"""

import math

import numpy as np
from scipy.signal import butter, sosfiltfilt

from gaitdisc.errors import SamplingError
from gaitdisc.recording import Finding, Recording
from gaitdisc.recording.arrays import runs, spans_s
from gaitdisc.recording.wrapping import unwrap, wrap_recording
from gaitdisc.signals.gaps import MAX_SPLINE_S, fill_gaps
from gaitdisc.words import counted

KINEMATICS_HZ = 6.0
EDGE_PERIODS = 1.8  # of the cut-off: 0.3 s at 6 Hz; measured in docs/derivatives.md


def effective_cutoff_hz(cutoff_hz: float, rate_hz: float, order: int = 4) -> float:
    """Frequency at which the two passes of a low-pass together are 3 dB down.

    Each pass has |H|^2 = 1 / (1 + w^(2n)) with w = tan(pi f / rate) / tan(pi fc / rate); both together pass half of the
    power where w^(2n) = sqrt(2) - 1.

    >>> round(effective_cutoff_hz(6.0, 100.0), 2)
    5.39
    """
    w = (math.sqrt(2.0) - 1.0) ** (1.0 / (2 * order))
    return rate_hz / math.pi * math.atan(w * math.tan(math.pi * cutoff_hz / rate_hz))


def low_pass(
    recording: Recording, cutoff_hz: float = KINEMATICS_HZ, order: int = 4, max_gap_s: float = MAX_SPLINE_S
) -> Recording:
    """Recording without what is faster than the cut-off; zero lag.

    Gaps up to `max_gap_s` are bridged by a cubic spline and marked suspect; longer ones stay NaN, and what lies between
    them is filtered run by run. 1.8 periods of the cut-off at both ends of each run are marked suspect. A heading that
    passes 180 deg is filtered as it goes on, and comes round again afterwards.
    """
    return _filter(recording, cutoff_hz, order, "lowpass", max_gap_s)


def high_pass(
    recording: Recording, cutoff_hz: float = 40.0, order: int = 4, max_gap_s: float = MAX_SPLINE_S
) -> Recording:
    """Recording without what is slower than the cut-off; zero lag; otherwise as `low_pass`."""
    return _filter(recording, cutoff_hz, order, "highpass", max_gap_s)


def count_needed(cutoff_hz: float, rate_hz: float, order: int = 4) -> int:
    """Shortest run that is filtered: longer than the padding, which is one period of the cut-off.

    >>> count_needed(6.0, 100.0)
    18
    """
    return max(math.ceil(rate_hz / cutoff_hz), 3 * (order + 1)) + 1


def short_run_findings(
    recording: Recording, cutoff_hz: float = KINEMATICS_HZ, order: int = 4, max_gap_s: float = MAX_SPLINE_S
) -> list[Finding]:
    """Say which stretches between gaps are too short to filter."""
    bridged = fill_gaps(recording, None, max_gap_s)
    need, file = count_needed(cutoff_hz, recording.rate_hz, order), recording.source.file
    findings = []
    for column, channel in enumerate(recording.channels):
        short = np.zeros(len(recording.time), bool)
        for start, end in runs(np.isfinite(bridged.values[:, column])):
            short[start:end] = end - start < need
        if short.any():
            segments, least_s = counted(len(runs(short)), "segment"), need / recording.rate_hz
            what = f"{segments} between gaps, each shorter than {need} samples ({least_s:.3f} s)"
            spoils = f"these segments, which are excluded: a filter of {cutoff_hz:g} Hz requires {need} samples"
            spans = spans_s(recording.time, short)
            findings.append(Finding("warning", "short run", file, what, spoils, channel=channel.name, spans=spans))
    return findings


def _filter(recording: Recording, cutoff_hz: float, order: int, kind: str, max_gap_s: float) -> Recording:
    if not isinstance(cutoff_hz, int | float | np.number):
        raise SamplingError(
            f"the cut-off of a {kind} filter must be one number [Hz]",
            f"found {cutoff_hz!r}",
            "Filter twice for a band: first highpass, then lowpass.",
        )
    rate = recording.rate_hz
    file = recording.source.file or "the recording"
    need = count_needed(cutoff_hz, rate, order) if cutoff_hz > 0 and rate > 0 else 2
    if len(recording.time) < need:
        raise SamplingError(
            f"for a {kind} filter of {cutoff_hz:g} Hz, there must be at least {need} samples",
            f"{file} has {len(recording.time)}",
            "Record longer, or choose a higher cut-off.",
        )
    if not 0.0 < cutoff_hz < rate / 2:
        raise SamplingError(
            f"the cut-off of a {kind} filter must lie between 0 Hz and half the rate, {rate / 2:g} Hz",
            f"the requested cut-off is {cutoff_hz:g} Hz and {file} has {rate:g} samples per second",
            "Lower the cut-off in [filters], or export the raw signal at its full rate.",
        )
    sections = np.asarray(butter(order, cutoff_hz, kind, fs=rate, output="sos"))
    bridged = fill_gaps(unwrap(recording), None, max_gap_s)
    edge = math.ceil(EDGE_PERIODS / cutoff_hz * rate)
    values = np.full(recording.values.shape, np.nan)
    marks = np.array(bridged.suspect)
    shared: dict[tuple[int, int], list[int]] = {}  # columns whose runs begin and end together are filtered in one call
    for column, known in enumerate(np.isfinite(bridged.values).T):
        for start, end in runs(known).tolist():
            shared.setdefault((start, end), []).append(column)
    for (start, end), columns in shared.items():
        if end - start < need:
            continue
        x = bridged.values[start:end, columns]
        offset = x[0]  # keeps a constant channel constant to the last digit
        both = sosfiltfilt(sections, x - offset, axis=0, padtype="odd", padlen=need - 1)
        gain_at_zero = round(float(np.prod(sections[:, :3].sum(axis=1) / sections[:, 3:].sum(axis=1))))
        values[start:end, columns] = both + offset * float(gain_at_zero)
        marks[start : start + edge, columns] = True
        marks[max(start, end - edge) : end, columns] = True
    smooth = recording.with_values(values, marks)
    return wrap_recording(smooth, recording) if kind == "lowpass" else smooth
