"""Sentences about a mismatch: which joint, which way, how far, in which part of the stride; or that there is no gap."""

import math

from gaitdisc.comparison.mismatch import Exchange, Mismatch
from gaitdisc.words import amount, counted, direction_words, listing, number, p_words, region_words, spoken, with_unit

MOST_NAMED = 3
MOST_LISTED = 8
SAID_FROM = 1.0  # % of the stride: less is the scatter of contacts
P_PRINTED = 0.001  # a smaller p is printed as less than that
MOSTLY_TIMING = 0.6  # of the gap that is left when the curve is moved along the stride


def mismatch_sentences(mismatch: Mismatch) -> list[str]:
    """Answer first: the largest gaps, or none; then what agrees, and to within how much."""
    ordered = mismatch.ordered()
    moved = alignment_sentences(mismatch)
    small = [name for name in mismatch.names if mismatch.summary_of(name)["too_small"]]
    unseen = [name for name in mismatch.names if name not in ordered and name not in small]
    walks, done = f"{mismatch.first} and {mismatch.second}", mismatch.exchange
    agreeing = []
    if unseen:
        bounds, sure = _by_unit(mismatch, unseen, "within"), f"{100 * (1 - done.alpha):g} %"
        agreeing.append(
            f"No significant gap in {_shorten(unseen)}: with {sure} confidence the walks agree to within {bounds} at "
            f"every point."
        )
    if not ordered and not small:
        strides = f"{done.strides_first} and {done.strides_second} strides"
        n = counted(done.first, "participant") if done.unit == "participant" else strides
        return [
            f"There is no significant gap: {walks} cannot be distinguished in "
            f"{counted(len(mismatch.channels), 'channel')} ({n}, {p_words(float(mismatch.summary['p'].min()))}).",
            *moved,
            "This does not prove equality: four of five such comparisons would detect a gap of "
            f"{_by_unit(mismatch, unseen, 'visible', smallest=True)} or more. Gaps of up to "
            f"{_by_unit(mismatch, unseen, 'within')} at some point are not excluded.",
        ]
    if not ordered:
        return [
            f"No difference is large enough to be named: {walks} differ significantly in {_shorten(small)}, but by "
            f"less than {_by_unit(mismatch, small, 'limit')} at every significant point.",
            *moved,
            *agreeing,
        ]
    if 1 / done.permutations >= P_PRINTED:
        moved = [*moved, smallest_p_sentence(mismatch)]
    sentences = [_gap(mismatch, ordered[0]), *moved]
    sentences += [_gap(mismatch, name, further=True) for name in ordered[1:MOST_NAMED]]
    if len(ordered) > MOST_NAMED:
        more = len(ordered) - MOST_NAMED
        others = _shorten(ordered[MOST_NAMED:])
        sentences.append(f"{counted(more, 'further channel')} {'differs' if more == 1 else 'differ'} too: {others}.")
    sentences += [timing] if (timing := _timing(mismatch, ordered[0])) else []
    if small:
        less = _by_unit(mismatch, small, "limit")
        sentences.append(f"Not named, because the significant difference is less than {less}: {_shorten(small)}.")
    return [*sentences, *agreeing]


def alignment_sentences(mismatch: Mismatch) -> list[str]:
    """Which shift most channels share, whether it was applied, and the gap the other way; nothing in the scatter."""
    alignment = mismatch.alignment
    if abs(alignment.percent) < SAID_FROM or not (alignment.applied or 2 * alignment.agreeing > alignment.channels):
        return []
    size = f"{number(abs(alignment.percent), 1)} % of the stride {'later' if alignment.percent > 0 else 'earlier'}"
    gaps = f"the gap of {alignment.agreeing} of {counted(alignment.channels, 'channel')}"
    sentence = f"{mismatch.first} was not shifted: shifting it {size} would narrow {gaps} only slightly."
    if alignment.applied:
        sentence = (
            f"All curves of {mismatch.first} were shifted {size} before the test; with this shift {gaps} narrows. "
            "Either the initial contacts differ by this time, or all joints move at another time."
        )
    if alignment.otherwise:  # not in a folder of an earlier version
        name = (mismatch.ordered() or mismatch.names)[0]
        row = mismatch.summary_of(name)
        sizes = abs(float(row["largest_gap"])), alignment.otherwise[mismatch.names.index(name)]
        moved, unmoved = map(amount, sizes if alignment.applied else sizes[::-1])
        unmoved = with_unit(unmoved, str(row["unit"]))
        sentence += f" With the shift, the largest gap of {spoken(name)} is {moved} instead of {unmoved}."
    return [sentence]


def smallest_p_sentence(mismatch: Mismatch) -> str:
    """Smallest p that the units of the test can give, and how many regions have it."""
    done, p = mismatch.exchange, mismatch.regions["p"]
    units = done.second if done.first == 1 or done.unit == "participant" else done.first + done.second
    of = counted(units, done.unit.split()[0]) if done.exact else f"{done.permutations} permutations"
    have = f"{int((p * done.permutations < 1.5).sum())} of {counted(len(p), 'region')}"
    return f"p = {1 / done.permutations:.2g} is the smallest value that {of} can give (reached in {have})."


