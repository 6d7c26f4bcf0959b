"""Which controls a person is read beside: of the like age and speed where there are enough, and at this leg length."""

from bisect import bisect_right
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from operator import attrgetter

import numpy as np

from gaitdisc.clinic.clinical_reference import SPEED, PublishedGroup, ReferenceLeg
from gaitdisc.clinic.reference import FARTHEST, Sample
from gaitdisc.processing.leg_curves import BY_NAME, MOMENTS, POWERS, LegCurves
from gaitdisc.words import counted

GRAVITY = 9.81
FEWEST = 10  # people of a group
AGES = (7, 13, 18, 40, 65)  # first year of each class but the youngest
SPEEDS = (0.227, 0.363, 0.5, 0.636)  # between very slow, slow, free, fast, very fast (Schwartz et al. 2008)
# powers of the leg length that a value goes with where two people of different size walk alike (Hof 1996)
EXPONENTS = {
    "speed_m_per_s": 0.5, "cadence_per_min": -0.5, "stride_s": 0.5, "step_s": 0.5,
    "stride_m": 1.0, "step_m": 1.0, "width_m": 1.0,
}  # fmt: skip
CURVES = {MOMENTS: 1.0, POWERS: 0.5}  # of what is per kg of body mass
ADULT = 18  # years
Legs = tuple[ReferenceLeg, ...]
Number = Callable[[ReferenceLeg], float | None]
AGE: Number = attrgetter("age_years")


@dataclass(frozen=True, eq=False)
class LikeControls:
    """Controls that a person is read beside, at the person's leg length where it is known."""

    group: Legs  # of the like age and speed
    curves: Legs  # the group, or where the person's speed is none of theirs, those for times and distances
    values: Legs  # of the like age at any speed, for times and distances
    words: tuple[str, ...]  # who they are, and what could not be allowed for
    nearest: str  # in what those for curves are the nearest; empty where they are the entire reference


def like_controls(legs: Legs, person: Sequence[LegCurves], leg_m: float | None, age_years: int | None) -> LikeControls:
    """Controls of a condition for one person of a leg length [m] and age."""
    speed = mean_speed(person)
    of_age = _nearest(legs, AGES, age_years, AGE)
    of_both = _nearest(of_age, SPEEDS, _dimensionless(speed, leg_m), dimensionless_speed)
    by = [*(["age"] if of_age != legs else []), *(["speed"] if of_both != of_age else [])]
    why = "age and speed are unknown" if list_groups(legs) else f"fewer than {FEWEST} controls of similar age or speed"
    which = f", the group nearest in {' and '.join(by)}" if by else f", the entire reference ({why})"
    sentences = [f"Compared with {described(of_both)}{which}."]
    unknown = "the person" if leg_m is None else "some controls" if any(leg.leg_m is None for leg in legs) else ""
    group, values = of_both, of_age
    if leg_m is not None and not unknown:
        group, values = (tuple(at_leg_length(leg, leg_m) for leg in some) for some in (group, values))
    far = bool(speed_words(speed, group))
    if of_both != of_age:
        what = "Times, distances and curves" if far else "Times and distances"
        because = ", because this person's speed is outside the range of this group" if far else ""
        sentences.append(f"{what} are compared with controls of any speed{because}.")
    ages = [leg.age_years for leg in of_age if leg.age_years is not None]
    if age_years is not None and ages and not min(ages) <= age_years <= max(ages):
        whose = "adults" if min(ages) >= ADULT > age_years else "of another age"
        sentences.append(f"These controls are {whose}; at {age_years} years, deviations may be due to age.")
    sentences.append(
        f"No value is scaled to body size, because the leg length of {unknown} is unknown."
        if unknown
        else "Times, distances, moments and powers of the controls are scaled to this person's leg length (Hof 1996)."
    )
    nearest = " and ".join(by[:-1] if of_both != of_age and far else by)
    return LikeControls(group, values if far else group, values, (*sentences, *speed_words(speed, values)), nearest)


def speed_words(speed: float | None, legs: Legs) -> tuple[str, ...]:
    """What of a speed [m/s] that no control walks at is allowed for."""
    speeds = np.array([leg.values[SPEED] for leg in legs if SPEED in leg.values])
    if speed is None or not len(speeds) or speeds.min() <= speed <= speeds.max():
        return ()
    range_words = f"{speed:.2f} m/s is outside the controls' range, {speeds.min():.2f} to {speeds.max():.2f} m/s"
    if Sample(speeds, len({leg.person for leg in legs}), speeds).leverage(speed) <= FARTHEST:
        return (f"{range_words}. The limits are extrapolated to this speed by a line through the controls.",)
    return (f"{range_words}. This is too far for a correction: deviations may be due to the speed.",)


