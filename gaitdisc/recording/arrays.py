"""Arrays: read-only ones, for the nouns are frozen and so are the numbers in them; means of those with gaps."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray


def read_only(values: ArrayLike, dtype: Any = float) -> NDArray[Any]:
    """View of an array that cannot be written through.

    values: numbers; they are not copied where they already have the type

    >>> read_only([1, 2]).flags.writeable
    False
    """
    view = np.asarray(values, dtype).view()
    view.flags.writeable = False
    return view


def mean_where_known(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Mean over the first axis of the values that are there; NaN where none is.

    >>> mean_where_known(np.array([[1.0, np.nan, np.nan], [3.0, 5.0, np.nan]])).tolist()
    [2.0, 5.0, nan]
    """
    known = np.isfinite(values)
    count = known.sum(axis=0)
    total = np.where(known, values, 0.0).sum(axis=0)
    return np.where(count > 0, total / np.maximum(count, 1), np.nan)
