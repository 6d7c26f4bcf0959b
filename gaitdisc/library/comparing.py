"""Where two walks disagree over the stride; tests as tables, of pairs column by column, of curves over the stride."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike, NDArray

from gaitdisc.comparison.compare import compare_walks
from gaitdisc.comparison.compare_recordings import compare_files
from gaitdisc.comparison.mismatch import Smallest
from gaitdisc.errors import ShapeError
from gaitdisc.library.walks import Walk, make_trial
from gaitdisc.processing.walk_pair import walk_pair
from gaitdisc.recording.arrays import real_array
from gaitdisc.recording.recording import several
from gaitdisc.recording.strides import PERCENT
from gaitdisc.response.over_participants import compare_columns
from gaitdisc.statistics.cluster_test import PermutationPlan, one_sample_test, two_sample_test
from gaitdisc.statistics.holm_sidak import check_level
from gaitdisc.statistics.signed_rank import check_numbers, check_same, in_one_order

if TYPE_CHECKING:
    from gaitdisc.comparison.mismatch import Mismatch

POINTS = len(PERCENT)  # of a stride; as many rows of another length are a set on its side
COLUMNS = ("channel", "first_point", "last_point", "sign", "mass", "p")


def compare(
    first: Walk,
    second: Walk,
    channels: Sequence[str] | str = (),
    cutoff_hz: float = 6.0,
    detector: str = "auto",
    smallest_deg: float = 2.0,
    smallest_n_m_per_kg: float = 0.1,
) -> Mismatch:
    """Compare two walks over the stride: where they differ, by how much, and whether significantly.

    Both walks are filtered identically and cut at the same event of the stride. A permutation test over strides limits
    the probability of any false region in any channel to 5 %.

    Parameters
    ----------
    first, second : path, Trial, DataFrame or Recording
        A simulated and a measured walk, or two conditions; the gap is second minus first.
    channels : sequence of str, or str
        Channels to compare; by default all channels that both walks have.
    cutoff_hz : float
        Cut-off of the low-pass of angles and moments [Hz], at -3 dB of one pass.
    detector : str
        Detector of initial contact in both walks: `auto`, `force`, `events`, `markers` or `angles`.
    smallest_deg : float
        Smallest difference of an angle that is reported [deg].
    smallest_n_m_per_kg : float
        Smallest difference of a joint moment that is reported [N m/kg].

    Returns
    -------
    Mismatch
        Curves, the gap with its band, and the regions of the stride where it is significant.

    Raises
    ------
    GaitdiscError
        If a file cannot be read or is not a walk, or the two walks have no channels in common.

    References
    ----------
    Nichols and Holmes 2002; Pataky, Vanrenterghem and Robinson 2015.

    Examples
    --------
    >>> import gaitdisc as gd
    >>> walks = gd.example_walks(20.0)
    >>> found = gd.compare(walks["exo"], walks["nominal"], ["ankle_angle_r"])
    >>> found.names
    ('ankle_angle_r',)
    """
    smallest = Smallest(smallest_deg, smallest_n_m_per_kg)
    if isinstance(first, Path | str) and isinstance(second, Path | str):
        return compare_files(Path(first), Path(second), several(channels), cutoff_hz, detector, smallest)
    walks = walk_pair(make_trial(first), make_trial(second), cutoff_hz, detector)
    return compare_walks(walks[0], walks[1], several(channels), smallest=smallest)


def paired_tests(first: pd.DataFrame, second: pd.DataFrame, alpha: float = 0.05) -> pd.DataFrame:
    """Test each column of the second table against the first; both tables have one row per participant.

    The test is Wilcoxon's exact signed-rank test of the pairs, with a Holm-Sidak correction over the columns.

    Parameters
    ----------
    first, second : DataFrame (participant, variable)
        Tables with the same participants in the index and the same columns, in any order; NaN for a missing number.
    alpha : float
        Probability of at least one false positive over all columns.

    Returns
    -------
    DataFrame
        One row per variable: n, w, p, medians, Hodges-Lehmann `shift` (second minus first) with its 95 % CI `low`
        and `high`, `rank_biserial`, `p_adjusted`, `different`, and the participants left out. A variable with fewer
        than six participants is not tested and not counted.

    Raises
    ------
    ShapeError
        If the tables differ in participants or variables, a participant occurs twice, or a column is not numeric.

    References
    ----------
    Wilcoxon 1945; Holm 1979; Sidak 1967. Ebers 2023, section 4.2.3.

    Examples
    --------
    >>> import gaitdisc as gd, numpy as np, pandas as pd
    >>> people = [f"P{k:02}" for k in range(1, 9)]
    >>> before = pd.DataFrame({"knee": np.arange(8.0), "ankle": np.arange(8.0)}, index=people)
    >>> after = before + np.column_stack([np.arange(1.0, 9.0), [1, -2, 3, -4, 5, -6, 7, -8]])
    >>> found = gd.paired_tests(before, after).set_index("variable")
    >>> found["p"].round(3).tolist(), found["different"].tolist()
    ([0.008, 0.844], [True, False])
    """
    for table in (first, second):
        if not isinstance(table, pd.DataFrame):
            raise ShapeError(
                "paired tests need two DataFrames (participant, variable)",
                f"found {type(table).__name__}",
                "Use signed_rank for one variable. Convert a long table with table.pivot(...).",
            )
        check_numbers(table, "variables")
    check_same(first.index, second.index, "participants")
    check_same(first.columns, second.columns, "variables")
    return compare_columns(first, second.loc[first.index, first.columns], alpha)


def permutation_clusters(
    first: ArrayLike | pd.DataFrame,
    second: ArrayLike | pd.DataFrame,
    paired: bool = False,
    channels: Sequence[str] | str = (),
    alpha: float = 0.05,
    permutations: int = 2000,
    seed: int = 0,
) -> pd.DataFrame:
    """Find where two sets of curves differ, with a correction for all points and channels together.

    Parameters
    ----------
    first, second : array_like or DataFrame (unit, phase) or (unit, phase, channel)
        One row per person, stride or block of strides, without gaps: `strides.normalised(recording)`, or a DataFrame
        with one column per point of the stride.
    paired : bool
        Whether row k of both sets (in DataFrames: rows with the same index) belongs to one person; otherwise the sets
        are independent.
    channels : sequence of str, or str, optional
        Names of the channels; by default their numbers.
    alpha : float
        Probability of any false positive.
    permutations : int
        Maximum number of permutations; if fewer are possible, all are used.
    seed : int
        Seed of the random permutations.

    Returns
    -------
    DataFrame
        One row per cluster: channel, first_point and last_point (both included), sign of second minus first (1 where
        the second set lies above), mass, p; empty if nothing differs. `attrs` holds threshold, permutations and exact.

    Raises
    ------
    ShapeError
        If the curves do not match or a value is missing.
    ComparisonError
        If there are fewer than six units, or too few permutations for this alpha.

    References
    ----------
    Nichols and Holmes 2002; Pataky, Vanrenterghem and Robinson 2015.

    Examples
    --------
    >>> import gaitdisc as gd
    >>> curves = np.random.default_rng(0).normal(0.0, 1.0, (20, 101))
    >>> moved = curves + 3.0 * ((np.arange(101) >= 40) & (np.arange(101) < 60))
    >>> noise = np.random.default_rng(1).normal(0.0, 0.5, curves.shape)
    >>> gd.permutation_clusters(curves, moved + noise, paired=True)[["first_point", "last_point"]].values.tolist()
    [[40, 59]]
    """
    check_level(alpha, "alpha")
    if paired:
        first, second = in_one_order(first, second)
    x, y = _curves(first), _curves(second)
    names = several(channels) or tuple(range(x.shape[2]))
    if x.shape[1:] != y.shape[1:] or len(names) != x.shape[2] or (paired and len(x) != len(y)):
        raise ShapeError(
            "two sets of curves must have the same points and channels"
            + (", and the same number of rows for pairs" if paired else ""),
            f"the shapes (unit, phase, channel) are {x.shape} and {y.shape}, with {len(names)} names of channels",
            "Cut both into strides of 101 points with the same channels.",
        )
    plan = PermutationPlan(alpha, permutations, seed)
    test = one_sample_test(y - x, plan) if paired else two_sample_test(x, y, plan)
    rows = [(names[c.channel], c.first, c.last, c.sign, c.mass, c.p) for c in test.clusters]
    table = pd.DataFrame(rows, columns=pd.Index(COLUMNS))
    table.attrs.update(threshold=test.threshold, permutations=test.permutations, exact=test.exact)
    return table


def _curves(data: Any) -> NDArray[np.float64]:
    if isinstance(data, pd.DataFrame):
        check_numbers(data, "points of the stride")
        if pd.api.types.infer_dtype(data.columns) in ("mixed", "mixed-integer"):  # 0, 1, ..., 100, participant
            name = next(label for label in data.columns if isinstance(label, str))
            raise ShapeError(
                "every column must be a point of the stride",
                f"column {name!r} is not a number",
                f"Make this column the index: table.set_index({name!r}).",
            )
    values = real_array(data)
    if values.ndim not in (2, 3) or (len(values) == POINTS != values.shape[1]):
        raise ShapeError(
            "a set of curves must have shape (unit, phase) or (unit, phase, channel), with one row per person or "
            "stride",
            f"found {values.shape}",
            "Transpose it (array.T). For a long table use table.pivot(index=..., columns=..., values=...).",
        )
    return values[:, :, None] if values.ndim == 2 else values
