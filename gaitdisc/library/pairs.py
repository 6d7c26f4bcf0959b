"""Tests of pairs, a column of two tables each."""

from __future__ import annotations

import pandas as pd

from gaitdisc.errors import ShapeError
from gaitdisc.response.comparison import compare_columns
from gaitdisc.statistics.labels import check_numbers, check_same


def paired_tests(first: pd.DataFrame, second: pd.DataFrame, alpha: float = 0.05) -> pd.DataFrame:
    """Test each column of the second table against the first, one row a participant in both.

    Wilcoxon's signed-rank test, exact, of the pairs; Holm's step-down with Sidak's levels over the columns.

    Parameters
    ----------
    first, second : DataFrame (participant, variable)
        With the same participants in the index and the same columns, in any order; NaN where a number is missing.
    alpha : float
        Chance of one false alarm or more in all columns.

    Returns
    -------
    DataFrame
        One row a variable: n, w, p, medians, Hodges-Lehmann `shift` (second minus first) with its 95 % interval `low`
        and `high`, `rank_biserial`, `p_adjusted`, `different`, and who was left out. A variable that fewer than six
        participants have is not tested, and not counted among the tests.

    Raises
    ------
    ShapeError
        If the tables are of other participants or variables, a participant stands twice, or a column holds no numbers.

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
                "paired tests take two DataFrames (participant, variable)",
                f"found {type(table).__name__}",
                "Take signed_rank for one variable; bring a long table here with table.pivot(...).",
            )
        check_numbers(table, "variables")
    check_same(first.index, second.index, "participants")
    check_same(first.columns, second.columns, "variables")
    return compare_columns(first, second.loc[first.index, first.columns], alpha)
