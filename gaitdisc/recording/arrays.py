"""Arrays and mappings: read-only ones, for the nouns are frozen and so is what they hold; means of those with gaps."""

from __future__ import annotations

import copyreg
from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gaitdisc.errors import ShapeError


def read_only(values: ArrayLike, dtype: Any = float) -> NDArray[Any]:
    """View of an array that cannot be written through.

    values: numbers; they are not copied where they already have the type

    >>> read_only([1, 2]).flags.writeable
    False
    """
    view = (real_array(values) if dtype is float else np.asarray(values, dtype)).view()
    view.flags.writeable = False
    return view


def real_array(values: Any) -> NDArray[np.float64]:
    """Array of floats; complex numbers are refused, of which numpy would keep the real part."""
    array = np.asarray(values)
    if array.dtype.kind == "c":
        raise ShapeError(
            "a recording holds real numbers",
            f"found complex ones, {array.shape} of them",
            "Give their magnitude or their real part: abs(x) or x.real.",
        )
    return np.asarray(array, float)


def frozen(mapping: Mapping[str, Any]) -> MappingProxyType[str, Any]:
    """View of a mapping that cannot be written through; it can be copied and sent to another process."""
    return MappingProxyType(dict(mapping))


# Python itself pickles no read-only view; with this line a Trial goes through `pickle`, `copy.deepcopy` and a pool
copyreg.pickle(MappingProxyType, lambda view: (frozen, (dict(view),)))


def mean_where_known(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Mean over the first axis of the values that are there; NaN where none is.

    >>> mean_where_known(np.array([[1.0, np.nan, np.nan], [3.0, 5.0, np.nan]])).tolist()
    [2.0, 5.0, nan]
    """
    known = np.isfinite(values)
    count = known.sum(axis=0)
    total = np.where(known, values, 0.0).sum(axis=0)
    return np.where(count > 0, total / np.maximum(count, 1), np.nan)
