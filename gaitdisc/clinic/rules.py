"""What of a person's legs stands out from the reference, in two tiers, by the rules of `rules.toml`."""

import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from gaitdisc.clinic.clinical_reference import FEW, SCORE_LEAST, SPEED, Limits, Noted, Profile, ReferenceLeg
from gaitdisc.clinic.reference import FEWEST, Sample, known_speeds, limits_about
from gaitdisc.errors import SchemaError
from gaitdisc.processing.leg_curves import BY_NAME, LegCurves
from gaitdisc.processing.pooled_cycles import SPATIOTEMPORAL

PARTS = ("contact", "loading", "mid stance", "stance", "late stance", "push-off", "swing", "mid swing", "cycle")
RULE_WORDS = ("name", "variable", "value", "part", "take", "less", "more", "group")
TAKES = {"min": np.min, "max": np.max, "mean": np.mean, "range": np.ptp}
LOADING, LATE, PUSH_OFF = (0, 20), 30, (50, 75)  # % of the cycle
SPATIOTEMPORAL_UNITS = {
    "m_per_s": ("m/s", 2),
    "percent": ("%", 1),
    "per_min": ("steps/min", 0),
    "s": ("s", 2),
    "m": ("m", 2),
    "deg": ("deg", 1),
}
SCORE = "gait profile score"
SCORE_WORDS = "gait profile score above that of the controls"


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
    group: str = ""  # rules of one group and direction say one thing; empty: of one variable

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
        part = find_part(self.part, stance_percent)
        if part is None or not np.isfinite(curves[self.variable][part]).all():
            return None
        return float(TAKES[self.take](curves[self.variable][part]))


