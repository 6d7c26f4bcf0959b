"""What two walks have in common: channels, whole strides, and the shift along the stride that most share."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from gaitdisc.channel import Channel, list_names, nearest_word
from gaitdisc.comparison.mismatch import Alignment
from gaitdisc.errors import ChannelError
from gaitdisc.processing.pooled_cycles import WalkSummary
from gaitdisc.recording import Finding
from gaitdisc.recording.arrays import Values, finite_rows
from gaitdisc.recording.wrapping import find_turn

LEAST_KEPT = 0.5  # of a walk's strides: a channel that would cost more is left out
SPOILED = ("frozen", "clipped", "dead")  # kinds of findings: what is left of the channel does not move as the joint did
STILL = 1e-6  # of its largest value: a channel that moves less is locked
MOST_SHIFT = 15  # % of the stride; farther, the halves of a stride are taken for each other
LEAST_SHIFT = 0.2  # % of the stride: two milliseconds
FEWEST_CHANNELS = 3
LEAST_AGREEING = 0.6  # of the channels: their gap narrows
# 62 pairs of real walks cut at the same mark: r rises by less in 96 %; with 8.7 % of the stride planted, more in 97 %
LEAST_GAIN = 0.05
MOST_LEFT = 0.9  # or the gap that is left, median over channels: strides of one person show smaller shifts


@dataclass(frozen=True, eq=False)
class CommonCurves:
    """Strides of two walks or more, complete, on the channels that all have."""

    channels: tuple[Channel, ...]  # in the order of the first walk
    curves: tuple[Values, ...]  # each (stride, phase, channel) [each channel's unit], one a walk
    findings: tuple[Finding, ...]


def common_curves(walks: Sequence[WalkSummary], wanted: Sequence[str] = ()) -> CommonCurves:
    """Strides of walks on the channels that all of them have in one unit.

    Left out, each with a finding: channels that a walk lacks or gives in another unit, that do not move in any walk,
    that repeat another channel, of which half of the strides or more have gaps, or that the quality checks found
    frozen, clipped or dead (unless they are requested). The foot with fewer strides decides how many are used of both.
    """
    findings: list[Finding] = []
    shared = _list_shared(walks, wanted, findings)
    spoiled = {f.channel: f.kind for walk in walks for f in walk.findings if f.kind in SPOILED and f.severity != "note"}
    named = [f"{c.name} ({spoiled[c.name]})" for c in shared if c.name in spoiled and not wanted]
    if named:
        what = f"excluded: {', '.join(named)}; name a channel with --channel to compare it nevertheless"
        findings.append(Finding("warning", "not compared", _both(walks), what, "the comparison of these channels"))
        shared = [c for c in shared if c.name not in spoiled]
    by_channel = {c.name: _whole_strides(walks, c) for c in shared}
    shared = [c for c in shared if _usable(c, by_channel[c.name], walks, findings)]
    shared = _moving(shared, by_channel, walks, findings)
    if not shared:
        raise ChannelError(
            "walks to be compared must share at least one channel that varies, in the same unit",
            f"{' and '.join(map(walk_name, walks[:2]))} have "
            f"{' and '.join(str(len(walk.channels)) for walk in walks[:2])} channels, but share no such channel"
            + (f": {findings[0].what}" if findings else ""),
            "Map the labels of both files to the same names in a study's [channels], and state the units.",
        )
    curves = []
    for number, walk in enumerate(walks):
        strides = [by_channel[c.name][number] for c in shared]
        fewest, most = min(map(len, strides)), max(map(len, strides))
        if fewest < most:
            what = (
                f"strides used: {fewest} of {most}; each of the others lacks one or more of the {len(shared)} compared "
                "channels"
            )
            findings.append(Finding("note", "strides", walk_name(walk), what, "the number of strides only"))
        curves.append(np.stack([rows[:fewest] for rows in strides], axis=2))
    return CommonCurves(tuple(shared), tuple(curves), tuple(findings))


def _list_shared(walks: Sequence[WalkSummary], wanted: Sequence[str], findings: list[Finding]) -> list[Channel]:
    units = [{channel.name: channel.unit for channel in walk.channels} for walk in walks]
    everywhere = [name for name in units[0] if all(name in unit for unit in units)]
    for name in wanted:
        if name not in everywhere:
            nearest = nearest_word(name, everywhere)
            lacking = [walk_name(walk) for walk, unit in zip(walks, units, strict=True) if name not in unit]
            raise ChannelError(
                f"channel {name!r} must be in all walks to be compared",
                f"{', '.join(lacking)} lack{'s' if len(lacking) == 1 else ''} it"
                + (f"; the most similar common name is {nearest!r}" if nearest else ""),
                f"Choose one of: {', '.join(everywhere) or 'none'}.",
            )
    everything = {name for unit in units for name in unit}
    for walk, unit in zip(walks, units, strict=True):
        absent = sorted(everything - set(unit))
        if absent:
            what = f"the walk lacks {list_names(absent)}, which another walk has"
            findings.append(Finding("note", "not compared", walk_name(walk), what, "the comparison of these channels"))
    shared = []
    for channel in walks[0].channels:
        if channel.name not in everywhere or (wanted and channel.name not in wanted):
            continue
        stated_units = sorted({unit[channel.name] for unit in units})
        if len(stated_units) > 1:
            what = f"given in {' and in '.join(map(repr, stated_units))}"
            findings.append(Finding("warning", "unit", _both(walks), what, "comparison of this channel", channel.name))
        else:
            shared.append(channel)
    return shared


def _whole_strides(walks: Sequence[WalkSummary], channel: Channel) -> list[Values]:
    """Strides of one channel without a gap, (stride, phase) a walk; headings by whole turns near the first walk's."""
    strides = []
    for walk in walks:
        curves = walk.curves[:, :, [c.name for c in walk.channels].index(channel.name)]
        strides.append(finite_rows(curves))
    turn = find_turn(channel)
    if turn is None or not len(strides[0]):
        return strides
    middle = strides[0].mean()
    return [curves - turn * np.round((curves.mean() - middle) / turn) if len(curves) else curves for curves in strides]


