"""Amounts as a person reads them: digits that the interval allows, degrees where the file has radians."""

from __future__ import annotations

import math
import re

from gaitdisc.results.discovery import Estimate

LONGEST, FIGURES = 4, 6  # digits behind the point, digits in all
MINUS = "\N{MINUS SIGN}"
_RAD = re.compile(r"^rad(?=$|/s)")


def shown_unit(unit: str) -> tuple[str, float]:
    """Return the unit in which a person reads a number, and the factor to it: degrees for an angle or its rates.

    >>> shown_unit("N m/rad"), shown_unit("rad/s")[0], round(shown_unit("rad")[1], 3)
    (('N m/rad', 1.0), 'deg/s', 57.296)
    """
    if _RAD.match(unit):
        return _RAD.sub("deg", unit), math.degrees(1.0)
    return ("" if unit == "1" else unit), 1.0


def amount(value: float, step: float = math.nan) -> str:
    """Write a number with three digits, or with those that a step of it leaves worth writing.

    >>> amount(0.0144), amount(285.9, 14), amount(2.003, 0.2), amount(-12345.6)
    ('0.0144', '286', '2.0', '−12346')
    """
    if not math.isfinite(value):
        return "not computed"
    size = step if math.isfinite(step) and step > 0 else abs(value) / 100 if value else 1.0
    digits = -math.floor(math.log10(size))
    if value and (abs(digits) > LONGEST):
        figures = max(1, min(math.floor(math.log10(abs(value))) + digits + 1, FIGURES))
        return f"{value:.{figures}g}".replace("-", MINUS)
    text = f"{value:.{max(digits, 0)}f}"
    return text.replace("-", MINUS)


def with_unit(value: str, unit: str) -> str:
    """Put a unit behind a number.

    >>> with_unit("286", "N m/rad"), with_unit("0.3", "")
    ('286 N m/rad', '0.3')
    """
    return f"{value} {unit}".strip()


def estimate_text(estimate: Estimate) -> str:
    """Write an estimate with its interval.

    >>> estimate_text(Estimate(286.0, 279.2, 292.8, "N m/rad"))
    '286 N m/rad (95 % 279-293)'
    >>> estimate_text(Estimate(-0.02, -0.03, -0.01, "rad"))
    '−1.1 deg (95 % −1.7 to −0.6)'
    """
    unit, factor = shown_unit(estimate.unit)
    value, low, high = (factor * one for one in (estimate.value, estimate.low, estimate.high))
    if not (math.isfinite(low) and math.isfinite(high)):
        return with_unit(amount(value), unit)
    step = (high - low) / 2
    between = "-" if low >= 0 else " to "
    return f"{with_unit(amount(value, step), unit)} (95 % {amount(low, step)}{between}{amount(high, step)})"


def brief_text(estimate: Estimate) -> str:
    """Write an estimate without its interval.

    >>> brief_text(Estimate(0.035, 0.033, 0.037, "rad"))
    '2.0 deg'
    """
    unit, factor = shown_unit(estimate.unit)
    return with_unit(amount(factor * estimate.value, factor * (estimate.high - estimate.low) / 2), unit)
