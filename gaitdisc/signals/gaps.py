"""Gaps: found, bridged where short; and spikes, samples that no limb can have reached, made gaps."""

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from gaitdisc.recording import PERCENT, Finding, Recording, Strides
from gaitdisc.recording.arrays import Values, finite_rows, finite_values, robust_sd, runs, spans_s
from gaitdisc.recording.wrapping import unwrap, wrap_recording
from gaitdisc.words import counted

MAX_SPLINE_S = 0.1
MAX_TEMPLATE_S = 0.2
BESIDE_GAP_S = 0.15  # docs/derivatives.md: how far beside a gap that stays open an acceleration is spoiled
SUPPORT_S = 0.2  # what a spline sees on either side of a gap
FEWEST_TEMPLATE_STRIDES = 5


def fill_gaps(
    recording: Recording,
    strides: Strides | None = None,
    max_spline_s: float = MAX_SPLINE_S,
    max_template_s: float = MAX_TEMPLATE_S,
) -> Recording:
    """Short gaps filled, longer ones left open; whatever was filled is marked.

    Up to `max_spline_s` a cubic spline through 0.2 s of samples on either side; up to `max_template_s`, where strides
    are given, the person's own mean stride plus a straight line through the residuals at both ends of the gap; beyond
    that nothing, and the samples within 0.15 s of the gap are marked suspect. Never a straight line alone. The limits
    come from measured errors of the acceleration (docs/derivatives.md). Gaps at either end stay open.

    strides: strides of one leg, for the template; at least 5 of them must be without a gap in the channel
    max_spline_s, max_template_s: longest gap for the spline and for the template [s]
    """
    given, recording = recording, unwrap(recording)
    values, marks = np.array(recording.values), np.zeros(recording.values.shape, bool)
    rate = recording.rate_hz
    phi = None if strides is None else strides.phi(recording.time)
    for column in range(values.shape[1]):
        missing = ~np.isfinite(values[:, column])
        if not missing.any() or missing.all():
            continue
        template = None
        if strides is not None:
            curves = strides.normalised(recording.selected([recording.names[column]]))[:, :, 0]
            complete = finite_rows(curves)
            template = complete.mean(axis=0) if len(complete) >= FEWEST_TEMPLATE_STRIDES else None
        for start, end in runs(missing):
            length_s = (end - start) / rate
            put = None
            if start > 0 and end < len(missing):
                if length_s <= max_spline_s + 1e-9:
                    put = _spline(recording.values[:, column], start, end, round(SUPPORT_S * rate))
                elif template is not None and phi is not None and length_s <= max_template_s + 1e-9:
                    put = _on_template(recording.values[:, column], start, end, phi, template)
            if put is None:
                beside = round(BESIDE_GAP_S * rate)
                marks[max(0, start - beside) : end + beside, column] = True
            else:
                values[start:end, column] = put
                marks[start:end, column] = True
    return wrap_recording(recording.with_values(values, marks), given)


def gap_findings(recording: Recording) -> list[Finding]:
    """Say which channels have gaps, and which of these can be filled.

    returns: a note where all gaps are short, a warning where some are not or the channel is empty; one for the three
        coordinates of a marker
    """
    findings = []
    for channel in recording.channels:
        if channel.quantity == "marker" and not channel.name.endswith(".x"):
            continue
        spans = spans_s(recording.time, ~np.isfinite(recording[channel.name]))
        if not spans:
            continue
        longest, missing = max(span.seconds for span in spans), sum(span.seconds for span in spans)
        fits = longest <= MAX_SPLINE_S + 1e-9  # at an end too: a recording that begins so much later lacks nothing
        gaps = counted(len(spans), "gap")
        what = f"{gaps}, {missing:.3f} s of {recording.duration_s:.2f} s, the longest {longest:.3f} s"
        spoils = f"accelerations within {BESIDE_GAP_S:g} s of gaps longer than {MAX_SPLINE_S:g} s; they are excluded"
        if fits:
            spoils = "nothing: gaps are filled by a cubic spline and marked; gaps at the ends are excluded"
        name = channel.name.removesuffix(".x") if channel.quantity == "marker" else channel.name
        severity, file = "note" if fits else "warning", recording.source.file
        findings.append(Finding(severity, "gap", file, what=what, spoils=spoils, channel=name, spans=spans))
    return findings


def _spline(x: Values, start: int, end: int, support: int) -> Values | None:
    around = np.r_[max(0, start - support) : start, end : min(len(x), end + support)]
    around = around[np.isfinite(x[around])]
    if np.sum(around < start) < 2 or np.sum(around >= end) < 2:
        return None
    return CubicSpline(around, x[around])(np.arange(start, end))