def like_published(
    groups: Sequence[PublishedGroup], legs: Sequence[LegCurves], leg_m: float | None
) -> tuple[PublishedGroup, str]:
    """Group of a published reference nearest in speed, the largest where the speed is not known; and which it is."""
    speed = _dimensionless(mean_speed(legs), leg_m)
    known = [group for group in groups if np.isfinite(group.speeds).all()] if speed is not None else []
    if speed is None or not known:
        group = max(groups, key=lambda group: group.people)
        return group, f"Compared with the largest group, “{group.name}” ({group.people} people): the speed is unknown."
    group = min(known, key=lambda group: max(group.speeds[0] - speed, speed - group.speeds[1], 0.0))
    low, high = group.speeds
    whose = f"{group.people} people, dimensionless speed {low:.2f} to {high:.2f}; this person's is {speed:.2f}"
    return group, f"Compared with the group “{group.name}”, the nearest in speed: {whose}."


def list_groups(legs: Legs) -> list[Legs]:
    """Groups of ten people or more, by age, and within it by speed; none where there is but one."""
    ages = list(_classes(legs, AGES, AGE).values()) or [legs]
    groups = {group: None for age in ages for group in (*_classes(age, SPEEDS, dimensionless_speed).values(), age)}
    return [group for group in groups if group != legs]


def dimensionless_speed(leg: ReferenceLeg) -> float | None:
    """Speed over the square root of gravity times leg length (Hof 1996); None where one of both is not known."""
    return _dimensionless(leg.values.get(SPEED), leg.leg_m)


def at_leg_length(leg: ReferenceLeg, leg_m: float) -> ReferenceLeg:
    """Control's leg as of somebody of another leg length who walks alike: equal dimensionless numbers (Hof 1996).

    >>> at_leg_length(ReferenceLeg(1, "l", 4, 60.0, {}, {"step_m": 0.6, "cadence_per_min": 110.0}, 0.9), 0.4).values
    {'step_m': 0.26666666666666666, 'cadence_per_min': 165.0}
    """
    if leg.leg_m is None:
        return leg
    ratio = leg_m / leg.leg_m
    values = {name: float(value * ratio ** EXPONENTS.get(name, 0.0)) for name, value in leg.values.items()}
    curves = {name: curve * ratio ** CURVES.get(BY_NAME[name].kind, 0.0) for name, curve in leg.curves.items()}
    return replace(leg, values=values, curves=curves, leg_m=leg_m)


def described(legs: Legs) -> str:
    """How many controls, of which ages and speeds."""
    ages = [leg.age_years for leg in legs if leg.age_years is not None]
    speeds = [speed for leg in legs if (speed := dimensionless_speed(leg)) is not None]
    words = [counted(len({leg.person for leg in legs}), "control")]
    words += [f"aged {min(ages)} to {max(ages)} years"] if ages else []
    words += [f"dimensionless speed {min(speeds):.2f} to {max(speeds):.2f}"] if speeds else []
    return ", ".join(words)


def mean_speed(legs: Sequence[LegCurves]) -> float | None:
    """Speed [m/s] over the legs of a person; None where it is not known."""
    speeds = [float(leg.values[SPEED].mean()) for leg in legs if SPEED in leg.values]
    return float(np.mean(speeds)) if speeds else None


def _dimensionless(speed: float | None, leg_m: float | None) -> float | None:
    return speed / float(np.sqrt(GRAVITY * leg_m)) if speed is not None and leg_m else None


def _classes(legs: Legs, bounds: Sequence[float], number: Number) -> dict[int, Legs]:
    """Legs of each class that ten people or more are of; a person is of the class of the mean of both legs."""
    people: dict[int, list[float]] = {}
    for leg in legs:
        if (value := number(leg)) is not None:
            people.setdefault(leg.person, []).append(value)
    classes: dict[int, set[int]] = {}
    for person, values in people.items():
        classes.setdefault(bisect_right(bounds, float(np.mean(values))), set()).add(person)
    return {
        place: tuple(leg for leg in legs if leg.person in members)
        for place, members in sorted(classes.items())
        if len(members) >= FEWEST
    }


def _nearest(legs: Legs, bounds: Sequence[float], value: float | None, number: Number) -> Legs:
    """The class of a value, or the nearest; all legs where the value is not known or no class has enough people."""
    classes = _classes(legs, bounds, number) if value is not None else {}
    if value is None or not classes:
        return legs
    place = bisect_right(bounds, value)

    def away(other: int) -> tuple[bool, float]:
        numbers = [leg_value for leg in classes[other] if (leg_value := number(leg)) is not None]
        return other != place, max(min(numbers) - value, value - max(numbers))

    return classes[min(classes, key=away)]