def _kind(mismatch: Mismatch, name: str) -> str:
    """Whether a gap is an offset of the whole curve, a change of its shape, or both."""
    row = mismatch.summary_of(name)
    offset, shape, limit = (float(row[key]) for key in ("offset", "shape", "limit"))
    unit = str(row["unit"])
    if abs(offset) < limit:
        return ""
    if shape < limit:
        return f": an offset, because without the mean gap the curves agree to within {with_unit(amount(shape), unit)}"
    return f"; {with_unit(amount(abs(offset)), unit)} of the gap is an offset of the entire curve"


def method_sentences(mismatch: Mismatch) -> list[str]:
    """How the mismatch was found, and what its p speaks of."""
    done = mismatch.exchange
    named_from = _by_unit(mismatch, list(mismatch.names), "limit", smallest=True)
    band = f"{100 * (1 - done.alpha):g} %"
    all_of = "all possible ones" if done.exact else "drawn at random"
    if done.unit == "participant":
        units = (
            f"Each unit is a pair of walks of one participant (n = {done.first}). Under the null hypothesis the sign "
            "of each mean difference is random."
        )
        about = "p applies to people like these."
    else:
        about = (
            "p applies to these two recordings only, not to other days, marker placements or people. Two walks of one "
            "person often differ by more than the strides of one walk."
        )
        if done.first == 1:
            units = (
                f"{mismatch.first} has {counted(done.strides_first, 'stride')} and was treated as a curve without "
                f"spread; {counted(done.strides_second, 'stride')} of {mismatch.second}"
                f"{_blocks(done, str(done.second))} were tested against it. Under the null hypothesis the sign of each "
                "difference is random."
            )
        else:
            units = (
                f"{done.strides_first} strides of {mismatch.first} and {done.strides_second} of "
                f"{mismatch.second}{_blocks(done, f'{done.first} and {done.second}')} are the units. Under the null "
                "hypothesis the sign of each deviation from its walk's mean is random, so that the two walks may "
                "differ in spread."
            )
    return [
        f"The gap is the mean curve of {mismatch.second} minus that of {mismatch.first}. Each channel is averaged over "
        "the strides of its own foot, at 101 points of the stride.",
        units,
        "The t-value at every point is compared with the largest |t| over all points and all "
        f"{counted(len(mismatch.channels), 'channel')} in {done.permutations} permutations ({all_of}). The gap is "
        f"shaded beyond |t| = {done.threshold:.2f}, which {100 * done.alpha:g} % of the permutations exceed at some "
        f"point. The p-value of a region is that of its integral above this threshold. {smallest_p_sentence(mismatch)}",
        f"A difference is named if its gap reaches {named_from}; differences are sorted by the ratio of gap to "
        "limit. A shift along the stride that most channels share is removed before the test.",
        f"The band of the gap contains {band} for all points and channels together, and is wider if successive "
        "strides are correlated.",
        f"Standard deviations are those of {mismatch.second} over strides at the same point. {about}",
    ]


def _blocks(done: Exchange, counts: str) -> str:
    if done.unit == "stride":
        return ""
    return f", in {counts} blocks{done.unit.removeprefix('block')} because successive strides are correlated,"


def _shorten(names: list[str]) -> str:
    words = [spoken(name) for name in names]
    if len(words) <= MOST_LISTED + 1:
        return listing(words)
    return f"{', '.join(words[:MOST_LISTED])} and {len(words) - MOST_LISTED} more"


def _gap(mismatch: Mismatch, name: str, further: bool = False) -> str:
    """Largest gap of a channel; further: whether a sentence before it names the two walks."""
    row = max(mismatch.regions_of(name), key=lambda row: abs(row["gap"]))
    way, sd = direction_words(name, float(row["gap"]), str(row["unit"])), float(row["gap_sd"])
    in_sd = f"{amount(abs(sd))} stride-to-stride SD, " if math.isfinite(sd) else ""
    size = f"{region_words(row)} ({in_sd}{p_words(float(row['p']))}){_kind(mismatch, name)}."
    if further:
        return f"{way[0].upper()}{way[1:]} {size}"
    return f"In {mismatch.second} {way} than in {mismatch.first} {size}"


def _timing(mismatch: Mismatch, name: str) -> str:
    row = mismatch.summary_of(name)
    shift, before, after = float(row["shift_percent"]), float(row["rms_gap"]), float(row["rms_shifted"])
    if shift == 0 or after > MOSTLY_TIMING * before:
        return ""
    way = f"{abs(shift):.0f} % of the stride {'later' if shift > 0 else 'earlier'}"
    return (
        f"Much of the largest gap is a difference in timing: shifted {way}, the curve of {mismatch.first} differs by "
        f"{number(after, 1)} instead of {with_unit(number(before, 1), str(row['unit']))} (rms)."
    )


def _by_unit(mismatch: Mismatch, names: list[str], column: str, smallest: bool = False) -> str:
    """Largest value for each unit, with the range where wanted."""
    rows = [mismatch.summary_of(name) for name in names]
    texts = []
    for unit in dict.fromkeys(str(row["unit"]) for row in rows):
        of_unit = sorted((row for row in rows if row["unit"] == unit), key=lambda row: row[column])
        ends = [(amount(float(row[column])), spoken(str(row["channel"]))) for row in (of_unit[0], of_unit[-1])]
        text = with_unit(ends[1][0], unit)
        if smallest and len(of_unit) > 1:
            text = f"{ends[0][0]} ({ends[0][1]}) to {text} ({ends[1][1]})"
        texts.append(text)
    return listing(texts)
