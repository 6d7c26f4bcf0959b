"""Where two walks disagree, in which part of the stride, how much, and whether strides by chance could have made it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from gaitdisc.channel import Channel
from gaitdisc.comparison.common_curves import CommonCurves, aligned, common_curves, common_shift, walk_name
from gaitdisc.comparison.mismatch import CHANNEL_COLUMNS, REGION_COLUMNS, Alignment, Exchange, Mismatch, Smallest
from gaitdisc.errors import ComparisonError
from gaitdisc.processing.pooled_cycles import WalkSummary
from gaitdisc.recording import PERCENT
from gaitdisc.saved.provenance import made_now
from gaitdisc.statistics.cluster_test import (
    FEWEST_IN_EACH,
    FEWEST_IN_ONE,
    USUAL,
    Cluster,
    ClusterTest,
    PermutationPlan,
    one_sample_test,
    two_sample_test,
)
from gaitdisc.statistics.stride_residuals import block_length, block_means, block_worth, stride_correlation

MOST_SHIFT = 10  # % of the stride
CLINICAL = Smallest()
POWER_80 = 0.8416  # standard normal quantile of .8
SECTION = "Find: mismatch of two walks over the stride"


@dataclass(frozen=True, eq=False)
class _Compared:
    """A test, what it exchanged, and the curves it was about."""

    test: ClusterTest
    exchange: Exchange
    gap: NDArray[np.float64]
    means: tuple[NDArray[np.float64], NDArray[np.float64]]
    sds: tuple[NDArray[np.float64], NDArray[np.float64]]
    alignment: Alignment
    limits: NDArray[np.float64]

    def named(self) -> list[Cluster]:
        """Clusters in which the gap reaches the smallest difference that is named."""
        gap = np.abs(self.gap)
        return [
            one
            for one in self.test.clusters
            if gap[one.first : one.last + 1, one.channel].max() >= self.limits[one.channel]
        ]


def compare_walks(
    first: WalkSummary,
    second: WalkSummary,
    wanted: Sequence[str] = (),
    plan: PermutationPlan = USUAL,
    smallest: Smallest = CLINICAL,
) -> Mismatch:
    """Mismatch of two walks, second minus first; strides, or blocks of them, are the units of exchange.

    Where successive strides depend on each other, blocks of consecutive strides are exchanged, and the dependence that
    blocks still have widens the standard error. A first walk of fewer than six strides (a periodic simulation has one)
    is taken as a curve: the second walk's strides are tested against it. A shift along the stride that the channels
    have in common is taken off first (`common_shift`): it says that the marks of initial contact lie apart, and would
    make a gap in every channel that moves. What is smaller than `smallest` is not named.

    second: what was measured, or the other condition; its strides give the spread
    smallest: difference that is named at least; 2 deg, 0.1 N m/kg, 5 % of body weight or of the channel's range by
        default
    returns: its p speaks of these two recordings; that other people, or another day, would give the same it cannot say
    """
    names = (walk_name(first), walk_name(second))
    common = common_curves((first, second), wanted)
    one, other = common.curves
    alignment = common_shift(one.mean(axis=0), other.mean(axis=0))
    if alignment.applied:
        [one] = aligned([one], alignment.percent)
    as_curve = len(one) < FEWEST_IN_EACH
    fewest = FEWEST_IN_ONE if as_curve else FEWEST_IN_EACH
    if len(other) < fewest:
        raise ComparisonError(
            f"{names[1]} is the reference, whose strides give the spread: it must have at least {fewest}",
            f"it has {len(other)}, {names[0]} has {len(one)}",
            "Record longer. Name a walk of a single stride, such as a periodic simulation, first.",
        )
    correlation, shortest = stride_correlation(other), len(other)
    if not as_curve:
        correlation, shortest = np.maximum(stride_correlation(one), correlation), min(len(one), shortest)
    length = block_length(float(correlation.max()), shortest)
    worth, blocks = block_worth(correlation, length), block_means(other, length)
    if as_curve:
        mean, count = one.mean(axis=0), 1
        test = one_sample_test(blocks - mean, plan, worth)
    else:
        own = block_means(one, length)
        mean, count = own.mean(axis=0), len(own)
        test = two_sample_test(own, blocks, plan, worth)
    means = (mean, blocks.mean(axis=0))
    unit = "stride" if length == 1 else f"block of {length} strides"
    exchange = _exchange(unit, (count, len(blocks)), (len(one), len(other)), test)
    limits = _limits(common.channels, other.mean(axis=0), smallest)
    compared = _Compared(test, exchange, means[1] - means[0], means, (_sd(one), _sd(other)), alignment, limits=limits)
    return _mismatch(names, common, compared, (first, second), _settings(plan, smallest))


def compare_people(
    pairs: Sequence[tuple[WalkSummary, WalkSummary]],
    wanted: Sequence[str] = (),
    plan: PermutationPlan = USUAL,
    smallest: Smallest = CLINICAL,
) -> Mismatch:
    """Mismatch of two conditions over people, paired: each person's mean difference is one unit.

    pairs: both walks of each person; second minus first
    wanted: only these channels; by default all that every walk has
    smallest: difference that is named at least, as in `compare_walks`; the shift in common is that of the mean curves
    returns: its standard deviations are those from stride to stride, root mean square over people
    """
    if len(pairs) < FEWEST_IN_ONE:
        raise ComparisonError(
            f"two conditions can be compared across at least {FEWEST_IN_ONE} participants",
            f"{len(pairs)} have both",
            "Compare the strides of one participant with --participant.",
        )
    walks = [walk for pair in pairs for walk in pair]
    common = common_curves(walks, wanted)
    alignment = common_shift(*(np.mean([c.mean(axis=0) for c in common.curves[k::2]], axis=0) for k in (0, 1)))
    curves_of = [list(common.curves[k::2]) for k in (0, 1)]
    if alignment.applied:
        curves_of[0] = aligned(curves_of[0], alignment.percent)
    means = [np.array([curves.mean(axis=0) for curves in part]) for part in curves_of]
    spreads = [[_sd(curves) for curves in part] for part in curves_of]
    test = one_sample_test(means[1] - means[0], plan)
    strides = [sum(map(len, common.curves[k::2])) for k in (0, 1)]
    exchange = _exchange("participant", (len(pairs), len(pairs)), (strides[0], strides[1]), test)
    gap = (means[1] - means[0]).mean(axis=0)
    sds = tuple(np.sqrt(np.mean(np.square(one), axis=0)) for one in spreads)
    middles = (means[0].mean(axis=0), means[1].mean(axis=0))
    limits = _limits(common.channels, middles[1], smallest)
    compared = _Compared(test, exchange, gap, means=middles, sds=(sds[0], sds[1]), alignment=alignment, limits=limits)
    conditions = (pairs[0][0].condition, pairs[0][1].condition)
    return _mismatch(conditions, common, compared, walks, _settings(plan, smallest))


def best_shift(first: NDArray[np.float64], second: NDArray[np.float64]) -> tuple[float, float]:
    """By how much later the first closed curve (phase,) fits the second best [% stride, to 10], and the rms gap left.

    >>> wave = np.sin(2 * np.pi * PERCENT / 100)
    >>> [round(value, 3) for value in best_shift(np.roll(wave[:-1], -3)[np.arange(101) % 100], wave)]
    [3.0, 0.0]
    """
    one, other = first[:-1], second[:-1]
    shifts = sorted(range(-MOST_SHIFT, MOST_SHIFT + 1), key=abs)  # of equals the smallest
    left = [_rms(np.roll(one, shift) - other) for shift in shifts]
    return float(shifts[int(np.argmin(left))]), min(left)


def _limits(channels: Sequence[Channel], curves: NDArray[np.float64], smallest: Smallest) -> NDArray[np.float64]:
    reaches = np.ptp(curves, axis=0)
    return np.array([smallest.of(c.unit, float(reach)) for c, reach in zip(channels, reaches, strict=True)])


def _exchange(unit: str, counts: tuple[int, int], strides: tuple[int, int], test: ClusterTest) -> Exchange:
    return Exchange(unit, *counts, *strides, test.permutations, test.exact, test.threshold, test.alpha)


def _mismatch(
    names: tuple[str, str],
    common: CommonCurves,
    compared: _Compared,
    walks: Sequence[WalkSummary],
    settings: Mapping[str, Any],
) -> Mismatch:
    """Mismatch with the findings about what was compared, each once, the severest first."""
    about = {channel.name for channel in common.channels} | {""}
    findings = (*(finding for walk in walks for finding in walk.findings), *common.findings)
    kept = dict.fromkeys(finding for finding in findings if finding.channel in about or finding.kind == "unit")
    files = {name: sha256 for walk in walks for name, sha256 in walk.files.items()}
    half = compared.test.threshold * compared.test.standard_error
    curves = {
        "first": compared.means[0],
        "second": compared.means[1],
        "sd_first": compared.sds[0],
        "sd_second": compared.sds[1],
        "gap": compared.gap,
        "low": compared.gap - half,
        "high": compared.gap + half,
        "t": compared.test.t,
    }
    return Mismatch(
        first=names[0],
        second=names[1],
        channels=common.channels,
        curves=curves,
        regions=_regions(common.channels, compared),
        summary=_summary(common.channels, compared),
        exchange=compared.exchange,
        findings=tuple(sorted(kept, key=lambda finding: finding.rank)),
        provenance=made_now(settings, settings["seed"], files, SECTION),
        alignment=compared.alignment,
    )


def _regions(channels: tuple[Channel, ...], compared: _Compared) -> pd.DataFrame:
    rows = []
    for cluster in compared.named():
        inside = slice(cluster.first, cluster.last + 1)
        gap = compared.gap[inside, cluster.channel]
        at = cluster.first + int(np.argmax(np.abs(gap)))
        channel = channels[cluster.channel]
        largest = float(compared.gap[at, cluster.channel])
        sd = float(compared.sds[1][at, cluster.channel])
        rows.append((
            channel.name, channel.unit, PERCENT[cluster.first], PERCENT[cluster.last], largest, PERCENT[at],
            _in_sd(largest, sd), float(gap.mean()), cluster.p,
        ))  # fmt: skip
    return pd.DataFrame(rows, columns=pd.Index(REGION_COLUMNS))


def _summary(channels: tuple[Channel, ...], compared: _Compared) -> pd.DataFrame:
    test, gap = compared.test, compared.gap
    differing = {cluster.channel for cluster in compared.named()}
    beyond_chance = {cluster.channel for cluster in test.clusters}
    within = (np.abs(gap) + test.threshold * test.standard_error).max(axis=0)
    visible = (test.threshold + POWER_80) * np.median(test.standard_error, axis=0)
    rows = []
    for column, channel in enumerate(channels):
        at = int(np.argmax(np.abs(gap[:, column])))
        largest, sd = float(gap[at, column]), compared.sds[1][:, column]
        rows.append((
            channel.name, channel.unit, column in differing, largest, PERCENT[at], _in_sd(largest, float(sd[at])),
            _rms(gap[:, column]), _rms(sd), float(test.p[column]), float(within[column]), float(visible[column]),
            *best_shift(compared.means[0][:, column], compared.means[1][:, column]),
            float(compared.limits[column]), (offset := float(gap[:, column].mean())),
            float(np.abs(gap[:, column] - offset).max()), column in beyond_chance - differing,
        ))  # fmt: skip
    return pd.DataFrame(rows, columns=pd.Index(CHANNEL_COLUMNS))


def _settings(plan: PermutationPlan, smallest: Smallest) -> dict[str, Any]:
    return asdict(plan) | {f"smallest_{key}": value for key, value in asdict(smallest).items() if value is not None}


def _sd(curves: NDArray[np.float64]) -> NDArray[np.float64]:
    return curves.std(axis=0, ddof=1) if len(curves) > 1 else np.full(curves.shape[1:], np.nan)


def _rms(values: NDArray[np.float64]) -> float:
    return float(np.sqrt(np.mean(values**2)))


def _in_sd(gap: float, sd: float) -> float:
    return gap / sd if sd > 0 else float("nan")
