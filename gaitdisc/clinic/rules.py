"""What of a person's legs lies beyond the limits of the reference, by the rules of `rules.toml`; the farthest first."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from gaitdisc.clinic.reference import FEWEST, limits_of
from gaitdisc.errors import SchemaError
from gaitdisc.results.clinical_reference import Noted, ReferenceLeg
from gaitdisc.results.leg_curves import BY_NAME, LegCurves
from gaitdisc.results.pooled_cycles import SPATIOTEMPORAL

PARTS = ("contact", "loading", "stance", "late stance", "push-off", "swing", "mid swing", "cycle")
TAKES = {"min": np.min, "max": np.max, "mean": np.mean, "range": np.ptp}
LOADING, LATE, PUSH_OFF = (0, 20), 30, (50, 75)  # % of the cycle
SPATIOTEMPORAL_UNITS = {
    "m_per_s": ("m/s", 2),
    "percent": ("%", 1),
    "per_min": ("steps/min", 0),
    "s": ("s", 2),
    "m": ("m", 2),
}


@dataclass(frozen=True)
class Rule:
    """One number of a leg that may stand out."""

    name: str
    variable: str  # clinical variable; empty where it is a value
    value: str  # spatiotemporal value; empty where it is a variable
    part: str
    take: str
    least: float  # smallest distance to the reference's mean that is spoken of
    less: str  # what too small a number is called; empty where it is nothing
    more: str  # what too large a number is called; empty where it is nothing

    @property
    def unit(self) -> str:
        """Unit of the number."""
        return BY_NAME[self.variable].unit if self.variable else _of_value(self.value)[0]

    @property
    def digits(self) -> int:
        """Digits behind the point that the number is printed with."""
        return {"deg": 0}.get(self.unit, 1) if self.variable else _of_value(self.value)[1]

    def number(
        self, curves: Mapping[str, NDArray[np.float64]], values: Mapping[str, float], stance_percent: float
    ) -> float | None:
        """Number of a leg by its mean curves and spatiotemporal values; None where it cannot be taken."""
        if self.value:
            return values.get(self.value)
        if self.variable not in curves:
            return None
        part = part_of(self.part, stance_percent)
        if part is None or not np.isfinite(curves[self.variable][part]).all():
            return None
        return float(TAKES[self.take](curves[self.variable][part]))


def part_of(part: str, stance_percent: float) -> slice | None:
    """Points of a part of the cycle on 101 points; None where it hangs on a foot off that is not known.

    >>> part_of("swing", 60.0), part_of("mid swing", 61.0), part_of("stance", float("nan"))
    (slice(60, 101, None), slice(74, 88, None), None)
    """
    fixed = {"contact": (0, 0), "loading": LOADING, "push-off": PUSH_OFF, "cycle": (0, 100)}
    if part in fixed:
        first, last = fixed[part]
    elif not 30 < stance_percent < 90:
        return None
    else:
        off, swing = stance_percent, 100 - stance_percent
        first, last = {
            "stance": (0, round(off)),
            "late stance": (LATE, round(off)),
            "swing": (round(off), 100),
            "mid swing": (round(off + swing / 3), round(off + 2 * swing / 3)),
        }[part]
    return slice(first, last + 1)


@cache
def rules() -> tuple[Rule, ...]:
    """Every rule of `rules.toml`.

    >>> rules()[0].name
    'pelvic tilt'
    """
    path = Path(__file__).with_name("rules.toml")
    return rules_in(tomllib.loads(path.read_text(encoding="utf-8")))


def rule_words() -> list[str]:
    """Name of every rule, and what it calls too little and too much."""
    return [word for rule in rules() for word in (rule.name, rule.less, rule.more) if word]


def rules_in(data: Mapping[str, list[dict[str, object]]]) -> tuple[Rule, ...]:
    """Rules of a table, each checked."""
    found = []
    for entry in data["rules"]:
        words = {key: str(entry.get(key, "")) for key in ("name", "variable", "value", "part", "take", "less", "more")}
        least = entry.get("least")
        known = words["variable"] in BY_NAME and words["part"] in PARTS and words["take"] in TAKES
        said = words["name"] and (words["less"] or words["more"]) and known != (words["value"] in SPATIOTEMPORAL)
        if not said or not isinstance(least, float) or least <= 0:
            raise SchemaError(
                "a rule needs name, least > 0, less or more, and either variable, part and take or a spatiotemporal "
                "value",
                f"found {dict(entry)}",
                "Correct rules.toml.",
            )
        found.append(Rule(least=least, **words))
    names = [rule.name for rule in found]
    if len(set(names)) < len(names):
        raise SchemaError("each rule needs a name of its own", f"found {names}", "Rename one of them.")
    return tuple(found)


def _of_value(value: str) -> tuple[str, int]:
    return next(found for ending, found in SPATIOTEMPORAL_UNITS.items() if value.endswith(f"_{ending}"))


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
    numbers, found = [], []
    for rule, values in known:
        for leg in legs.values():
            curves = {name: leg.mean(name) for name in leg.cycles if name == rule.variable}
            own = {name: float(each.mean()) for name, each in leg.values.items() if name == rule.value}
            if (number := rule.number(curves, own, leg.stance_percent)) is not None:
                numbers.append((rule, values, leg, number))
    for rule, values, leg, number in numbers:
        limits = limits_of(*values, tests=len(numbers))
        shown, low, high = (round(one, rule.digits) for one in (number, limits.low, limits.high))
        beyond = rule.less if shown < low else rule.more if shown > high else ""  # as printed: 50 is not beyond 50
        words = beyond if abs(number - limits.mean) >= rule.least else ""
        count = len(leg.cycles[rule.variable]) if rule.variable else len(leg.values[rule.value])
        reach = limits.high - limits.mean
        excess = abs(number - limits.mean) / reach if reach > 0 else float("inf")
        found.append(Noted(rule.name, words, leg.side, number, rule.unit, rule.digits, limits, count, excess))
    return tuple(sorted(found, key=lambda one: (not one.words, -one.excess))), ""


def _of_reference(rule: Rule, reference: Sequence[ReferenceLeg]) -> tuple[np.ndarray, int] | None:
    """Numbers of the reference's legs and how many people these are; None below the fewest people."""
    found = [(leg.person, rule.number(leg.curves, leg.values, leg.stance_percent)) for leg in reference]
    known = [(person, number) for person, number in found if number is not None]
    people = len({person for person, _ in known})
    return (np.array([number for _, number in known]), people) if people >= FEWEST else None
