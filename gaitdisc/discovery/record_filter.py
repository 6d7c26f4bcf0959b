"""The zero-lag low-pass that a record went through: what is simulated goes through the same before it is compared.

A laboratory's record is y = F (h(x, u) + noise), F a Butterworth filter of order 2 run forwards and backwards. F is
linear, so that what a start state, a constant or an effect changes in the record is what it changes in h, filtered.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from gaitdisc.compiled import compiled
from gaitdisc.recording.arrays import Values

SETTLING_PERIODS = 1.0  # of the cut-off, after which the filter has forgotten all but 1 % (exp(-2 pi / sqrt 2))
DENSE = 4.0  # samples a period of the cut-off hold all that passes: at half that rate 0.4 % of the power is left
ROOT_TWO = math.sqrt(2.0)
SURELY_MORE = 2.0  # times the noise that a spectrum shows: 0.69 to 1.98 of the true one (99 channels of engines)
CUTOFF_ERRORS = (0.95, 1.05, 0.9, 1.1, 0.86, 1.16)  # within two of its standard deviations, 3 to 7 % (41 records)


@dataclass(frozen=True)
class RecordFilter:
    """Filters of the observed channels.

    >>> RecordFilter((6.0, None), 100.0).margin, RecordFilter((None,), 100.0).margin
    (17, 0)
    """

    # -3 dB frequency of one pass, channel by channel; None where a channel was not filtered
    cutoffs_hz: tuple[float | None, ...]
    rate_hz: float
    # standard deviation of each channel's noise behind the filter, where the spectrum shows it [the channel's unit]
    noise: Mapping[int, float] = field(default_factory=dict, compare=False)

    @property
    def margin(self) -> int:
        """Samples at either end of a run in which its filtered channels cannot be trusted."""
        return max([math.ceil(SETTLING_PERIODS * self.rate_hz / hz) for hz in self.cutoffs_hz if hz], default=0)

    @property
    def every(self) -> int:
        """Which samples hold all that the filter passes: 1 where they are all needed, 2 where every other is enough."""
        highest = max([hz or math.inf for hz in self.cutoffs_hz], default=math.inf)
        return max(int(self.rate_hz / (DENSE * highest)), 1)

    def within_error(self, stated: Sequence[float | None]) -> list[RecordFilter]:
        """Filters with cut-offs lower and higher by the error of an estimate, the nearest first; stated ones stand."""
        both = [*zip(self.cutoffs_hz, stated, strict=True)]
        scaled = [tuple(hz and (hz if hz == cutoff else hz * by) for hz, cutoff in both) for by in CUTOFF_ERRORS]
        return [replace(self, cutoffs_hz=cutoffs) for cutoffs in scaled if cutoffs != self.cutoffs_hz]

    def at_most_noise(self, size: Values) -> Values:
        """Return the size of what is left (channel,), or of the noise where that is surely smaller, by the spectrum."""
        shown = np.array([self.noise.get(channel, np.inf) for channel in range(len(size))])
        return np.where(size > SURELY_MORE * shown, shown, size)

    @property
    def gains(self) -> Values:
        """What the filter leaves of white noise (channel,): the standard deviation after over that before."""
        return np.sqrt((self._response**2).sum(axis=0))

    def autocorrelation(self, lags: int) -> Values:
        """Autocorrelation of what the filter leaves of white noise (lag, channel), between the samples compared."""
        response = self._response
        late = [np.roll(response, lag * self.every, axis=0) for lag in range(lags + 1)]
        for lag, delayed in enumerate(late):
            delayed[: lag * self.every] = 0.0
        return np.array([(response * delayed).sum(axis=0) for delayed in late]) / (response**2).sum(axis=0)

    @property
    def _response(self) -> Values:
        """To an impulse (sample, channel)."""
        impulse = np.zeros((1, 8 * max(self.margin, 1) + 1, len(self.cutoffs_hz)))
        impulse[:, impulse.shape[1] // 2] = 1.0
        return self.filtered(impulse, 1)[0]

    def filtered(self, observed: Values, axis: int) -> Values:
        """Simulated channels (..., sample, channel, ...), samples along an axis, as the record would have them."""
        if not self.margin:
            return observed
        samples = observed.shape[axis]
        out = np.ascontiguousarray(observed, float).reshape(
            math.prod(observed.shape[:axis]), samples, observed.shape[axis + 1], -1
        )
        out = out.copy() if np.shares_memory(out, observed) else out
        for channel, cutoff in enumerate(self.cutoffs_hz):
            if cutoff:  # b0, a1, a2 of a Butterworth low-pass of order 2 (b1 = 2 b0, b2 = b0)
                k = math.tan(math.pi * (cutoff / self.rate_hz))
                whole = 1 + ROOT_TWO * k + k * k
                form = np.array([k * k / whole, 2 * (k * k - 1) / whole, (1 - ROOT_TWO * k + k * k) / whole])
                run_both_ways(out, channel, form, min(2 * self.margin, samples - 1))
        return out.reshape(observed.shape)


@compiled(nogil=True)
def run_both_ways(values: Values, channel: int, coefficients: Values, padding: int) -> None:
    """Filter one channel forwards and backwards, in place; beyond its ends a run goes on turned over."""
    b, a1, a2 = coefficients[0], coefficients[1], coefficients[2]
    runs, samples, _, columns = values.shape
    long = np.empty(samples + 2 * padding)
    for run in range(runs):
        for column in range(columns):
            for sample in range(samples):
                long[padding + sample] = values[run, sample, channel, column]
            first, last = long[padding], long[padding + samples - 1]
            for sample in range(padding):
                long[sample] = 2 * first - long[2 * padding - sample]
                long[padding + samples + sample] = 2 * last - long[padding + samples - 2 - sample]
            for _ in range(2):  # each pass turns the run over: forwards, then backwards
                x1 = x2 = y1 = y2 = long[0]
                for sample in range(len(long)):
                    x0 = long[sample]
                    y0 = b * (x0 + 2 * x1 + x2) - a1 * y1 - a2 * y2
                    x2, x1, y2, y1 = x1, x0, y1, y0
                    long[sample] = y0
                long[:] = long[::-1].copy()
            for sample in range(samples):
                values[run, sample, channel, column] = long[padding + sample]
