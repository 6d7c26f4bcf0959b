"""Markers in m or mm: what a file states is held against how far markers lie from the origin."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gaitdisc.errors import UnitError

METRES_AT_MOST = 15.0  # no laboratory's markers are farther from its origin, and no body is smaller than 10 cm
MILLIMETRES_AT_LEAST = 100.0


def distance_from_origin(places: NDArray[np.float64]) -> float:
    """How far markers lie out, as the 99th percentile of their coordinates; NaN without any.

    places (frame, coordinate): in the file's unit, NaN allowed; some thousand frames are looked at

    >>> distance_from_origin(np.array([[1.0, -2.0]]))
    1.99
    """
    some = places[:: max(len(places) // 1000, 1)]
    finite = np.abs(some[np.isfinite(some)])
    return float(np.quantile(finite, 0.99)) if finite.size else float("nan")


def refuse_other_unit(unit: str, far: float, file: str, where: str) -> None:
    """Refuse a unit that the distance from the origin contradicts.

    >>> refuse_other_unit("mm", 1500.0, "walk.trc", "Units in line 3")
    """
    if (unit == "m" and far >= MILLIMETRES_AT_LEAST) or (unit == "mm" and 0 < far <= METRES_AT_MOST):
        raise UnitError(
            f"markers in {unit} are {'less' if unit == 'm' else 'more'} than {METRES_AT_MOST:g} {unit} from the origin",
            f"those of {file} are {far:.4g} away, which looks like {'mm' if unit == 'm' else 'm'}",
            f"Correct {where} of the file.",
        )