def _on_template(x: Values, start: int, end: int, phi: Values, template: Values) -> Values | None:
    """Template plus the line through the residuals of three samples at either end."""
    before, after = np.arange(max(0, start - 3), start), np.arange(end, min(len(x), end + 3))
    rows = np.r_[before, start:end, after]
    if np.isnan(phi[rows]).any() or np.isnan(x[before]).any() or np.isnan(x[after]).any() or not len(after):
        return None
    curve = np.interp(phi[rows], PERCENT, template)
    known = np.r_[0 : len(before), len(rows) - len(after) : len(rows)]
    residual = x[rows[known]] - curve[known]
    inside = slice(len(before), len(rows) - len(after))
    near, far = residual[: len(before)].mean(), residual[len(before) :].mean()
    return curve[inside] + np.interp(rows[inside], [before.mean(), after.mean()], [near, far])


HALF_S = 0.03  # of the window of the running median: spikes of up to three samples at 100 Hz
MAD_TIMES = 8.0  # of the robust standard deviation of the differences from sample to sample
LEAP_TIMES = 4.0  # of the step that one sample in a hundred exceeds: on the way in and on the way out
LEAST = {"deg": 1.0, "rad": 0.02, "m": 0.01}
LEAST_SHARE = 0.05  # of the channel's range, 1st to 99th percentile
QUANTITIES = ("angle", "translation", "marker")  # forces, moments and EMG do rise from one sample to the next
FEWEST_SAMPLES = 20


def spikes(recording: Recording) -> NDArray[np.bool_]:
    """Mark samples far from the running median of their channel, (time, channel).

    Far means eight robust standard deviations of the differences between neighbours, and 5 % of the channel's range (1
    deg or 1 cm at least); and the channel leaps there and back, each by four times the step that one sample in a
    hundred exceeds: a stumble is fast too, but has samples on its way. Within 0.03 s of an end or of a gap nothing is
    tested. A heading is looked at as it goes on.

    Source: Hampel 1974, J. Am. Stat. Assoc. 69, 383; Pearson 2002, IEEE Trans. Control Syst. Technol. 10, 55. Differs:
        the scale is that of the whole channel, not of the window, for a smooth channel has none in a window.

    >>> from gaitdisc.channel import Channel
    >>> x = 30 * np.sin(np.arange(500) / 15)
    >>> x[200] += 15
    >>> knee = Channel("knee_angle_r", "angle", "deg", "r")
    >>> np.flatnonzero(spikes(Recording(np.arange(500) / 100, x[:, None], (knee,)))).tolist()
    [200]
    """
    marks = np.zeros(recording.values.shape, bool)
    plain = unwrap(recording)
    for column, channel in enumerate(recording.channels):
        x = np.where(np.isfinite(plain.values[:, column]), plain.values[:, column], np.nan)
        known = np.isfinite(x)
        if channel.quantity in QUANTITIES and known.sum() >= FEWEST_SAMPLES:
            half = max(2, round(HALF_S * recording.rate_hz))
            steps = np.diff(x)
            size = np.abs(finite_values(steps))
            reach = float(np.subtract(*np.percentile(x[known], [99, 1])))
            least = max(LEAST_SHARE * reach, LEAST.get(channel.unit, 0.0))
            spread = robust_sd(size) if len(size) else 0.0
            middle = np.full(len(x), np.nan)  # the running median, where its window is whole
            if len(x) > 2 * half:
                middle[half : len(x) - half] = np.median(sliding_window_view(x, 2 * half + 1), axis=1)
            far = np.abs(x - middle) > max(MAD_TIMES * spread, least)
            leap = max(LEAP_TIMES * float(np.percentile(size, 99)), least) if len(size) else np.inf
            for start, end in runs(far):
                there, back = steps[start - 1], steps[end - 1]
                if end - start <= half and there * back < 0 and min(abs(there), abs(back)) > leap:
                    marks[start:end, column] = True
    return marks


def without_spikes(recording: Recording) -> Recording:
    """Recording in which spikes are gaps: bridged and marked suspect where short (`fill_gaps`), else left out."""
    marks = spikes(recording)
    return recording.with_values(np.where(marks, np.nan, recording.values)) if marks.any() else recording


def spike_findings(recording: Recording) -> list[Finding]:
    """Say which channels have spikes, how large and where."""
    marks = spikes(recording)
    findings = []
    for column in np.flatnonzero(marks.any(axis=0)):
        channel, here = recording.channels[column], marks[:, column]
        x = recording.values[:, column]
        rest = np.where(here | ~np.isfinite(x), np.nan, x)
        low, high = np.nanpercentile(rest, [1, 99])
        outside = np.where(here, np.abs(x - (low + high) / 2), 0.0)
        at = int(np.argmax(outside))
        known, places = np.flatnonzero(np.isfinite(rest)), counted(len(runs(here)), "place")
        beside = rest[known[np.abs(known - at).argmin()]]
        what = (
            f"{x[at]:.4g} {channel.unit} at {recording.time[at]:.2f} s (frame {at + 1}) is next to {beside:.4g} "
            f"{channel.unit}; spikes in {places}"
        )
        spoils = "nothing: spikes are removed before the filter, interpolated if short, and marked"
        file, spans = recording.source.file, spans_s(recording.time, here)
        findings.append(Finding("warning", "spike", file, what=what, spoils=spoils, channel=channel.name, spans=spans))
    return findings
