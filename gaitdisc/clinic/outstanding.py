"""What of a person's legs lies beyond the limits of the reference, by the rules; the farthest first."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from gaitdisc.clinic.reference import FEWEST, limits_of
from gaitdisc.clinic.rules import Rule, rules
from gaitdisc.results.clinical_reading import Limits, Noted
from gaitdisc.results.clinical_reference import ReferenceLeg
from gaitdisc.results.leg_curves import LegCurves


def outstanding(
    legs: Mapping[str, LegCurves],
    reference: Sequence[ReferenceLeg],
    table: Sequence[Rule] | None = None,
    of_values: Sequence[ReferenceLeg] = (),
) -> tuple[tuple[Noted, ...], str]:
    """Every number that a rule takes of a person's legs, those that stand out first; and why there is none.

    table: those of `rules.toml` where none are given
    of_values: controls for spatiotemporal values, where they are others than those for curves
    """
    people = len({leg.person for leg in reference})
    if people < FEWEST:
        count = f"{people} people" if people != 1 else "1 person"
        return (), f"limits need a reference of {FEWEST} people or more; it has {count} who walked so"
    sets = [(rule, of_values or reference if rule.value else reference) for rule in table or rules()]
    known = [(rule, values) for rule, own in sets if (values := _of_reference(rule, own)) is not None]
    numbers = [
        (rule, values, leg, number)
        for rule, values in known
        for leg in legs.values()
        if (number := _of_leg(rule, leg)) is not None
    ]
    found = []
    for rule, values, leg, number in numbers:
        limits = limits_of(*values, tests=len(numbers))
        beyond = rule.less if number < limits.low else rule.more if number > limits.high else ""
        words = beyond if abs(number - limits.mean) >= rule.least else ""
        found.append(_noted(rule, words, leg, number, limits))
    return tuple(sorted(found, key=lambda one: (not one.words, -one.excess))), ""


def _of_leg(rule: Rule, leg: LegCurves) -> float | None:
    curves = {name: leg.mean(name) for name in leg.cycles if name == rule.variable}
    values = {name: float(each.mean()) for name, each in leg.values.items() if name == rule.value}
    return rule.number(curves, values, leg.stance_percent)


def _of_reference(rule: Rule, reference: Sequence[ReferenceLeg]) -> tuple[np.ndarray, int] | None:
    """Numbers of the reference's legs and how many people these are; None below the fewest people."""
    found = [(leg.person, rule.number(leg.curves, leg.values, leg.stance_percent)) for leg in reference]
    known = [(person, number) for person, number in found if number is not None]
    people = len({person for person, _ in known})
    return (np.array([number for _, number in known]), people) if people >= FEWEST else None


def _noted(rule: Rule, words: str, leg: LegCurves, number: float, limits: Limits) -> Noted:
    count = len(leg.cycles[rule.variable]) if rule.variable else len(leg.values[rule.value])
    reach = limits.high - limits.mean
    excess = abs(number - limits.mean) / reach if reach > 0 else float("inf")
    return Noted(rule.name, words, leg.side, number, rule.unit, rule.digits, limits, count, excess)
