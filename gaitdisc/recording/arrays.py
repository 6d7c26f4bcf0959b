"""Read-only arrays: the nouns are frozen, and so are the numbers in them."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray


def read_only(values: ArrayLike, dtype: Any = float) -> NDArray[Any]:
    """View of an array that cannot be written through.

    Parameters
    ----------
    values : array_like, any shape
        Numbers; they are not copied where they already have the type.

    Examples
    --------
    >>> read_only([1, 2]).flags.writeable
    False
    """
    view = np.asarray(values, dtype).view()
    view.flags.writeable = False
    return view
