"""Units: one table and one parser; a recording may be in a closed list of them, and is converted once, at ingest.

Inside the package there is one unit for each dimension: deg for angles (rad enters only where dynamics are computed),
m, s, N, N m, V, W, kg, degC, and 1 for ratios (1/min for heart rate and cadence). A rate is the unit per second
(`deg/s`, `deg/s2`); a squared error has a squared unit. A simulation file may use any product of units with powers:
`N m s/rad`, `kg m^2`, `1/s^2`.
"""

import math
import re
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from gaitdisc.errors import UnitError

_BASES = ("kg", "m", "s", "rad", "V", "degC")
Dimension = tuple[float, ...]
Powers = dict[str, float]  # of the words of a unit


def _of(factor: float, **powers: float) -> tuple[float, Dimension]:
    return factor, tuple(float(powers.get(base, 0)) for base in _BASES)


_FACTORS = {
    "1": _of(1.0),
    "%": _of(0.01),
    "kg": _of(1.0, kg=1),
    "g": _of(1e-3, kg=1),
    "km": _of(1e3, m=1),
    "m": _of(1.0, m=1),
    "cm": _of(1e-2, m=1),
    "mm": _of(1e-3, m=1),
    "h": _of(3600.0, s=1),
    "min": _of(60.0, s=1),
    "s": _of(1.0, s=1),
    "ms": _of(1e-3, s=1),
    "Hz": _of(1.0, s=-1),
    "rad": _of(1.0, rad=1),
    "deg": _of(math.radians(1.0), rad=1),
    "N": _of(1.0, kg=1, m=1, s=-2),
    "kN": _of(1e3, kg=1, m=1, s=-2),
    "J": _of(1.0, kg=1, m=2, s=-2),
    "W": _of(1.0, kg=1, m=2, s=-3),
    "mW": _of(1e-3, kg=1, m=2, s=-3),
    "V": _of(1.0, V=1),
    "mV": _of(1e-3, V=1),
    "uV": _of(1e-6, V=1),
    "degC": _of(1.0, degC=1),
}
_PART = re.compile(r"([A-Za-z%]+|1)(?:\^?(-?\d{1,2}))?")

_CLOSED = {  # of a recording: the unit used inside, and what is converted to it
    "deg": ("rad",),
    "m": ("cm", "mm"),
    "s": ("ms",),
    "N": ("kN",),
    "N m": ("N mm", "N cm"),
    "V": ("mV", "uV"),
    "W": ("mW",),
    "kg": (),
    "N/kg": (),
    "N m/kg": ("N mm/kg",),
    "W/kg": (),
    "%": (),
    "1": (),
    "1/min": (),
    "degC": (),
}
_INNER = {unit: inner for inner, others in _CLOSED.items() for unit in (inner, *others)}
_SPELLINGS = {
    word: unit
    for unit, words in {
        "deg": "degree degrees °",
        "rad": "radian radians",
        "m": "meter meters metre metres",
        "mm": "millimeter millimeters",
        "N": "newton newtons nt",
        "N m": "nm n.m n*m n-m",
        "N mm": "nmm ntmm n.mm n*mm",
        "N cm": "ncm",
        "N m/kg": "nm/kg",
        "N mm/kg": "nmm/kg n.mm/kg",
        "V": "volt volts",
        "uV": "µv μv",
        "%": "percent",
        "degC": "°c celsius",
    }.items()
    for word in words.split()
}
_BY_LOWER_CASE = {unit.lower(): unit for unit in _INNER}


def list_units() -> tuple[str, ...]:
    """List the units that may appear in a file."""
    return tuple(_INNER)


def parse_unit(text: str) -> str | None:
    """Unit that a text means, or None where it means none of the closed list.

    >>> parse_unit("Nmm"), parse_unit("mV"), parse_unit("furlong")
    ('N mm', 'mV', None)
    """
    text = re.sub(r"\s+", " ", text.strip())
    if text in _INNER:
        return text
    return _SPELLINGS.get(text.lower(), _BY_LOWER_CASE.get(text.lower()))


