"""Where two walks disagree, in which part of the stride, how much, and whether strides by chance could have made it."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass

import numpy as np
import pandas as pd

from gaitdisc.channel import Channel
from gaitdisc.comparison.common_curves import CommonCurves, align, common_curves, common_shift, walk_name
from gaitdisc.comparison.mismatch import CHANNEL_COLUMNS, REGION_COLUMNS, Alignment, Exchange, Mismatch, Smallest
from gaitdisc.errors import ComparisonError
from gaitdisc.processing.pooled_cycles import WalkSummary
from gaitdisc.recording import PERCENT
from gaitdisc.recording.arrays import Values
from gaitdisc.saved.provenance import provenance_now
from gaitdisc.statistics.cluster_test import (
    FEWEST_IN_EACH,
    FEWEST_IN_ONE,
    USUAL,
    Cluster,
    ClusterTest,
    one_sample_test,
    two_sample_test,
)
from gaitdisc.statistics.stride_residuals import block_length, block_means, block_worth, stride_correlation

MOST_SHIFT = 10  # % of the stride
CLINICAL = Smallest()
POWER_80 = 0.8416  # standard normal quantile of .8
SECTION = "Find: mismatch of two walks over the stride"


@dataclass(frozen=True, eq=False)
class _Side:
    """One of the two that are compared: a walk, or a condition of all people; curves (phase, channel)."""

    name: str
    mean: Values
    sd: Values
    units: int  # that are exchanged
    strides: int  # that these hold


@dataclass(frozen=True, eq=False)
class _Compared:
    """A test, what it exchanged, and the curves it was about."""

    first: _Side
    second: _Side
    unit: str
    test: ClusterTest
    gap: Values
    alignment: Alignment
    limits: Values

    def named(self) -> list[Cluster]:
        """Clusters in which the gap reaches the smallest difference that is named."""
        gap = np.abs(self.gap)
        return [
            cluster
            for cluster in self.test.clusters
            if gap[cluster.first : cluster.last + 1, cluster.channel].max() >= self.limits[cluster.channel]
        ]


def compare_walks(
    first: WalkSummary, second: WalkSummary, wanted: Sequence[str] = (), smallest: Smallest = CLINICAL
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
    tested, reference = common.curves
    alignment = common_shift(tested.mean(axis=0), reference.mean(axis=0))
    if alignment.applied:
        [tested] = align([tested], alignment.percent)
    as_curve = len(tested) < FEWEST_IN_EACH
    fewest = FEWEST_IN_ONE if as_curve else FEWEST_IN_EACH
    if len(reference) < fewest:
        raise ComparisonError(
            f"{names[1]}, the reference walk, must have at least {fewest} strides, because they give the spread",
            f"it has {len(reference)}, and {names[0]} has {len(tested)}",
            "Record longer. If one walk is a single stride, such as a periodic simulation, give it as the first.",
        )
    correlation, shortest = stride_correlation(reference), len(reference)
    if not as_curve:
        correlation, shortest = np.maximum(stride_correlation(tested), correlation), min(len(tested), shortest)
    length = block_length(float(correlation.max()), shortest)
    worth, blocks = block_worth(correlation, length), block_means(reference, length)
    if as_curve:
        mean, count = tested.mean(axis=0), 1
        test = one_sample_test(blocks - mean, worth=worth)
    else:
        tested_blocks = block_means(tested, length)
        mean, count = tested_blocks.mean(axis=0), len(tested_blocks)
        test = two_sample_test(tested_blocks, blocks, worth=worth)
    unit = "stride" if length == 1 else f"block of {length} strides"
    before = _Side(names[0], mean, _sd(tested), count, len(tested))
    after = _Side(names[1], blocks.mean(axis=0), _sd(reference), len(blocks), len(reference))
    limits = _limits(common.channels, reference.mean(axis=0), smallest)
    compared = _Compared(before, after, unit, test, after.mean - before.mean, alignment=alignment, limits=limits)
    return _mismatch(common, compared, (first, second), smallest)


def compare_people(
    first: Sequence[WalkSummary],
    second: Sequence[WalkSummary],
    wanted: Sequence[str] = (),
    smallest: Smallest = CLINICAL,
) -> Mismatch:
    """Mismatch of two conditions over people, paired: each person's mean difference is one unit.

    first, second: the two walks of each person, in the same order of people; second minus first
    wanted: only these channels; by default all that every walk has
    smallest: difference that is named at least, as in `compare_walks`; the shift in common is that of the mean curves
    returns: its standard deviations are those from stride to stride, root mean square over people
    """
    if len(first) < FEWEST_IN_ONE:
        raise ComparisonError(
            f"at least {FEWEST_IN_ONE} participants must have both conditions for a comparison",
            f"the number of these participants is {len(first)}",
            "Compare the strides of one participant with --participant.",
        )
    walks = [walk for pair in zip(first, second, strict=True) for walk in pair]
    common = common_curves(walks, wanted)
    curves = [list(common.curves[k::2]) for k in (0, 1)]
    alignment = common_shift(*(np.mean([strides.mean(axis=0) for strides in part], axis=0) for part in curves))
    if alignment.applied:
        curves[0] = align(curves[0], alignment.percent)
    means = [np.array([strides.mean(axis=0) for strides in part]) for part in curves]
    test = one_sample_test(means[1] - means[0])
    before, after = (
        _Side(
            name=walk.condition,
            mean=mean.mean(axis=0),
            sd=np.sqrt(np.mean(np.square([_sd(strides) for strides in part]), axis=0)),
            units=len(part),
            strides=sum(map(len, part)),
        )
        for walk, mean, part in zip(walks[:2], means, curves, strict=True)
    )
    gap, limits = (means[1] - means[0]).mean(axis=0), _limits(common.channels, after.mean, smallest)
    compared = _Compared(before, after, "participant", test, gap, alignment=alignment, limits=limits)
    return _mismatch(common, compared, walks, smallest)


def best_shift(first: Values, second: Values) -> tuple[float, float]:
    """By how much later the first closed curve (phase,) fits the second best [% stride, to 10], and the rms gap left.

    >>> wave = np.sin(2 * np.pi * PERCENT / 100)
    >>> [round(value, 3) for value in best_shift(np.roll(wave[:-1], -3)[np.arange(101) % 100], wave)]
    [3.0, 0.0]
    """
    curve, target = first[:-1], second[:-1]
    shifts = sorted(range(-MOST_SHIFT, MOST_SHIFT + 1), key=abs)  # of equals the smallest
    gaps = [_rms(np.roll(curve, shift) - target) for shift in shifts]
    return float(shifts[int(np.argmin(gaps))]), min(gaps)


def _limits(channels: Sequence[Channel], curves: Values, smallest: Smallest) -> Values:
    reaches = np.ptp(curves, axis=0)
    return np.array([smallest.of(c.unit, float(reach)) for c, reach in zip(channels, reaches, strict=True)])


def _mismatch(common: CommonCurves, compared: _Compared, walks: Sequence[WalkSummary], smallest: Smallest) -> Mismatch:
    """Mismatch with the findings about what was compared, each once, the severest first."""
    about = {channel.name for channel in common.channels} | {""}
    findings = (*(finding for walk in walks for finding in walk.findings), *common.findings)
    reported = dict.fromkeys(finding for finding in findings if finding.channel in about or finding.kind == "unit")
    limits = {f"smallest_{key}": value for key, value in asdict(smallest).items() if value is not None}
    files = {name: sha256 for walk in walks for name, sha256 in walk.files.items()}
    first, second, test = compared.first, compared.second, compared.test
    half = test.threshold * test.standard_error
    curves = {
        "first": first.mean,
        "second": second.mean,
        "sd_first": first.sd,
        "sd_second": second.sd,
        "gap": compared.gap,
        "low": compared.gap - half,
        "high": compared.gap + half,
        "t": test.t,
    }
    regions = []
    for cluster in compared.named():
        column, inside = cluster.channel, slice(cluster.first, cluster.last + 1)
        at = cluster.first + int(np.argmax(np.abs(compared.gap[inside, column])))
        channel, largest = common.channels[column], float(compared.gap[at, column])
        regions.append((
            channel.name, channel.unit, PERCENT[cluster.first], PERCENT[cluster.last], largest, PERCENT[at],
            _in_sd(largest, float(second.sd[at, column])), float(compared.gap[inside, column].mean()), cluster.p,
        ))  # fmt: skip
    exchange = Exchange(
        unit=compared.unit,
        first=first.units,
        second=second.units,
        strides_first=first.strides,
        strides_second=second.strides,
        permutations=test.permutations,
        exact=test.exact,
        threshold=test.threshold,
        alpha=test.alpha,
    )
    return Mismatch(
        first=first.name,
        second=second.name,
        channels=common.channels,
        curves=curves,
        regions=pd.DataFrame(regions, columns=pd.Index(REGION_COLUMNS)),
        summary=_summary(common.channels, compared),
        exchange=exchange,
        findings=tuple(sorted(reported, key=lambda finding: finding.rank)),
        provenance=provenance_now(asdict(USUAL) | limits, USUAL.seed, files, SECTION),
        alignment=compared.alignment,
    )


def _summary(channels: tuple[Channel, ...], compared: _Compared) -> pd.DataFrame:
    test, gap = compared.test, compared.gap
    differing = {cluster.channel for cluster in compared.named()}
    beyond_chance = {cluster.channel for cluster in test.clusters}
    within = (np.abs(gap) + test.threshold * test.standard_error).max(axis=0)
    visible = (test.threshold + POWER_80) * np.median(test.standard_error, axis=0)
    rows = []
    for column, channel in enumerate(channels):
        at = int(np.argmax(np.abs(gap[:, column])))
        largest, sd = float(gap[at, column]), compared.second.sd[:, column]
        rows.append((
            channel.name, channel.unit, column in differing, largest, PERCENT[at], _in_sd(largest, float(sd[at])),
            _rms(gap[:, column]), _rms(sd), float(test.p[column]), float(within[column]), float(visible[column]),
            *best_shift(compared.first.mean[:, column], compared.second.mean[:, column]),
            float(compared.limits[column]), (offset := float(gap[:, column].mean())),
            float(np.abs(gap[:, column] - offset).max()), column in beyond_chance - differing,
        ))  # fmt: skip
    return pd.DataFrame(rows, columns=pd.Index(CHANNEL_COLUMNS))


def _sd(curves: Values) -> Values:
    return curves.std(axis=0, ddof=1) if len(curves) > 1 else np.full(curves.shape[1:], np.nan)


def _rms(values: Values) -> float:
    return float(np.sqrt(np.mean(values**2)))


def _in_sd(gap: float, sd: float) -> float:
    return gap / sd if sd > 0 else float("nan")
