"""Whether held-out data bear something out: the fall of the squared error, piece by piece, by Wilcoxon's test."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gaitdisc.discovery.estimates import NORMAL_95
from gaitdisc.results.discovery import ALPHA

WANTED = 12  # pieces; where pieces of a period are fewer, they are cut shorter, not below the residuals' correlation
ALIKE_BELOW = 0.05  # of the greatest difference
FEWEST_DIFFERING = 6  # pieces
FEWEST = 8  # pieces are kept all the same: fewer make the test blind, whatever they gain in independence
UNCORRELATED = 0.2  # autocorrelation that counts as none; more, where so few samples could show it by chance
MOST_EXACT = 60  # pieces, up to which the distribution of the sum of ranks is counted out


@dataclass(frozen=True)
class PairedTest:
    """A one-sided signed-rank test of the squared errors before and after, over pieces of held-out runs."""

    p: float  # chance of so clear a fall if each piece could as well rise; NaN where a run failed
    pieces: int
    fall: float  # of the summed squared error over that of the noise; negative where it rises
    alpha: float = ALPHA  # the greatest rate of false finds

    @property
    def bears_out(self) -> bool:
        """Whether the error falls, and not by chance."""
        return self.fall > 0 and self.p < self.alpha


def paired_test(
    before: NDArray[np.float64], after: NDArray[np.float64], floor: NDArray[np.float64], period: int
) -> PairedTest:
    """Compare the squared errors of two models over pieces of the same runs.

    before, after (run, sample, channel): measured minus each model [the channel's unit]; NaN where nothing was
        measured
    floor (channel,): standard deviation of the noise [the channel's unit]
    Source: Wilcoxon 1945, Biometrics Bulletin 1, 80.
    """
    fall = (before**2 - after**2) / floor**2
    if np.isinf(fall).any() or (np.isnan(fall) & ~np.isnan(before)).any():
        return PairedTest(float("nan"), 0, float("nan"))
    fall = np.nan_to_num(fall).sum(axis=2)
    runs, samples = fall.shape
    total = runs * samples
    length = min(period, max(total // WANTED, min(correlation_length(after), total // FEWEST), 1))
    blocks = max(samples // length, 1)
    gains = np.array([part.sum() for run in fall for part in np.array_split(run, blocks)])
    return PairedTest(signed_rank_p(gains), len(gains), float(gains.sum()))


def projected_test(before: NDArray[np.float64], after: NDArray[np.float64], floor: NDArray[np.float64]) -> PairedTest:
    """Test whether what one model errs by goes along with what another changes, each sample by its size.

    If the first model lacks nothing, its errors are noise, and their product with a change that was found on other data
    is 0 within the spread that the noise's autocovariance makes. The noise is what the second model leaves: no less
    than the truth where its change is spurious. An effect that acts in a part of the data is weighed by that part.

    before, after (run, sample, channel): measured minus each model [the channel's unit]; NaN where nothing was
        measured
    floor (channel,): standard deviation of the noise [the channel's unit]
    Source: Bartlett 1946, J. R. Stat. Soc. Suppl. 8, 27 (how many independent samples an autocorrelated record has).

    >>> rng = np.random.default_rng(0)
    >>> noise, change = rng.normal(size=(2, 200, 1)), np.sin(np.arange(200) / 9)[None, :, None]
    >>> one = np.ones(1)
    >>> projected_test(noise + change, noise, one).bears_out, projected_test(noise, noise + change, one).bears_out
    (True, False)
    """
    from scipy.stats import t as student

    if np.isinf(after).any() or (np.isnan(after) & ~np.isnan(before)).any() or np.isinf(before).any():
        return PairedTest(float("nan"), 0, float("nan"))
    first, second = (np.nan_to_num(one / floor) for one in (before, after))
    fall, change = float((first**2 - second**2).sum()), first - second
    samples = 2 * first.shape[1]
    noise, moved = (np.abs(np.fft.rfft(one, samples, axis=1)) ** 2 for one in (second, change))
    covariance = np.fft.irfft(noise.sum(axis=0), samples, axis=0) / max(np.isfinite(before[..., 0]).sum(), 1)
    together = np.fft.irfft(moved.sum(axis=0), samples, axis=0)
    spread = np.sqrt(max(float((covariance * together).sum()), 0.0))
    if not spread > 0:
        return PairedTest(1.0, 0, fall)
    known = np.isfinite(before).sum(axis=(0, 1))
    independent = float((known / (covariance**2 / covariance[0] ** 2).sum(axis=0)).sum())
    p = float(student.sf(float((first * change).sum()) / spread, max(independent - 1, 1.0)))
    return PairedTest(p, max(int(independent), 1), fall)


def differing(gains: NDArray[np.float64]) -> NDArray[np.float64]:
    """Leave out the pieces on which two models hardly differ, but for a few (piece,).

    Which these are does not depend on which model is the better, so that the test keeps its level.

    gains (piece,): differences of the two models' errors

    >>> differing(np.array([3.0, 2.0, 0.01, -2.5, 4.0, 2.0, 3.0])).tolist()
    [4.0, 3.0, 3.0, -2.5, 2.0, 2.0]
    """
    size = np.abs(gains)
    order = np.argsort(-size, kind="stable")
    return gains[order[: max(FEWEST_DIFFERING, int((size >= ALIKE_BELOW * size.max()).sum()))]]


def correlation_length(residual: NDArray[np.float64]) -> int:
    """Return after how many samples residuals are uncorrelated, for the channel where it takes longest.

    residual (run, sample, channel): measured minus a model

    >>> correlation_length(np.random.default_rng(0).normal(size=(4, 500, 1)))
    1
    """
    left = np.nan_to_num(residual)
    samples = left.shape[1]
    power = (left**2).sum(axis=(0, 1))
    forgotten = max(UNCORRELATED, NORMAL_95 / np.sqrt(left[:, :, 0].size))
    for lag in range(1, samples // 2):
        kept = (left[:, lag:] * left[:, :-lag]).sum(axis=(0, 1))
        if (np.abs(kept) <= forgotten * power).all():
            return lag
    return max(samples // 2, 1)


def signed_rank_p(gains: NDArray[np.float64]) -> float:
    """Chance of so great a sum of the ranks of what is gained, if each gain could as well have had the other sign.

    gains (piece,): zeros are left out

    >>> signed_rank_p(np.array([3.0, 2.0, 1.0])), signed_rank_p(np.array([3.0, -2.0, 1.0])), signed_rank_p(np.zeros(9))
    (0.125, 0.375, 1.0)
    """
    from scipy.stats import norm, rankdata

    from gaitdisc.statistics.signed_rank import sums_of_ranks

    gains = gains[gains != 0]
    if not len(gains):
        return 1.0
    ranks = rankdata(np.abs(gains))
    reached = ranks[gains > 0].sum()
    if len(gains) > MOST_EXACT:
        spread = np.sqrt((ranks**2).sum()) / 2
        return float(norm.sf((reached - 0.5 - ranks.sum() / 2) / spread))
    halves = np.rint(2 * ranks).astype(int)  # mean ranks are halves of whole numbers
    return float(sums_of_ranks(halves)[round(2 * reached) :].sum())
