"""Wilcoxon's signed-rank test of pairs, exact: with what was dropped, how large the difference is, and how sure."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike, NDArray
from scipy.stats import rankdata, wilcoxon

from gaitdisc.errors import ComparisonError, ShapeError
from gaitdisc.recording.arrays import Values
from gaitdisc.statistics.holm_sidak import check_level


@dataclass(frozen=True)
class SignedRank:
    """One test of pairs."""

    n: int  # pairs whose differences were ranked: neither left out nor zero
    zeros: int  # pairs without a difference; they were dropped from the ranking
    ties: bool  # some differences are equally large; p is that of their mean ranks
    w: float  # the smaller of the two sums of ranks
    p: float
    rank_biserial: float  # (W+ - W-) / (W+ + W-): -1 every pair falls, 1 every pair rises; NaN where no pair differs
    median: float  # of the differences, zeros among them [the numbers' unit]
    shift: float  # Hodges-Lehmann shift [the numbers' unit]
    low: float  # lower end of its interval; -inf where so few pairs have none
    high: float  # upper end of its interval; inf where so few pairs have none
    level: float  # requested of the interval; what it holds is at least that
    left_out: tuple[str, ...]  # reasons of the pairs that were left out, one each


def signed_rank(
    first: ArrayLike, second: ArrayLike, left_out: Mapping[int, str] | None = None, level: float = 0.95
) -> SignedRank:
    """Test whether the differences of pairs (second minus first) are centred on zero.

    Differences are compared in float64. Zeros are counted but not ranked (Wilcoxon); ties share their mean rank.

    Parameters
    ----------
    first, second : array_like (pair,)
        Numbers in one unit, in the order of the pairs. Two Series are paired by their index.
    left_out : mapping of int to str, optional
        Number of each pair that is left out -> reason. Other missing numbers are refused, because silently dropping one
        of 11 pairs doubles the smallest possible p.
    level : float
        Confidence level of the interval.

    Returns
    -------
    SignedRank

    Raises
    ------
    ShapeError
        If the lengths differ, or two Series have different participants.
    ComparisonError
        If a number is missing without a reason, or no pair remains.

    References
    ----------
    Wilcoxon 1945; Hodges and Lehmann 1963; matched rank-biserial correlation: Kerby 2014, computed by pingouin. Ebers
    2023, section 4.2.3: at n = 11, W = 10 gives the printed p < 0.042.

    Examples
    --------
    >>> rise = np.array([5.0, 6, 7, 8, 9, 10, 11, 1, -2, -3, -4]) / 100
    >>> found = signed_rank(np.zeros(11), rise)
    >>> found.w, round(found.p, 4), round(found.rank_biserial, 3), round(found.shift, 4)
    (9.0, 0.0322, 0.727, 0.0425)
    """
    check_level(level, "level")
    first, second = in_one_order(first, second)
    differences = _differences(np.asarray(first, float), np.asarray(second, float), left_out or {})
    ranked = differences[differences != 0]
    ranks = rankdata(np.abs(ranked))
    shift, low, high = shift_interval(differences, level)
    rank_biserial = float("nan")
    if len(ranked):
        import pingouin

        rank_biserial = float(pingouin.wilcoxon(ranked, method="asymptotic")["RBC"].iloc[0])  # its p is not used
    return SignedRank(
        n=len(ranked),
        zeros=len(differences) - len(ranked),
        ties=len(np.unique(ranks)) < len(ranks),
        w=float(min(ranks[ranked > 0].sum(), ranks[ranked < 0].sum())),
        p=exact_p(differences),
        rank_biserial=rank_biserial,
        median=float(np.median(differences)),
        shift=shift,
        low=low,
        high=high,
        level=level,
        left_out=tuple((left_out or {}).values()),
    )


def exact_p(differences: Values) -> float:
    """Exact two-sided p of the differences: the share of all 2^n signs that are as one-sided as these, or more.

    Without equal differences it is scipy's exact distribution. With them scipy's is not exact (it ranks as if there
    were none), so the distribution of the mean ranks is summed here. 1 where no pair differs.

    differences (pair,): complete; zeros are dropped

    >>> round(exact_p(np.arange(1.0, 12)), 6)
    0.000977
    """
    ranked = differences[differences != 0]
    if not len(ranked):
        return 1.0
    ranks = rankdata(np.abs(ranked))
    if len(np.unique(ranks)) == len(ranks):
        return float(wilcoxon(ranked, method="exact").pvalue)  # type: ignore[attr-defined]
    halves = np.rint(2 * ranks).astype(int)  # mean ranks are halves of whole numbers
    w = min(halves[ranked > 0].sum(), halves[ranked < 0].sum())
    return float(min(1.0, 2 * sums_of_ranks(halves)[: w + 1].sum()))


def smallest_p(n: int) -> float:
    """Smallest two-sided p that n pairs can give: all n differences of one sign.

    >>> smallest_p(11), smallest_p(5)
    (0.0009765625, 0.0625)
    """
    return min(1.0, 2.0 ** (1 - n))


def shift_interval(differences: Values, level: float = 0.95) -> tuple[float, float, float]:
    """Hodges-Lehmann shift, the median of the means of all pairs of differences, and its exact interval.

    The interval holds every shift that the signed-rank test at 1 - level does not reject. Zeros stay in: they are zero
    for the question whether there is a shift, not for that how large it is. With equal differences the interval is
    wider than it need be, never narrower.

    differences (pair,): complete
    returns shift, low, high: in the differences' unit; low and high infinite where even all signs alike are no
        evidence at this level

    >>> shift_interval(np.array([1.0, 2.0, 4.0]))
    (2.25, -inf, inf)
    """
    n = len(differences)
    first, second = np.triu_indices(n)
    means = np.sort((differences[first] + differences[second]) / 2)
    below = np.cumsum(sums_of_ranks(np.arange(1, n + 1)))  # share of W+ at or below its index
    outside = int(np.searchsorted(below, (1 - level) / 2, side="right"))  # means that may lie outside at each end
    if not outside:
        return float(np.median(means)), -np.inf, np.inf
    return float(np.median(means)), float(means[outside - 1]), float(means[-outside])


def _differences(first: Values, second: Values, left_out: Mapping[int, str]) -> Values:
    if first.ndim != 1 or first.shape != second.shape:
        raise ShapeError(
            "a paired test must have two rows of numbers of the same length",
            f"their shapes are {first.shape} and {second.shape}",
            "Give one number per participant and condition.",
        )
    kept = np.array([pair not in left_out for pair in range(len(first))], bool)
    differences = second - first
    missing = np.flatnonzero(kept & ~np.isfinite(differences))
    if len(missing):
        raise ComparisonError(
            "a paired test must have both numbers of every pair",
            f"a number is missing in {len(missing)} of {len(first)} pairs ({', '.join(str(i + 1) for i in missing)})",
            "Exclude these pairs, and state which and why.",
        )
    if not kept.any():
        raise ComparisonError(
            "a paired test must have at least one pair",
            f"pairs given: {len(first)}; excluded: {len(first) - int(kept.sum())}",
            "Add participants.",
        )
    return differences[kept]


def sums_of_ranks(ranks: NDArray[np.intp]) -> Values:
    """Share of the 2^n signs that give each sum of positive ranks, 0 to all of them.

    ranks (pair,): whole numbers; mean ranks doubled
    """
    shares = np.zeros(int(ranks.sum()) + 1)
    shares[0] = 1.0
    for rank in ranks:
        raised = np.zeros_like(shares)
        raised[rank:] = shares[: len(shares) - rank]
        shares = (shares + raised) / 2
    return shares


def in_one_order(first: Any, second: Any) -> tuple[Any, Any]:
    """Both, the second in the order of the first's index where both have one (DataFrame or Series); else as given."""
    if not all(isinstance(table, pd.DataFrame | pd.Series) for table in (first, second)):
        return first, second
    check_same(first.index, second.index, "participants")
    return first, second.loc[first.index]


def check_same(first: pd.Index, second: pd.Index, words: str) -> None:
    """Refuse labels that stand in one of two tables alone, or twice in it."""
    unlike = first.symmetric_difference(second)
    if len(unlike) or first.has_duplicates or second.has_duplicates:
        double = next((index for index in (first, second) if index.has_duplicates), first)
        defect = (
            f"{unlike[0]!r} is in only one of the two"
            if len(unlike)
            else f"{double[double.duplicated()][0]!r} occurs twice"
        )
        raise ShapeError(
            f"both tables must have the same {words}, each once",
            defect,
            "Remove participants who are in one table only (write NaN for a missing number), and make "
            'the participant the index: table.set_index("participant").',
        )


def check_numbers(table: pd.DataFrame, words: str) -> None:
    """Refuse a column that holds no numbers."""
    for name, kind in table.dtypes.items():
        if not pd.api.types.is_numeric_dtype(kind) or pd.api.types.is_bool_dtype(kind):
            raise ShapeError(
                f"every column must be one of the {words} and contain numbers",
                f"column {name!r} contains other values ({kind})",
                'Remove this column. Participant names go into the index: table.set_index("participant").',
            )
