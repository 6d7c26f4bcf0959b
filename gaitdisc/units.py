"""A closed list of units; every number is converted once, at ingest.

Inside the package there is one unit for each dimension: deg for angles (rad enters only where dynamics are computed),
m, s, N, N m, V, W, kg, and 1 for ratios. A rate is the unit per second (`deg/s`, `deg/s2`); a squared error has a
squared unit.
"""

from __future__ import annotations

import math
import re

import numpy as np
from numpy.typing import NDArray

from gaitdisc.errors import UnitError

# unit -> (the one used inside, factor to it)
_UNITS: dict[str, tuple[str, float]] = {
    "deg": ("deg", 1.0),
    "rad": ("deg", math.degrees(1.0)),
    "m": ("m", 1.0),
    "cm": ("m", 1e-2),
    "mm": ("m", 1e-3),
    "s": ("s", 1.0),
    "ms": ("s", 1e-3),
    "N": ("N", 1.0),
    "kN": ("N", 1e3),
    "N m": ("N m", 1.0),
    "N mm": ("N m", 1e-3),
    "N cm": ("N m", 1e-2),
    "V": ("V", 1.0),
    "mV": ("V", 1e-3),
    "uV": ("V", 1e-6),
    "W": ("W", 1.0),
    "kg": ("kg", 1.0),
    "N/kg": ("N/kg", 1.0),
    "N m/kg": ("N m/kg", 1.0),
    "N mm/kg": ("N m/kg", 1e-3),
    "W/kg": ("W/kg", 1.0),
    "%": ("%", 1.0),
    "1": ("1", 1.0),
}

_SPELLINGS = {
    "degree": "deg",
    "degrees": "deg",
    "°": "deg",
    "radian": "rad",
    "radians": "rad",
    "meter": "m",
    "meters": "m",
    "metre": "m",
    "metres": "m",
    "millimeter": "mm",
    "millimeters": "mm",
    "newton": "N",
    "nt": "N",
    "newtons": "N",
    "nm": "N m",
    "n.m": "N m",
    "n*m": "N m",
    "n-m": "N m",
    "nmm": "N mm",
    "ntmm": "N mm",
    "n.mm": "N mm",
    "n*mm": "N mm",
    "ncm": "N cm",
    "nmm/kg": "N mm/kg",
    "n.mm/kg": "N mm/kg",
    "nm/kg": "N m/kg",
    "volt": "V",
    "volts": "V",
    "µv": "uV",
    "μv": "uV",
    "percent": "%",
    "": "",
}
_BY_LOWER_CASE = {unit.lower(): unit for unit in _UNITS}


def known_units() -> tuple[str, ...]:
    """List the units that may appear in a file."""
    return tuple(_UNITS)


def parsed_unit(text: str) -> str | None:
    """Unit that a text means, or None where it means none of the closed list.

    >>> parsed_unit("Nmm"), parsed_unit("mV"), parsed_unit("furlong")
    ('N mm', 'mV', None)
    """
    text = re.sub(r"\s+", " ", text.strip())
    if text in _UNITS:
        return text
    spelled = _SPELLINGS.get(text.lower(), _BY_LOWER_CASE.get(text.lower()))
    return spelled or None


def inner_unit(unit: str) -> str:
    """Unit that the package uses for what is measured in `unit`.

    >>> inner_unit("N mm")
    'N m'
    """
    return _known(unit)[0]


def convert(values: NDArray[np.floating], unit: str, to: str) -> NDArray[np.floating]:
    """Same quantity in another unit.

    values , any shape [unit]: numbers to convert
    returns , same shape [to]

    >>> float(convert(np.array(250.0), "mm", "m"))
    0.25
    """
    inner, factor = _known(unit)
    inner_to, factor_to = _known(to)
    if inner != inner_to:
        raise UnitError(
            f"a value in {unit!r} is to be given in {to!r}",
            f"{unit!r} is measured in {inner!r}, {to!r} in {inner_to!r}",
            "Correct the unit where the file or the study states it.",
        )
    if factor == factor_to:
        return values
    return values * (factor / factor_to)


def rate_unit(unit: str, order: int = 1) -> str:
    """Unit of a time derivative.

    >>> rate_unit("deg", 2), rate_unit("1", 1)
    ('deg/s2', '1/s')
    """
    if order == 0:
        return unit
    return f"{unit}/s" if order == 1 else f"{unit}/s{order}"


def _known(unit: str) -> tuple[str, float]:
    if unit not in _UNITS:
        raise UnitError(
            "a unit of the closed list is needed",
            f"{unit!r} is not in it",
            f"Use one of: {', '.join(_UNITS)}.",
        )
    return _UNITS[unit]
