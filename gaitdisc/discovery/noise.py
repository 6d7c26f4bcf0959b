"""The noise of a measurement, estimated from residuals: its size and its autocorrelation.

Source: Cochrane and Orcutt 1949, J. Am. Stat. Assoc. 44, 32 (residuals whitened by their autoregression; here of any
order, Yule-Walker); Schwarz 1978, Ann. Stat. 6, 461 (the order).
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.linalg import solve_toeplitz

from gaitdisc.compiled import compiled
from gaitdisc.discovery.criteria import CRITERIA
from gaitdisc.recording.arrays import Values

MOST_LAGS = 16
WHITE_SHARE = 0.05  # of the variance is taken as white: no simulation is right to the last decimal at high frequency
WINDOW, ORDER = 7, 3  # samples, and the order of the polynomial through them
FEWEST = 12  # samples of a trial
MAD_OF_NORMAL = 1.4826  # standard deviation over the median absolute deviation
LEAST = 1e-6  # of a channel's spread: what rounding leaves


@dataclass(frozen=True)
class Noise:
    """Stationary noise of each channel as an autoregression of its own past.

    >>> white = Noise(((np.zeros(0),),), (np.array([2.0]),))
    >>> white.whiten(np.full((1, 3, 1), 4.0))[0, :, 0]
    array([2., 2., 2.])
    """

    # for each channel, the predictor of each order 0, 1, ..., p (p,): what the samples before say of the next
    predictors: tuple[tuple[Values, ...], ...]
    # for each channel, the standard deviation of what each of these predictors leaves [the channel's unit]
    spread: tuple[Values, ...]
    # for each channel, how much less than all the past leaves where white noise went through the record's filter; 1
    # where there is none
    filtered: tuple[float, ...] = ()

    @property
    def size(self) -> Values:
        """Standard deviation of the noise of each channel (channel,)."""
        return np.array([spread[0] for spread in self.spread])

    @property
    def lags(self) -> tuple[int, ...]:
        """Order of each channel's autoregression; 0 is white."""
        return tuple(len(spread) - 1 for spread in self.spread)

    @property
    def is_autocorrelated(self) -> bool:
        """Whether what went before says more than next to nothing of what comes, the record's filter apart."""
        filtered = self.filtered or (1.0,) * len(self.spread)
        return any(
            all_of[0] > CRITERIA.autocorrelated * by * all_of[-1]
            for all_of, by in zip(self.spread, filtered, strict=True)
        )

    def whiten(self, residual: Values, known: NDArray[np.bool_] | None = None) -> Values:
        """Return residuals as independent numbers of unit variance, if the noise is what it is taken for.

        residual (segment, sample, channel, ...): each segment begins afresh: its first samples are predicted from the
            few before them. So it does after samples that are not known
        known (segment, sample, channel): where there is a residual; nothing is left elsewhere
        """
        wide = np.ascontiguousarray(residual, float).reshape(*residual.shape[:3], -1)
        if not any(self.lags):
            white = wide / self.size[:, None]
            return (white if known is None else white * known[..., None]).reshape(residual.shape)
        out = np.empty_like(wide)
        there = np.ones(wide.shape[:3], bool) if known is None else known
        for channel, (predictors, spread) in enumerate(zip(self.predictors, self.spread, strict=True)):
            table = np.zeros((len(spread), max(len(spread) - 1, 1)))
            for order, predictor in enumerate(predictors):
                table[order, :order] = predictor
            whiten(wide, channel, there, table, spread, out)
        return out.reshape(residual.shape)


def white_noise(size: Values) -> Noise:
    """Return white noise, by the standard deviation of each channel (channel,)."""
    return Noise(tuple((np.zeros(0),) for _ in size), tuple(np.array([size]) for size in size))


