"""Strides unlike the person's other strides, and a change of gait late in a trial.

The dissertation left one of twelve people out "due to changes in gait [...] late in the Exo condition walking trial"
(section 4.2.4) without a rule. This is one: a change point in the last half of the trial, tested against stride series
that are as dependent as this person's own, but stationary.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.signal import lfilter

from gaitdisc.errors import StrideError
from gaitdisc.recording import DroppedStride, Finding, Recording, Strides
from gaitdisc.recording.arrays import Span, Values, robust_sd, runs

OUTLYING = 3.5  # robust standard deviations of the logarithm of a stride's distance
FEWEST_STRIDES = 8
LONGEST_ACCIDENT = 3  # strides in a row
FEWEST_TIMES = 2.0  # times the usual distance: steady walkers' strides are all alike
EARLIEST = 0.5  # of the strides
FEWEST_AFTER = 6
FEWEST_TO_CHANGE = 24
COMPONENTS = 6
EXPLAINED = 0.9
REPETITIONS = 299
ALPHA = 0.01
LEAST_SD = 1.0
CHANGE_SD = 2.5  # what slow drift alone does not reach: 2.0 in 34 walks of the cohort's calibration people


def stride_distances(recording: Recording, strides: Strides) -> Values:
    """Distance of every stride from the person's median curve, (stride, channel) [channel's unit].

    The root mean square over the stride; the median curve is not moved by the strides that are looked for.

    >>> from gaitdisc.channel import Channel
    >>> t = np.arange(500) / 100
    >>> x = np.sin(2 * np.pi * t) + 3 * ((t > 2) & (t < 3))
    >>> walk = Recording(t, x[:, None], (Channel("knee_angle_r", "angle", "deg", "r"),))
    >>> stride_distances(walk, Strides(np.arange(4.0), np.arange(1.0, 5.0), "r", "force")).ravel().round(1)
    array([0., 0., 3., 0.])
    """
    curves = strides.normalised(recording)
    known: NDArray[np.bool_] = np.asarray(np.isfinite(curves).all(axis=1, keepdims=True))
    complete = np.where(known, curves, np.nan)
    middle = np.zeros((1, *curves.shape[1:]))
    for column in range(curves.shape[2]):
        rows = known[:, 0, column]
        if rows.any():
            middle[0, :, column] = np.median(complete[rows, :, column], axis=0)
    return np.sqrt(np.mean((complete - middle) ** 2, axis=1))


def outlying(recording: Recording, strides: Strides) -> NDArray[np.bool_]:
    """Which strides lie far from the person's median curve, (stride, channel).

    Far means: the logarithm of the distance is 3.5 robust standard deviations above its median, and the distance twice
    the usual one. Steady changes do not count; `late_change` looks for these.
    """
    distance = stride_distances(recording, strides)
    far = np.zeros(distance.shape, bool)
    for column in range(distance.shape[1]):
        d = distance[:, column]
        known = np.isfinite(d) & (d > 0)
        if known.sum() < FEWEST_STRIDES:
            continue
        logs = np.log(d[known])
        middle = float(np.median(logs))
        far[known, column] = (logs > middle + OUTLYING * robust_sd(logs)) & (logs > middle + np.log(FEWEST_TIMES))
    return far


def stride_findings(recording: Recording, strides: Strides) -> list[Finding]:
    """Say which strides are unlike the others, channel by channel."""
    far, distance = outlying(recording, strides), stride_distances(recording, strides)
    findings = []
    for column, channel in enumerate(recording.channels):
        rows = np.flatnonzero(far[:, column])
        if not len(rows):
            continue
        worst = rows[np.argmax(distance[rows, column])]
        times = distance[worst, column] / np.nanmedian(distance[:, column])
        what = (
            f"{len(rows)} of {len(strides)} strides of side {strides.side}; the worst, at {strides.start[worst]:.2f} "
            f"s, is {distance[worst, column]:.3g} {channel.unit} from the median, {times:.1f} times the usual distance"
        )
        spoils = "means and models that include these strides"
        spans = tuple(Span(float(strides.start[k]), float(strides.end[k])) for k in rows)
        file = recording.source.file
        findings.append(Finding("warning", "outlying stride", file, what, spoils, channel=channel.name, spans=spans))
    return findings


def without_outlying(recording: Recording, strides: Strides, fewest_channels: int = 1) -> Strides:
    """Strides without those that are unlike the others; each goes to `dropped` with its reason.

    An accident, a stumble say, spoils one to three strides. Four or more in a row are another way of walking: they
    stay, and `late_change` tests them.

    fewest_channels: in how many channels a stride must be outlying to be dropped
    """
    far, distance = outlying(recording, strides), stride_distances(recording, strides)
    out = far.sum(axis=1) >= fewest_channels
    for start, end in runs(out):
        out[start:end] = end - start <= LONGEST_ACCIDENT
    if not out.any():
        return strides
    usual = np.full(distance.shape[1], np.nan)  # also of a channel without one whole stride
    known = np.isfinite(distance).any(axis=0)
    usual[known] = np.nanmedian(distance[:, known], axis=0)
    usual[usual == 0] = np.nan  # a locked coordinate has no usual distance
    dropped = []
    for k in np.flatnonzero(out):
        times = distance[k] / usual
        column = int(np.argmax(np.where(far[k], times, 0.0)))
        more = f" (and {far[k].sum() - 1} more)" if far[k].sum() > 1 else ""
        name = recording.names[column]
        reason = f"outlying: {name}{more} at {times[column]:.1f} times the usual distance from the median"
        dropped.append(DroppedStride(float(strides.start[k]), float(strides.end[k]), reason))
    return replace(strides, start=strides.start[~out], end=strides.end[~out], dropped=(*strides.dropped, *dropped))


@dataclass(frozen=True)
class LateChange:
    """Most likely change point of a trial."""

    time: float  # start of the first stride after it [s]
    p: float  # how often a stationary series of the same dependence gives as large a statistic
    # shift between the parts in stride-to-stride standard deviations: the root of the sum over principal components,
    # each shift over its standard deviation within the parts
    size_sd: float
    shifts: dict[str, float]  # root mean square shift of the mean curve of each channel [channel's unit]


def late_change(recording: Recording, strides: Strides, seed: int = 0) -> LateChange:
    """Most likely change point in the last half of a trial, with its size and a p value.

    The strides' curves, each channel over its own stride-to-stride standard deviation, are reduced to the principal
    components that hold 90 % of the variance, six at most. For each split after the first half the statistic is the
    sum over components of the squared shift over its variance, where the variance of a mean allows for a first-order
    autoregression from stride to stride, estimated within the parts. The p value compares the largest with 299
    stationary autoregressive series of the same length and dependence, treated alike. Outlying strides are left out
    first.

    Measured on 300 made-up stationary trials each of 40, 100 and 224 strides, dependence 0 to 0.8: p is 0.05 or less in
    1 to 5 % of them, 0.01 or less in at most 1.3 %. A shift of 1.5 to 2 standard deviations in three of six angles over
    the last fifth has p of 0.01 or less in every trial of 224 strides (four minutes); of 100 strides in all where
    strides depend little on each other (0.3 or less: 93 to 100 %) and in 15 to 48 % at 0.6; of 40 strides only where
    they do not depend on each other at all (75 to 97 %).

    Source: Ebers (2023), section 4.2.4, excludes by judgement. The statistic is Hotelling's with a long-run variance;
        the simulated null replaces asymptotics that fail for 50 to 250 dependent strides.
    """
    regular = without_outlying(recording, strides)
    curves = regular.normalised(recording)
    moving = np.array([c.quantity in {"angle", "emg"} for c in recording.channels])
    moving &= np.isfinite(curves).any(axis=0).all(axis=0)  # no stride may lack the same phase
    moving[moving] &= np.nanstd(curves[:, :, moving], axis=0).max(axis=0) > 1e-9
    curves = curves[:, :, moving]
    complete = np.isfinite(curves).all(axis=(1, 2))
    curves, start = curves[complete], regular.start[complete]
    if len(curves) < FEWEST_TO_CHANGE or not curves.shape[2]:
        raise StrideError(
            f"for the test for a late change, there must be at least {FEWEST_TO_CHANGE} complete strides",
            f"{recording.source.file or 'the recording'} has {len(curves)} of side {strides.side!r}",
            "Record longer, or inspect the trial by eye.",
        )
    scores = _components(curves)
    statistic, split, dependence = _largest(scores[None])
    null = _simulate(scores.shape, dependence[0], seed)
    p = (1 + int(np.sum(null >= statistic[0]))) / (1 + len(null))
    after = np.arange(len(scores)) >= split[0]
    moved = scores[after].mean(axis=0) - scores[~after].mean(axis=0)
    residual = np.where(after[:, None], scores - scores[after].mean(axis=0), scores - scores[~after].mean(axis=0))
    names = [name for name, moves in zip(recording.names, moving, strict=True) if moves]
    shift = curves[after].mean(axis=0) - curves[~after].mean(axis=0)
    return LateChange(
        float(start[split[0]]),
        float(p),
        float(np.sqrt(np.sum((moved / residual.std(axis=0)) ** 2))),
        dict(zip(names, np.sqrt(np.mean(shift**2, axis=0)).tolist(), strict=True)),
    )


def late_change_findings(recording: Recording, strides: Strides) -> list[Finding]:
    """Say whether gait changes late in a trial.

    returns: a warning where p is 0.01 or less and the shift is one stride-to-stride standard deviation or more, a
        note where the trial has too few strides to say. Its kind is `late change` from 2.5 standard deviations on,
        `drift` below: people drift slowly, by more than series that forget from stride to stride would, and p says
        that they do (studies/results/chapter4.md), but it is the same gait
    """
    file = recording.source.file
    try:
        change = late_change(recording, strides)
    except StrideError as error:
        return [Finding("note", "late change", file, f"not tested: {error.found}", "")]
    if change.p > ALPHA or change.size_sd < LEAST_SD:
        return []
    largest = sorted(change.shifts, key=lambda name: -change.shifts[name])[:3]
    units = {channel.name: channel.unit for channel in recording.channels}
    moved = ", ".join(f"{name} by {change.shifts[name]:.2g} {units[name]}" for name in largest)
    kind = "late change" if change.size_sd >= CHANGE_SD else "drift"
    spans = (Span(change.time, float(strides.end[-1])),)
    what = (
        f"gait changes at {change.time:.0f} s of {recording.time[-1]:.0f} s by {change.size_sd:.1f} stride-to-stride "
        f"SD (p = {change.p:.3f}): {moved} (root mean square over the stride)"
    )
    spoils = "models trained before the change and tested after it; exclude the trial, or crop it at the change"
    return [Finding("warning", kind, file, what, spoils, spans=spans)]


def _components(curves: Values) -> Values:
    """Scores (stride, component) of the residual curves, each channel scaled by its stride-to-stride sd."""
    residual = curves - curves.mean(axis=0)
    residual /= np.sqrt(np.mean(residual**2, axis=(0, 1)))
    flat = residual.reshape(len(residual), -1)
    u, s, _ = np.linalg.svd(flat, full_matrices=False)
    held = np.cumsum(s**2) / np.sum(s**2)
    count = min(COMPONENTS, int(np.searchsorted(held, EXPLAINED)) + 1)
    return u[:, :count] * s[:count]


def _largest(scores: Values) -> tuple[Values, NDArray[np.intp], Values]:
    """Largest statistic, its split, and the lag-one correlations, of series (series, stride, component)."""
    count, n, _ = scores.shape
    centred = scores - scores.mean(axis=1, keepdims=True)
    total = np.cumsum(centred, axis=1)
    first = max(round(EARLIEST * n), FEWEST_AFTER)
    splits = np.arange(first, n - FEWEST_AFTER + 1)
    before = splits[None, :, None]
    partial = total[:, splits - 1, :]
    shift = -partial / (n - before) - partial / before  # mean after minus mean before
    weight = before * (n - before) / n
    gain = weight * shift**2  # what the split explains of the sum of squares
    best = gain.argmax(axis=1)  # (series, component): residuals are taken at each component's own best split
    at = splits[best]
    moved = np.take_along_axis(shift, best[:, None, :], axis=1)
    after = np.arange(n)[None, :, None] >= at[:, None, :]
    level = np.where(after, moved * (at / n)[:, None, :], -moved * (1 - at / n)[:, None, :])
    residual = centred - level
    variance = np.mean(residual**2, axis=1)
    lagged = np.sum(residual[:, 1:] * residual[:, :-1], axis=1) / np.sum(residual**2, axis=1)
    dependence = np.clip(lagged + (1 + 3 * lagged) / n + 1.0 / n, 0.0, 0.9)  # Kendall's bias, and that of a second mean
    long_run = variance * (1 + dependence) / (1 - dependence)
    statistic = np.sum(gain / long_run[:, None, :], axis=2)
    top = statistic.argmax(axis=1)
    return statistic[np.arange(count), top], splits[top], dependence


def _simulate(shape: tuple[int, ...], dependence: Values, seed: int) -> Values:
    """Largest statistics of stationary autoregressive series of the same length and dependence."""
    rng = np.random.default_rng(seed)
    n, k = shape
    lead = 30
    noise = rng.normal(size=(REPETITIONS, n + lead, k))
    series = np.stack(
        [
            np.asarray(lfilter([1.0], [1.0, -rho], noise[:, :, column], axis=1))[:, lead:]
            for column, rho in enumerate(dependence)
        ],
        axis=2,
    )
    return _largest(series)[0]
