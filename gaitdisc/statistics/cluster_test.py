"""Where over the stride curves differ: a permutation test of all points and all channels at once, and its clusters."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from gaitdisc.errors import ComparisonError, ShapeError
from gaitdisc.recording.arrays import Values

FEWEST_IN_ONE = 6  # 2^5 sign flips, of which the smallest p is 1/32
FEWEST_IN_EACH = 6  # fewer departures hold the level no longer
AT_ONCE = 2**23  # numbers held at once while permuting
ROUNDING = 1e-6  # of a channel's spread: a standard error below it is rounding


@dataclass(frozen=True)
class PermutationPlan:
    """How a permutation test is run."""

    alpha: float = 0.05  # chance of a false alarm anywhere in the stride and in any channel
    permutations: int = 2000  # most of them; where there are no more, all are taken
    seed: int = 0


USUAL = PermutationPlan()


def sign_flips(n: int, plan: PermutationPlan) -> tuple[Values, bool]:
    """Signs of every permutation but that of the units as they are.

    returns signs (permutation, unit): 1 or -1; with all signs turned |t| is the same, so the first unit keeps its own

    >>> signs, exact = sign_flips(6, PermutationPlan())
    >>> signs.shape, exact
    ((31, 6), True)
    """
    exact = 2 ** (n - 1) <= plan.permutations
    if exact:
        turned = (np.arange(1, 2 ** (n - 1))[:, None] >> np.arange(n - 1)) & 1
    else:
        turned = np.random.default_rng(plan.seed).integers(0, 2, (plan.permutations - 1, n - 1))
    count = len(turned) + 1
    if plan.alpha * count < 1:
        raise ComparisonError(
            f"a test at level {plan.alpha:g} must have at least {int(np.ceil(1 / plan.alpha))} permutations",
            f"the requested number is {count}",
            "Raise the number of permutations, or the level.",
        )
    signs = np.ones((len(turned), n))
    signs[:, 1:] -= 2.0 * turned
    return signs, exact


Statistic = Callable[[Values], Values]


@dataclass(frozen=True)
class Cluster:
    """A stretch of the stride in which two sets of curves differ."""

    channel: int
    first: int
    last: int
    sign: int  # 1 where the second set lies above, -1 where it lies below
    mass: float  # integral of |t| above the threshold over the points
    p: float  # share of permutations with a cluster of that mass or more anywhere in the stride and in any channel


@dataclass(frozen=True, eq=False)
class ClusterTest:
    """A permutation test of curves, all points and channels corrected together."""

    t: Values  # (phase, channel), statistic of the curves as they are
    standard_error: Values  # (phase, channel) [each channel's unit], of the difference
    threshold: float  # |t| that only alpha of the permutations exceed anywhere
    p: Values  # (channel,), of the channel's largest |t|, corrected for all points and channels
    clusters: tuple[Cluster, ...]  # stretches beyond the threshold, by channel and point
    permutations: int  # how many, the curves as they are among them
    exact: bool  # whether these are all that there are
    alpha: float  # chance of a point beyond the threshold anywhere where nothing differs


def one_sample_test(curves: Values, plan: PermutationPlan = USUAL, worth: Values | None = None) -> ClusterTest:
    """Test whether curves lie about zero: differences of pairs, or curves minus one that is known.

    Under the null the sign of a unit's curve as a whole is by chance, which keeps what binds its points and channels
    together. Student's t at every point; the threshold is that of the largest |t| over points and channels.

    curves (unit, phase, channel) [each channel's unit]: complete; units are exchangeable: people, strides, or blocks
        of strides
    worth (channel,): independent units that one unit is worth, at most 1; t is divided by the root of its inverse
    Source: Nichols and Holmes 2002 (largest statistic); Pataky, Vanrenterghem and Robinson 2015 (curves; spm1d).
        Differs from spm1d: one threshold for both signs, and channels are corrected together.

    >>> curves = np.random.default_rng(0).normal(0.0, 1.0, (20, 101, 1))
    >>> curves[:, 40:60] += 3.0
    >>> [(found.first, found.last) for found in one_sample_test(curves).clusters]
    [(40, 59)]
    """
    _check(curves, FEWEST_IN_ONE)
    n, *shape = curves.shape
    flat = curves.reshape(n, -1)
    squares, least = (flat**2).sum(axis=0), _least_error(curves, n)

    def t_of(signs: Values) -> Values:
        mean = signs @ flat / n
        variance = np.maximum(squares - n * mean**2, 0.0) / (n - 1)
        return (mean / np.sqrt(variance / n + least)).reshape(-1, *shape)

    mean = curves.mean(axis=0)
    error = np.sqrt(curves.var(axis=0, ddof=1) / n + least.reshape(shape))
    return _test(mean / error, error, t_of, sign_flips(n, plan), plan, worth)


def two_sample_test(
    first: Values, second: Values, plan: PermutationPlan = USUAL, worth: Values | None = None
) -> ClusterTest:
    """Test whether two independent sets of curves differ, second minus first.

    Under the null the sign of each unit's departure from the mean of its set is by chance. Welch's t at every point;
    the threshold is that of the largest |t| over points and channels. Signs are turned rather than units exchanged
    between the sets, because a simulation spreads less than people do: with three times the spread in one of two sets
    of 8 to 20 units, exchange raised a false alarm in .05 to .59 of 300 draws, signs in .04 to .07.

    first, second (unit, phase, channel) [each channel's unit]: complete; units are exchangeable: people, strides, or
        blocks of strides
    worth (channel,): independent units that one unit is worth, at most 1; t is divided by the root of its inverse
    Source: As `one_sample_test`; signs of departures: Liu 1988, Winkler et al. 2014. spm1d's permutation test
        exchanges units and pools the variances.

    >>> first, second = np.random.default_rng(0).normal(0.0, 1.0, (2, 20, 101, 1))
    >>> second[:, 40:60] -= 4.0
    >>> [(found.first, found.last, found.sign) for found in two_sample_test(first, second).clusters]
    [(40, 59, -1)]
    """
    _check(first, FEWEST_IN_EACH)
    _check(second, FEWEST_IN_EACH)
    if first.shape[1:] != second.shape[1:]:
        raise ShapeError(
            "both sets of curves must have the same points of the stride and the same channels",
            f"their shapes are {first.shape} and {second.shape}",
            "Normalise both to 101 points and choose the channels that both have.",
        )
    sets, shape = (first, second), first.shape[1:]
    apart = [(curves - curves.mean(axis=0)).reshape(len(curves), -1) for curves in sets]
    least = _least_error(np.concatenate(apart).reshape(-1, *shape), len(first) + len(second))

    def t_of(signs: Values) -> Values:
        means, squares = [], least
        for part, turned in zip(apart, np.split(signs, [len(first)], axis=1), strict=True):
            n = len(part)
            mean = turned @ part / n
            squares = squares + np.maximum((part**2).sum(axis=0) - n * mean**2, 0.0) / (n - 1) / n
            means.append(mean)
        return ((means[1] - means[0]) / np.sqrt(squares)).reshape(-1, *shape)

    difference = second.mean(axis=0) - first.mean(axis=0)
    variance = first.var(axis=0, ddof=1) / len(first) + second.var(axis=0, ddof=1) / len(second)
    error = np.sqrt(variance + least.reshape(shape))
    return _test(difference / error, error, t_of, sign_flips(len(first) + len(second), plan), plan, worth)


def _test(
    t: Values, error: Values, t_of: Statistic, drawn: tuple[Values, bool], plan: PermutationPlan, worth: Values | None
) -> ClusterTest:
    permutations, exact = drawn
    share = np.sqrt(np.ones(t.shape[1]) if worth is None else np.minimum(worth, 1.0))
    largest = [np.abs(t_of(part)).max(axis=(1, 2)) for part in _parts(permutations, t.size)]
    over_all = np.concatenate([[np.abs(t).max()], *largest])  # the curves as they are count as one
    threshold = float(np.sort(over_all)[::-1][int(np.floor(plan.alpha * len(over_all)))])
    beyond = permutations[over_all[1:] > threshold]
    fields = [t, *(field for part in _parts(beyond, t.size) for field in t_of(part))]
    masses = np.zeros(len(over_all))
    masses[: len(fields)] = [max((mass for *_, mass in _stretches(field, threshold)), default=0.0) for field in fields]
    t, error = t * share, error / share
    clusters = tuple(
        Cluster(channel, first, last, sign, mass, float(np.mean(masses >= mass * (1 - 1e-9))))
        for channel, first, last, sign, mass in _stretches(t, threshold)
    )
    p = np.array([np.mean(over_all >= peak * (1 - 1e-9)) for peak in np.abs(t).max(axis=0)])
    return ClusterTest(t, error, threshold, p, clusters, permutations=len(over_all), exact=exact, alpha=plan.alpha)


def _stretches(t: Values, threshold: float) -> Iterator[tuple[int, int, int, int, float]]:
    """Channel, first and last point, sign and mass of every run beyond the threshold."""
    for channel in np.flatnonzero((np.abs(t) > threshold).any(axis=0)):
        side = np.sign(t[:, channel]) * (np.abs(t[:, channel]) > threshold)
        edges = np.flatnonzero(np.diff(side, prepend=0.0, append=0.0))
        for start, end in pairwise(edges):
            if side[start]:
                above = np.abs(t[start:end, channel]) - threshold
                mass = float(((above[1:] + above[:-1]) / 2).sum()) if len(above) > 1 else float(above[0])
                yield int(channel), int(start), int(end) - 1, int(side[start]), mass


def _parts(drawn: Values, size: int) -> Iterator[Values]:
    step = max(1, AT_ONCE // (4 * size))
    for start in range(0, len(drawn), step):
        yield drawn[start : start + step]


def _least_error(curves: Values, n: int) -> Values:
    """Square of the smallest standard error that is more than rounding, (phase x channel,)."""
    spread = np.maximum((curves**2).mean(axis=(0, 1)), np.finfo(float).tiny)
    return np.broadcast_to(ROUNDING**2 * spread / n, curves.shape[1:]).ravel()


def _check(curves: Values, fewest: int) -> None:
    if curves.ndim != 3 or not np.isfinite(curves).all():
        missing = int(np.sum(~np.isfinite(curves)))
        raise ShapeError(
            "the curves of a test over the stride must be complete and of shape (unit, phase, channel)",
            f"found {curves.shape}" + (f", {missing} values missing" if missing else ""),
            "Exclude strides or channels with gaps, and state which.",
        )
    if len(curves) < fewest:
        raise ComparisonError(
            f"a permutation test at the 5 % level must have at least {fewest} units in each set",
            f"found {len(curves)}",
            "Record more strides or people. With fewer units, no result can be significant.",
        )
