"""Read-only arrays and mappings, means of those with gaps, spread and memory of a series, runs and spans of samples."""

from __future__ import annotations

import copyreg
from collections.abc import Mapping
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gaitdisc.errors import ShapeError

Values = NDArray[np.float64]


def read_only(values: ArrayLike, dtype: Any = float) -> NDArray[Any]:
    """View of an array that cannot be written through; numbers that already have the type are not copied.

    >>> read_only([1, 2]).flags.writeable
    False
    """
    view = (real_array(values) if dtype is float else np.asarray(values, dtype)).view()
    view.flags.writeable = False
    return view


def freeze(noun: object, *names: str) -> None:
    """Make fields of a frozen dataclass read-only arrays of floats."""
    for name in names:
        object.__setattr__(noun, name, read_only(getattr(noun, name)))


def real_array(values: Any) -> Values:
    """Array of floats; complex numbers are refused, of which numpy would keep the real part."""
    array = np.asarray(values)
    if array.dtype.kind == "c":
        raise ShapeError(
            "a recording must contain real numbers",
            f"the array of shape {array.shape} is complex",
            "Use the magnitude, abs(x), or the real part, x.real.",
        )
    return np.asarray(array, float)


def frozen(mapping: Mapping[str, Any]) -> MappingProxyType[str, Any]:
    """View of a mapping that cannot be written through; it can be copied and sent to another process."""
    return MappingProxyType(dict(mapping))


# Python itself pickles no read-only view; with this line a Trial goes through `pickle`, `copy.deepcopy` and a pool
copyreg.pickle(MappingProxyType, lambda view: (frozen, (dict(view),)))


def mean_where_known(values: Values) -> Values:
    """Mean over the first axis of the values that are there; NaN where none is.

    >>> mean_where_known(np.array([[1.0, np.nan, np.nan], [3.0, 5.0, np.nan]])).tolist()
    [2.0, 5.0, nan]
    """
    known = np.isfinite(values)
    count = known.sum(axis=0)
    return np.where(count > 0, np.where(known, values, 0.0).sum(axis=0) / np.maximum(count, 1), np.nan)


def root_mean_square(residual: Values) -> Values:
    """Size (channel,) of residuals (run, sample, channel), those that are known."""
    return np.sqrt(np.nanmean(residual**2, axis=(0, 1)))


def robust_sd(values: Values) -> float:
    """Standard deviation by the median absolute deviation: that of normal numbers, whatever a few others are."""
    return 1.4826 * float(np.median(np.abs(values - np.median(values))))


def autocorrelation_time(values: Values, forgotten: float = 0.0) -> Values:
    """Integrated autocorrelation time of each column [samples], (column,): 1 of white noise.

    So many numbers in a row say no more together than one that stands alone. Correlations are summed up to the first
    that is no larger than `forgotten`.

    values (time, column): in order of time
    Source: Sokal 1997, Monte Carlo methods in statistical mechanics.

    >>> noise = np.random.default_rng(0).standard_normal(100_000)
    >>> slow = np.convolve(noise, np.ones(5), "same")
    >>> autocorrelation_time(np.column_stack([noise, slow]), 0.05).round(1).tolist()
    [1.0, 5.0]
    """
    n = len(values)
    spectrum = np.abs(np.fft.rfft(values - values.mean(axis=0), 2 * n, axis=0)) ** 2
    products = np.fft.irfft(spectrum, axis=0)[:n]
    rho = products / np.where(products[0] > 0, products[0], 1.0)
    remembered = np.logical_and.accumulate(rho[1:] > forgotten, axis=0)
    return 1 + 2 * (rho[1:] * remembered).sum(axis=0)


def finite_values(values: Values) -> Values:
    """Values that are neither missing nor infinite, in one row."""
    return values[np.isfinite(values)]


def finite_rows(values: Values) -> Values:
    """Rows without a missing or infinite value."""
    return values[np.isfinite(values).all(axis=1)]


def mean_step(time: Values) -> float:
    """Mean step of two times or more [s]."""
    return float((time[-1] - time[0]) / (len(time) - 1))


def mean_rate(time: Values) -> float:
    """Mean number of samples a second of two times or more."""
    return float((len(time) - 1) / (time[-1] - time[0]))


def runs(mask: NDArray[np.bool_]) -> NDArray[np.intp]:
    """First sample of each run of True in a mask (time,), and the one after its last, (run, 2).

    >>> runs(np.array([False, True, True, False, True])).tolist()
    [[1, 3], [4, 5]]
    """
    steps = np.flatnonzero(np.diff(np.concatenate(([False], mask, [False])).astype(np.int8)))
    return steps.reshape(-1, 2)


class Span(NamedTuple):
    """A part of a recording, from its first to its last instant [s]."""

    start: float
    end: float

    @property
    def seconds(self) -> float:
        """How long it lasts; negative where nothing is shared."""
        return self.end - self.start

    def holds(self, time: Values) -> NDArray[np.bool_]:
        """Which instants (time,) [s] lie in it, its ends included."""
        return (time >= self.start) & (time <= self.end)

    def shared(self, other: Span) -> Span:
        """Return what two spans have in common."""
        return Span(max(self.start, other.start), min(self.end, other.end))


def spans_s(time: Values, mask: NDArray[np.bool_]) -> tuple[Span, ...]:
    """Spans of the runs of True in a mask (time,), from the first sample of each to one even step after its last.

    >>> spans_s(np.arange(4.0), np.array([False, True, True, False]))
    (Span(start=1.0, end=3.0),)
    """
    step = mean_step(time) if len(time) > 1 else 0.0
    return tuple(Span(round(float(time[a]), 6), round(float(time[b - 1] + step), 6)) for a, b in runs(mask))
