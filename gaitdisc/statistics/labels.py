"""Rows and columns of two tables that belong together, by their labels."""

from __future__ import annotations

from typing import Any

import pandas as pd

from gaitdisc.errors import ShapeError


def in_one_order(first: Any, second: Any) -> tuple[Any, Any]:
    """Both, the second in the order of the first's index where both have one (DataFrame or Series); else as given."""
    if not all(isinstance(one, pd.DataFrame | pd.Series) for one in (first, second)):
        return first, second
    check_same(first.index, second.index, "participants")
    return first, second.loc[first.index]


def check_same(one: pd.Index, other: pd.Index, words: str) -> None:
    """Refuse labels that stand in one of two tables alone, or twice in it."""
    unlike = one.symmetric_difference(other)
    if len(unlike) or one.has_duplicates or other.has_duplicates:
        double = next((index for index in (one, other) if index.has_duplicates), one)
        found = (
            f"{unlike[0]!r} is in only one of the two"
            if len(unlike)
            else f"{double[double.duplicated()][0]!r} occurs twice"
        )
        raise ShapeError(
            f"both tables must have the same {words}, each once",
            found,
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
                'Remove it. Participant names go into the index: table.set_index("participant").',
            )