def find_noise(
    residual: Values,
    used: float = 0.0,
    white_share: float = WHITE_SHARE,
    least: ArrayLike = 0.0,
    autocorrelation: Values | None = None,
) -> Noise:
    """Estimate the noise from residuals (Yule-Walker; the order by BIC).

    residual (segment, sample, channel): measured minus fitted; NaN where nothing was measured. Segments are not joined
    used: numbers that the fit took from each segment and channel; the variance is enlarged accordingly
    white_share: of the variance, taken as white whatever the residuals say
    least float or (channel,): standard deviation of white noise that is there in any case: what integration and
        rounding leave
    autocorrelation (lag, channel): of what the record's filter leaves of white noise

    >>> e = np.random.default_rng(0).normal(0, 3, (20, 200, 1))
    >>> noise = find_noise(e)
    >>> noise.lags, bool(abs(noise.size[0] - 3) < 0.1)
    ((0,), True)
    """
    predictors, spread, filtered = [], [], []
    segments, samples, channels = residual.shape
    always = np.broadcast_to(np.square(least), channels)
    for channel in range(channels):
        known = np.isfinite(residual[:, :, channel])
        e = np.where(known, residual[:, :, channel], 0.0)
        count = max(int(known.sum()), 1)
        each = count / segments
        most = min(MOST_LAGS, int(each) // 4)
        enlarge = each / max(each - used, 1.0)
        covariance = np.array([(e[:, : samples - lag] * e[:, lag:]).sum() / count for lag in range(most + 1)]) * enlarge
        covariance[0] = max(covariance[0] + always[channel], np.finfo(float).tiny)
        covariance[1:] /= 1 + white_share
        orders, left = _predict(covariance)
        best = int(np.argmin(count * np.log(left) + np.arange(most + 1) * np.log(count)))
        predictors.append(tuple(orders[: best + 1]))
        spread.append(np.sqrt(left[: best + 1]))
        if autocorrelation is not None:
            lags = autocorrelation[: best + 1, channel] * (1 - np.arange(best + 1) / each)
            lags[1:] /= 1 + white_share
            filtered.append(float(1 / np.sqrt(_predict(lags)[1][-1])))
    return Noise(tuple(predictors), tuple(spread), tuple(filtered))


def _predict(covariance: Values) -> tuple[list[Values], Values]:
    """Predictors of each order from a covariance (lag,), and what each leaves (order,)."""
    orders = [np.zeros(0)]
    for order in range(1, len(covariance)):
        orders.append(np.asarray(solve_toeplitz(covariance[:order], covariance[1 : order + 1]), np.float64))
    left = np.array([float(covariance[0] - order @ covariance[1 : len(order) + 1]) for order in orders])
    return orders, np.maximum(left, 1e-12 * covariance[0])


@compiled(nogil=True)
def whiten(
    residual: Values, channel: int, known: NDArray[np.bool_], predictors: Values, spread: Values, out: Values
) -> None:
    """Write one channel's innovations, in units of their spread, into `out`, as `Noise.whiten` has them.

    predictors (order + 1, order): row p predicts from the p samples before
    """
    segments, samples, _, columns = residual.shape
    last = len(spread) - 1
    for segment in range(segments):
        run = 0
        for sample in range(samples):
            if not known[segment, sample, channel]:
                run = 0
                out[segment, sample, channel, :] = 0.0
                continue
            order = min(run, last)
            run += 1
            for column in range(columns):
                out[segment, sample, channel, column] = residual[segment, sample, channel, column]
            for lag in range(order):
                weight = predictors[order, lag]
                before = residual[segment, sample - 1 - lag, channel]
                for column in range(columns):
                    out[segment, sample, channel, column] -= weight * before[column]
            for column in range(columns):
                out[segment, sample, channel, column] /= spread[order]


def sensor_noise(observed: Values) -> Values:
    """Estimate the standard deviation of each channel's white noise: what a local cubic over 7 samples leaves.

    Noise that a filter has made smooth is not seen: of such a record the estimate is too small.

    returns (channel,): [the channel's unit]; the median over the trials

    >>> t = np.arange(2000) / 100
    >>> noise = np.random.default_rng(0).normal(0, 0.02, t.size)
    >>> bool(abs(sensor_noise((np.sin(6 * t) + noise)[None, :, None])[0] - 0.02) < 0.002)
    True
    """
    powers = np.vander(np.arange(WINDOW) - WINDOW // 2, ORDER + 1).astype(float)
    kept = 1 - (powers @ np.linalg.pinv(powers))[WINDOW // 2, WINDOW // 2]
    spread = np.nanstd(observed, axis=(0, 1))
    sizes = LEAST * spread
    middle = slice(WINDOW // 2, -(WINDOW // 2))
    for channel, trials in enumerate(np.moveaxis(observed, 2, 0)):
        known = [trial[np.isfinite(trial)] for trial in trials]
        rough = [(trial - savgol_filter(trial, WINDOW, ORDER))[middle] for trial in known if len(trial) >= FEWEST]
        if rough:
            size = MAD_OF_NORMAL * float(np.median([np.median(np.abs(each)) for each in rough])) / np.sqrt(kept)
            sizes[channel] = max(size, sizes[channel])
    return sizes


def savgol_filter(values: Values, width: int, degree: int, derivative: int = 0, step: float = 1.0) -> Values:
    """Smoothed signal or a derivative of it, from a polynomial fitted around each sample.

    values (sample,): evenly sampled, finite, `width` samples or more
    step: between two samples [s]
    returns (sample,): within half a width of an end, the polynomial of the first or last `width` samples
    Source: Savitzky, Golay 1964, Analytical Chemistry 36, 1627; the same numbers as `scipy.signal.savgol_filter` to
        rounding.

    >>> time = np.arange(6) * 0.1
    >>> savgol_filter(time**3, 5, 3, 1, 0.1)[1:].round(3)
    array([0.03, 0.12, 0.27, 0.48, 0.75])
    """
    half = width // 2
    offsets = np.arange(-half, half + 1.0)
    fit = np.linalg.pinv(offsets[:, None] ** np.arange(degree + 1))
    slopes = np.array([math.perm(power, derivative) for power in range(degree + 1)]) / step**derivative
    at_offsets = slopes * offsets[:, None] ** np.maximum(np.arange(degree + 1) - derivative, 0)
    weights = at_offsets @ fit  # (where in the window, sample of the window)
    inside = np.lib.stride_tricks.sliding_window_view(values, width) @ weights[half]
    return np.concatenate([weights[:half] @ values[:width], inside, weights[half + 1 :] @ values[-width:]])
