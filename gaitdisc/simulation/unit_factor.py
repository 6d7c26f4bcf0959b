"""Units that a simulation file may use: products of base units with powers, `N m s/rad`, `kg m^2`, `1/s^2`."""

from __future__ import annotations

import math
import re
from functools import cache

_BASES = ("kg", "m", "s", "rad", "V")
Dimension = tuple[float, ...]


def _of(factor: float, **powers: float) -> tuple[float, Dimension]:
    return factor, tuple(float(powers.get(base, 0)) for base in _BASES)


_UNITS = {
    "1": _of(1.0),
    "%": _of(0.01),
    "kg": _of(1.0, kg=1),
    "g": _of(1e-3, kg=1),
    "m": _of(1.0, m=1),
    "cm": _of(1e-2, m=1),
    "mm": _of(1e-3, m=1),
    "s": _of(1.0, s=1),
    "ms": _of(1e-3, s=1),
    "Hz": _of(1.0, s=-1),
    "rad": _of(1.0, rad=1),
    "deg": _of(math.radians(1.0), rad=1),
    "N": _of(1.0, kg=1, m=1, s=-2),
    "kN": _of(1e3, kg=1, m=1, s=-2),
    "J": _of(1.0, kg=1, m=2, s=-2),
    "W": _of(1.0, kg=1, m=2, s=-3),
    "V": _of(1.0, V=1),
    "mV": _of(1e-3, V=1),
    "uV": _of(1e-6, V=1),
}
_PART = re.compile(r"([A-Za-z%]+|1)(?:\^?(-?\d{1,2}))?\Z")


def unit_factor(unit: str, to: str) -> float | None:
    """Factor from one unit to another.

    unit, to: products of base units with powers; what stands after a stroke divides
    returns: none where a unit is unknown; NaN where both are known and measure different things

    >>> round(unit_factor("deg/s", "rad/s"), 6), unit_factor("N mm", "N m"), unit_factor("furlong", "m")
    (0.017453, 0.001, None)
    >>> unit_factor("N m", "W s")
    1.0
    """
    one, other = _parsed(unit), _parsed(to)
    if one is None or other is None:
        return None
    return one[0] / other[0] if one[1] == other[1] else math.nan


@cache
def _parsed(unit: str) -> tuple[float, Dimension] | None:
    """Factor to the base units, and the power of each."""
    factor, powers, sign = 1.0, [0.0] * len(_BASES), 1
    for number, group in enumerate(re.split(r"\s*/\s*", unit.strip()[:80])):
        sign = 1 if number == 0 else -1
        for part in re.split(r"\s*[ .*·]\s*", group.strip("() ")):
            found = _PART.match(part)
            if not found or found[1] not in _UNITS:
                return None
            power = sign * int(found[2] or 1)
            own, dimension = _UNITS[found[1]]
            factor *= own**power
            powers = [a + power * b for a, b in zip(powers, dimension, strict=True)]
    return factor, tuple(powers)


def dimension_of(unit: str) -> Dimension | None:
    """Powers of kg, m, s and V in a unit, an angle counting as a pure number; None where the unit is unknown.

    >>> dimension_of("N m s/rad") == dimension_of("kg m^2/s")
    True
    """
    found = _parsed(unit)
    return (
        None if found is None else tuple(power for base, power in zip(_BASES, found[1], strict=True) if base != "rad")
    )