def _usable(channel: Channel, strides: list[Values], walks: Sequence[WalkSummary], findings: list[Finding]) -> bool:
    for curves, walk in zip(strides, walks, strict=True):
        if len(curves) <= LEAST_KEPT * len(walk.curves) and len(curves) < len(walk.curves):
            what = f"excluded because of gaps in {len(walk.curves) - len(curves)} of {len(walk.curves)} strides"
            findings.append(
                Finding("warning", "gaps", walk_name(walk), what, "the comparison of this channel", channel.name)
            )
            return False
    return all(len(curves) for curves in strides)


def _moving(
    shared: list[Channel], by_channel: dict[str, list[Values]], walks: Sequence[WalkSummary], findings: list[Finding]
) -> list[Channel]:
    still, twins, moving = [], [], []
    for channel in shared:
        strides = by_channel[channel.name]
        size = max(float(np.abs(curves).max()) for curves in strides)
        if max(float(np.ptp(curves)) for curves in strides) <= STILL * max(size, 1.0):
            still.append(channel.name)
        elif any(
            all(
                a.shape == b.shape and np.allclose(a, b, rtol=0, atol=1e-6)
                for a, b in zip(strides, by_channel[other.name], strict=True)
            )
            for other in moving
        ):
            twins.append(channel.name)
        else:
            moving.append(channel)
    for names, why in ((still, "constant in every walk"), (twins, "identical to another channel")):
        if names:
            text = f"excluded ({why}): {', '.join(names)}"
            findings.append(Finding("note", "not compared", _both(walks), text, "nothing"))
    return moving


def walk_name(walk: WalkSummary) -> str:
    """Who walked, and how."""
    return " ".join(part for part in (walk.subject, walk.condition) if part)


def _both(walks: Sequence[WalkSummary]) -> str:
    return ", ".join(map(walk_name, walks)) if len(walks) == 2 else f"{len(walks)} walks"


def common_shift(first: Values, second: Values) -> Alignment:
    """By how much later all curves of the first walk together fit those of the second best.

    The shift is where the correlation of the curves, mean over the channels, is highest. It is applied where the gap
    of 60 % of the channels narrows (offsets aside), and the mean correlation rises by 0.05 or the median gap falls to
    90 %.

    first, second (phase, channel) [each channel's unit]: mean curves over one stride on 101 points

    >>> percent = np.arange(101.0)
    >>> wave = np.stack([np.sin(2 * np.pi * k * percent / 100 + k) for k in (1, 2, 3)], axis=1)
    >>> found = common_shift(shift_curves(wave, -7.0), wave + [0.0, 5.0, -2.0])
    >>> round(found.percent, 1), found.applied, found.agreeing
    (7.0, True, 3)
    """
    count = first.shape[1]
    shifts = np.arange(-MOST_SHIFT, MOST_SHIFT + 1.0)
    gains = np.array([_correlation(shift_curves(first, shift), second).mean() for shift in shifts])
    at = int(np.argmax(gains))
    if at in (0, len(shifts) - 1) or count < FEWEST_CHANNELS:
        return Alignment(0.0, False, 0, count)
    before, peak, after = gains[at - 1 : at + 2]  # a parabola through them
    percent = round(float(shifts[at] + 0.5 * (before - after) / min(before - 2 * peak + after, -1e-12)), 1)
    moved = shift_curves(first, percent)
    gap_ratio = (moved - second)[:-1].std(axis=0) / np.maximum((first - second)[:-1].std(axis=0), 1e-12)
    gain = float(_correlation(moved, second).mean()) - gains[MOST_SHIFT]
    agreeing = int(np.sum(gap_ratio < 1.0))
    applied = bool(
        abs(percent) >= LEAST_SHIFT
        and agreeing >= LEAST_AGREEING * count
        and (gain >= LEAST_GAIN or float(np.median(gap_ratio)) <= MOST_LEFT)
    )
    largest = np.abs((first if applied else moved) - second).max(axis=0)
    return Alignment(percent, applied, agreeing, count, largest.tolist())


def shift_curves(curves: Values, percent: float) -> Values:
    """Curves (phase, ...) on 101 points moved later by percent of the closed stride, linearly between points."""
    places = (np.arange(100.0) - percent) % 100.0
    low = np.floor(places).astype(int) % 100
    share = (places - np.floor(places)).reshape(-1, *([1] * (curves.ndim - 1)))
    moved = (1 - share) * curves[low] + share * curves[(low + 1) % 100]
    return np.concatenate([moved, moved[:1]])


def align(walks: Sequence[Values], percent: float) -> list[Values]:
    """Strides of walks, each complete (stride, phase, channel), moved later by percent of the stride."""
    return [np.moveaxis(shift_curves(np.moveaxis(curves, 1, 0), percent), 0, 1) for curves in walks]


def _correlation(first: Values, second: Values) -> Values:
    """Correlation of two curves over the stride, (channel,); 0 where one does not move."""
    a, b = (curves[:-1] - curves[:-1].mean(axis=0) for curves in (first, second))
    return (a * b).sum(axis=0) / np.maximum(np.sqrt((a**2).sum(axis=0) * (b**2).sum(axis=0)), 1e-12)
