"""An effect and its place as they are said."""

from __future__ import annotations

import math

from gaitdisc.results.amounts import shown_unit, with_unit
from gaitdisc.results.discovery import Estimate, FoundEffect


def spoken(name: str) -> str:
    """Return an effect's name as it is said.

    >>> spoken("one_sided_spring"), spoken("coulomb_friction")
    ('one-sided spring', 'Coulomb friction')
    """
    return name.replace("one_sided", "one-sided").replace("coulomb", "Coulomb").replace("_", " ")


def at_place(kind: str, place: str) -> str:
    """Say where something enters.

    >>> at_place("port", "ankle_moment"), at_place("equation", "v")
    ('at the ankle_moment port', 'in the equation of v')
    """
    if kind == "port":
        return f"at the {place} port"
    return f"in the {kind} {place}" if kind != "equation" else f"in the equation of {place}"


def outside_text(effect: FoundEffect, found: Estimate) -> str:
    """Say that a wrong parameter lies outside the bounds that the file gives it; nothing where it does not.

    >>> wrong = FoundEffect("parameter", "g", "wrong_parameter", "", bounds=(9.79, 9.83))
    >>> outside_text(wrong, Estimate(17.0, 14.0, 20.0, "m/s^2")), outside_text(wrong, Estimate(9.8, 9.7, 9.9, "m/s^2"))
    ('outside its bounds, 9.79 to 9.83 m/s^2', '')
    """
    if not effect.bounds or effect.bounds[0] <= found.value <= effect.bounds[1]:
        return ""
    unit, factor = shown_unit(found.unit)
    low, high = (f"{factor * one:.6g}" for one in effect.bounds)
    if not (math.isfinite(effect.bounds[0]) and math.isfinite(effect.bounds[1])):
        above = found.value > effect.bounds[1]
        return f"{'above' if above else 'below'} its bound, {with_unit(high if above else low, unit)}"
    return f"outside its bounds, {with_unit(f'{low} to {high}', unit)}"
