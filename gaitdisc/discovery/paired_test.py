"""Whether unseen data bear a change of a model out: what it errs by, projected on what the change does to its runs."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gaitdisc.discovery.result import ALPHA
from gaitdisc.recording.arrays import Values

ALIKE_BELOW = 0.05  # of the greatest difference
FEWEST_DIFFERING = 6  # pieces
MOST_MEMORY = 0.99  # autocorrelation of neighbours; beyond, no record is long enough


@dataclass(frozen=True)
class PairedTest:
    """A one-sided test of the errors of the same runs before and after."""

    p: float  # chance of so clear a fall if the change did nothing; NaN where a run failed
    pieces: int  # independent samples that the runs are worth
    fall: float  # of the summed squared error over that of the noise; negative where it rises
    alpha: float = ALPHA  # the greatest rate of false finds

    @property
    def bears_out(self) -> bool:
        """Whether the error falls, and not by chance."""
        return self.fall > 0 and self.p < self.alpha


def compare_errors(before: Values, after: Values, floor: Values) -> PairedTest:
    """Test whether what one model errs by goes along with what another changes, each sample by its size.

    If the first model lacks nothing, its errors are noise, and their product with a change that was found on other data
    is 0 within the spread that the noise's autocovariance makes. The noise is what the second model leaves: no less
    than the truth where its change is spurious. An effect that acts in a part of the data is weighed by that part.
    Of 200 changes that did nothing 1 to 8 % are borne out at 5 % (200 to 1,000 samples of white, autoregressive and
    low-passed noise, sines and bumps), up to 11 % where some 20 samples are independent.

    before, after (run, sample, channel): measured minus each model [the channel's unit]; NaN where nothing was
        measured
    floor (channel,): standard deviation of the noise [the channel's unit]
    Source: Newey and West 1987, Econometrica 55, 703 (autocovariances weighed down with their lag); Andrews 1991,
    Econometrica 59, 817 (up to which lag); Bartlett 1946, J. R. Stat. Soc. Suppl. 8, 27 (how many independent samples
    an autocorrelated record has).

    >>> rng = np.random.default_rng(0)
    >>> noise, change = rng.normal(size=(2, 200, 1)), np.sin(np.arange(200) / 9)[None, :, None]
    >>> one = np.ones(1)
    >>> compare_errors(noise + change, noise, one).bears_out, compare_errors(noise, noise + change, one).bears_out
    (True, False)
    """
    from scipy.stats import t as student

    if np.isinf(after).any() or (np.isnan(after) & ~np.isnan(before)).any() or np.isinf(before).any():
        return PairedTest(float("nan"), 0, float("nan"))
    known = np.isfinite(before).sum(axis=(0, 1))
    first, second = (np.nan_to_num(error / floor) for error in (before, after))
    fall, change = float((first**2 - second**2).sum()), first - second
    covariance = _autocovariance(second, known)
    spread = np.sqrt(max(float((covariance * _lag_products(change)).sum()), 0.0))
    if not spread > 0:
        return PairedTest(1.0, 0, fall)
    independent = float((known / (covariance**2 / covariance[0] ** 2).sum(axis=0)).sum())
    p = float(student.sf(float((first * change).sum()) / spread, max(independent - 1, 1.0)))
    return PairedTest(p, max(int(independent), 1), fall)


def sum_error(change: Values, residual: Values) -> float:
    """Standard deviation of the sum of a change's products with noise that has a residual's autocovariance."""
    covariance = _autocovariance(np.nan_to_num(residual), np.isfinite(residual).sum(axis=(0, 1)))
    return float(np.sqrt(max(float((covariance * _lag_products(change)).sum()), 0.0)))


def _autocovariance(residual: Values, known: NDArray[np.intp]) -> Values:
    """Return the autocovariance of what is left (lag, channel), weighed down with the lag."""
    covariance = _lag_products(residual / np.sqrt(np.maximum(known, 1)))
    lags = np.abs(np.fft.fftfreq(len(covariance), 1 / len(covariance)))
    memory = min(float(np.abs(covariance[1] / covariance[0]).max()), MOST_MEMORY)
    last = 1.1447 * (4 * memory**2 * int(known.max()) / (1 - memory**2) ** 2) ** (1 / 3)  # the longer the memory
    return covariance * np.maximum(1 - lags / (min(last, len(lags) / 2 - 1) + 1), 0.0)[:, None]


def _lag_products(record: Values) -> Values:
    """Return products of samples a lag apart, summed over runs (lag, channel); lags below 0 come last."""
    samples = 2 * record.shape[1]
    power = np.abs(np.fft.rfft(record, samples, axis=1)) ** 2
    return np.fft.irfft(power.sum(axis=0), samples, axis=0)


def errors_rise_p(before: Values, after: Values) -> float:
    """Chance of errors so much greater if each could as well have been the smaller one.

    Pieces on which the two hardly differ are left out but for a few: which these are does not depend on which of the
    two is the better, so that the test keeps its level.

    Source: Wilcoxon 1945, Biometrics Bulletin 1, 80.

    >>> errors_rise_p(np.zeros(6), np.ones(6)), errors_rise_p(np.ones(6), np.zeros(6)), errors_rise_p(*np.ones((2, 6)))
    (0.015625, 1.0, 1.0)
    """
    from scipy.stats import wilcoxon

    rises = after - before
    size = np.abs(rises)
    n_used = max(FEWEST_DIFFERING, int((size >= ALIKE_BELOW * size.max()).sum()))
    rises = rises[np.argsort(-size, kind="stable")[:n_used]]
    return float(np.asarray(wilcoxon(rises, alternative="greater"), np.float64)[1]) if rises.any() else 1.0