def inner_unit(unit: str) -> str:
    """Unit that the package uses for what is measured in `unit`.

    >>> inner_unit("N mm")
    'N m'
    """
    if unit not in _INNER:
        raise UnitError(
            "a unit must be in the list of units", f"{unit!r} is not in the list", f"Use one of: {', '.join(_INNER)}."
        )
    return _INNER[unit]


def convert(values: NDArray[np.floating], unit: str, to: str) -> NDArray[np.floating]:
    """Same quantity in another unit.

    >>> float(convert(np.array(250.0), "mm", "m"))
    0.25
    """
    inner, inner_to = inner_unit(unit), inner_unit(to)
    if inner != inner_to:
        raise UnitError(
            f"{unit!r} must be convertible to {to!r}",
            f"{unit!r} is converted to {inner!r}, {to!r} to {inner_to!r}",
            "Correct the unit in the file or in the study.",
        )
    factor = unit_factor(unit, to) or math.nan  # the closed list is part of the table
    return values if factor == 1 else values * factor


def offset_words(*units: str) -> str:
    """Say why a temperature is not converted, as the end of a sentence, where one of the units is K or degF."""
    why = "; temperatures must be in degC: units are converted by a factor only, and K and degF also have "
    return f"{why}an offset" if {"K", "degK", "degF", "°F"}.intersection(units) else ""


def rate_unit(unit: str, order: int = 1) -> str:
    """Unit of a time derivative.

    >>> rate_unit("deg", 2), rate_unit("1", 1)
    ('deg/s2', '1/s')
    """
    return unit if order == 0 else f"{unit}/s{order if order > 1 else ''}"


def unit_factor(unit: str, to: str) -> float | None:
    """Factor from one unit to another.

    unit, to: products of base units with powers; what stands after a stroke divides
    returns: none where a unit is unknown; NaN where both are known and measure different things, or an offset apart

    >>> round(unit_factor("deg/s", "rad/s"), 6), unit_factor("N mm", "N m"), unit_factor("furlong", "m")
    (0.017453, 0.001, None)
    >>> unit_factor("N m", "W s")
    1.0
    """
    if "degC" in (unit, to) and offset_words(unit, to):
        return math.nan
    first, second = _measure(unit), _measure(to)
    if first is None or second is None:
        return None
    return first[0] / second[0] if first[1] == second[1] else math.nan


def _measure(unit: str | Powers) -> tuple[float, Dimension] | None:
    """Factor to the base units, and the power of each; none where a word is unknown."""
    factor, powers = 1.0, [0.0] * len(_BASES)
    for word, power in unit_words(unit) if isinstance(unit, str) else unit.items():
        if word not in _FACTORS:
            return None
        size, dimension = _FACTORS[word]
        factor *= size**power
        powers = [a + power * b for a, b in zip(powers, dimension, strict=True)]
    return factor, tuple(powers)


def unit_words(unit: str) -> Iterator[tuple[str, int]]:
    """Words of a unit, known or not, each with its power; an empty one where something is missing.

    >>> [*unit_words("N m s/rad^2")]
    [('N', 1), ('m', 1), ('s', 1), ('rad', -2)]
    """
    for number, group in enumerate(unit.strip()[:80].split("/")):
        for part in re.split(r"\s*[ .*·]\s*", group.strip("() ")):
            match = _PART.fullmatch(part)
            word, power = (match[1], int(match[2] or 1)) if match else (part, 1)
            yield word, power if number == 0 else -power


def find_dimension(unit: str | Powers) -> Dimension | None:
    """Powers of kg, m, s and V in a unit, an angle counting as a pure number; None where the unit is unknown.

    >>> find_dimension("N m s/rad") == find_dimension({"kg": 1, "m": 2, "s": -1})
    True
    """
    if (measured := _measure(unit)) is None:
        return None
    return tuple(power for base, power in zip(_BASES, measured[1], strict=True) if base != "rad")