def find_part(part: str, stance_percent: float) -> slice | None:
    """Points of a part of the cycle on 101 points; None where it hangs on a foot off that is not known.

    >>> find_part("swing", 60.0), find_part("mid swing", 61.0), find_part("stance", float("nan"))
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
            # middle third of single support, of legs that walk alike: from the other's off to its contact
            "mid stance": (round(off - 50 + swing / 3), round(off - 50 + 2 * swing / 3)),
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
    return rules_in(tomllib.loads(Path(__file__).with_name("rules.toml").read_text(encoding="utf-8")))


def rules_in(data: Mapping[str, list[dict[str, object]]]) -> tuple[Rule, ...]:
    """Rules of a table, each checked."""
    checked_rules = []
    for entry in data["rules"]:
        words = {key: str(entry.get(key, "")) for key in RULE_WORDS}
        least = entry.get("least")
        known = words["variable"] in BY_NAME and words["part"] in PARTS and words["take"] in TAKES
        complete = words["name"] and (words["less"] or words["more"]) and known != (words["value"] in SPATIOTEMPORAL)
        if not complete or not isinstance(least, float) or least <= 0:
            raise SchemaError(
                "a rule must have name, least (above 0), less or more, and either value or variable, part and take",
                f"found {dict(entry)}",
                "Correct rules.toml.",
            )
        checked_rules.append(Rule(least=least, **words))
    names = [rule.name for rule in checked_rules]
    if len(set(names)) < len(names):
        raise SchemaError("each rule must have its own name", f"the names are {names}", "Rename one rule.")
    return tuple(checked_rules)


def _of_value(value: str) -> tuple[str, int]:
    return next(unit for ending, unit in SPATIOTEMPORAL_UNITS.items() if value.endswith(f"_{ending}"))


def outstanding(
    legs: Mapping[str, LegCurves],
    reference: Sequence[ReferenceLeg],
    table: Sequence[Rule] | None = None,
    of_values: Sequence[ReferenceLeg] = (),
    profile: Profile | None = None,
) -> tuple[tuple[Noted, ...], str]:
    """Every number that a rule takes of a person's legs, those that stand out first; and why there is none.

    table: those of `rules.toml` where none are given
    of_values: controls for spatiotemporal values, where they are others than those for curves
    profile: its score is one number more
    """
    people = len({leg.person for leg in reference})
    if people < FEWEST:
        count = f"{people} people" if people != 1 else "1 person"
        return (), f"limits need a reference of at least {FEWEST} people; the reference has {count} in this condition"
    wide = of_values or reference
    known = [(rule, known_numbers(rule, wide if rule.value else reference)) for rule in table or rules()]
    samples = [(rule, sample) for rule, of_legs in known if (sample := sample_legs(of_legs)) is not None]
    numbers = []
    for rule, sample in samples:
        for leg in legs.values():
            curves = {name: leg.mean(name) for name in leg.cycles if name == rule.variable}
            values = {name: float(cycles.mean()) for name, cycles in leg.values.items() if name == rule.value}
            if (number := rule.number(curves, values, leg.stance_percent)) is not None:
                numbers.append((rule, sample, leg, number))
    two = [rule for rule, *_ in numbers if rule.value != SPEED]
    sides = [(rule, sample) for rule, pairs in known if two.count(rule) == 2 and (sample := sample_differences(pairs))]
    score = profile.both if profile is not None and profile.both and np.isfinite(profile.both.reference_sd) else None
    tests, notes = len(numbers) + len(sides) + (score is not None), []
    for rule, sample, leg, number in numbers:
        own_speed = float(leg.values[SPEED].mean()) if SPEED in leg.values and rule.value != SPEED else None
        count = len(leg.cycles[rule.variable]) if rule.variable else len(leg.values[rule.value])
        notes.append(_note(rule, leg.side, number, sample.limits(tests, own_speed), count))
    for rule, sample in sides:
        notes.append(_note_sides(rule, [note for note in notes if note.rule == rule.name], sample.limits(tests)))
    if score is not None:
        limits = limits_about(score.reference_mean, score.reference_sd, score.people, tests)
        rule = Rule(SCORE, "", value="profile_deg", part="", take="", least=SCORE_LEAST, less="", more=SCORE_WORDS)
        notes.append(_note(rule, "", score.value, limits, min(leg.count for leg in legs.values())))
    return tuple(sorted(notes, key=lambda note: (-note.tier, -note.excess))), ""


def _note(rule: Rule, side: str, number: float, limits: Limits, count: int) -> Noted:
    def beyond(low: float, high: float) -> bool:  # as printed: 50 is not beyond 50
        return not round(low, rule.digits) <= round(number, rule.digits) <= round(high, rule.digits)

    above = number > limits.mean
    words = rule.more if above else rule.less
    reach = limits.high - limits.mean
    excess = abs(number - limits.mean) / reach if reach > 0 else float("inf")
    spoken = words and count >= FEW and abs(number - limits.mean) >= rule.least
    tier = 2 if spoken and beyond(limits.low, limits.high) else 1 if spoken and beyond(*limits.band) else 0
    group = f"{rule.group or rule.variable or rule.value} {'more' if above else 'less'}"
    shown = (number, rule.unit, rule.digits, limits, count, excess, tier, group)
    return Noted(rule.name, words if tier else "", side, *shown)


def _note_sides(rule: Rule, both: Sequence[Noted], limits: Limits) -> Noted:
    """Leg farther from the reference less the other: beyond the limits, where that leg's own value is not."""
    near, far = sorted(both, key=lambda note: abs(note.value - note.limits.mean))
    note = _note(rule, far.side, far.value - near.value, limits, min(near.cycles, far.cycles))
    tier = 2 if note.tier == 2 > far.tier else 0
    # which of both is the unusual one is not said where neither is by itself
    words = (far.words or rule.name) if tier else ""
    return replace(note, words=words, tier=tier, other=near.side)


def known_numbers(rule: Rule, reference: Sequence[ReferenceLeg]) -> list[tuple[ReferenceLeg, float]]:
    """Legs of the reference that have the rule's number, each with it."""
    numbers = ((leg, rule.number(leg.curves, leg.values, leg.stance_percent)) for leg in reference)
    return [(leg, number) for leg, number in numbers if number is not None]


def sample_differences(known: Sequence[tuple[ReferenceLeg, float]]) -> Sample | None:
    """Differences of the sides of each control, both ways round; None below the fewest people."""
    people: dict[int, list[float]] = {}
    for leg, number in known:
        people.setdefault(leg.person, []).append(number)
    differences = np.array([pair[0] - pair[1] for pair in people.values() if len(pair) == 2])
    return Sample(np.concatenate([differences, -differences]), len(differences)) if len(differences) >= FEWEST else None


def sample_legs(known: Sequence[tuple[ReferenceLeg, float]]) -> Sample | None:
    """Numbers of the reference's legs, and their speeds where all are known; None below the fewest people."""
    people = len({leg.person for leg, _ in known})
    if people < FEWEST:
        return None
    return Sample(np.array([number for _, number in known]), people, known_speeds([leg for leg, _ in known]))
