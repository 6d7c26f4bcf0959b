"""Other people on request: children, slow and fast walkers, and gait patterns of the clinic, each with its hallmark.

A pattern is a change of the habit, and of strength where the clinic names a weak muscle; mechanics and static
optimisation make the rest. It is a caricature of the pattern's hallmark, not a model of the disease. Sizes of the
changes are judgements; what must come out of them is published (docs/cohort.md) and held by tests.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from gaitdisc.cohort.person import CADENCE, CADENCE_SPEED, GROUPS, JOINTS, Bump, Person, draw_one
from gaitdisc.errors import SchemaError
from gaitdisc.recording.trial import LEG_OF_STATURE

ALWAYS = 10.0  # half width of what lasts the whole stride
BOTH = (0, 1)


@dataclass(frozen=True)
class Pattern:
    """A way of walking."""

    # tuple of (joint, centre, half width, degrees), changes of the habit, in shares of the stride
    bumps: tuple[tuple[str, float, float, float], ...] = ()
    weak: tuple[tuple[str, float], ...] = ()  # tuple of (group, factor), strength of muscles
    sides: tuple[int, ...] = BOTH  # legs that it concerns, 0 for the right


PATTERNS = {
    "stiff knee": Pattern((("knee_angle", 0.74, 0.20, -26.0), ("hip_adduction", 0.78, 0.18, -4.0))),
    "drop foot": Pattern(
        (("ankle_angle", 0.86, 0.24, -16.0), ("hip_flexion", 0.84, 0.20, 7.0), ("knee_angle", 0.78, 0.20, 8.0)),
        (("emg_ta", 0.35),),
    ),
    "crouch": Pattern(
        (("knee_angle", 0.0, ALWAYS, 22.0), ("hip_flexion", 0.0, ALWAYS, 13.0), ("ankle_angle", 0.0, ALWAYS, 9.0))
    ),
    "asymmetric": Pattern((("knee_angle", 0.74, 0.20, -18.0), ("hip_flexion", 0.85, 0.25, -6.0)), (), (1,)),
}
# height [m], body mass [kg], age [years], speed over that of an adult of the same dimensionless speed
SIZES = {"child": (1.26, 26.0, 8.0, 1.0), "slow": (None, None, None, 0.65), "fast": (None, None, None, 1.35)}
WEAK = "weak plantarflexor"
PEOPLE = (*SIZES, *PATTERNS, WEAK)
WEAKNESS = 0.6  # of soleus and gastrocnemius, which the person's own commands do not know of


def somebody(kind: str, seed: int = 1, sex: str = "f") -> Person:
    """Somebody of one of `PEOPLE`, drawn from a seed."""
    person = draw_one(kind, seed, sex)
    if kind in SIZES:
        return _resize(person, kind)
    if kind == WEAK:
        return replace(person, plantarflexors=WEAKNESS)
    return walking_with(person, kind)


def walking_with(person: Person, pattern: str) -> Person:
    """Return the same person, who walks in one of `PATTERNS`."""
    if pattern not in PATTERNS:
        raise SchemaError(
            f"the kind of person must be one of {', '.join(PEOPLE)}", f"found {pattern!r}", "Use one of these."
        )
    chosen = PATTERNS[pattern]
    bumps = tuple(
        Bump(side, JOINTS.index(joint), centre, half_width, degrees)
        for side in chosen.sides
        for joint, centre, half_width, degrees in chosen.bumps
    )
    strength = person.style.strength.copy()
    for group, factor in chosen.weak:
        strength[list(chosen.sides), GROUPS.index(group)] *= factor
    return replace(person, style=replace(person.style, strength=strength, bumps=bumps))


def _resize(person: Person, kind: str) -> Person:
    """A person of another size or speed, with the cadence that goes with both."""
    height, mass, age, faster = SIZES[kind]
    height = height or person.height_m
    leg = LEG_OF_STATURE * height
    speed = faster * person.dimensionless_speed * float((9.81 * leg) ** 0.5)
    cadence = CADENCE * (faster * person.dimensionless_speed / CADENCE_SPEED) ** 0.5
    return replace(
        person,
        height_m=height,
        mass_kg=mass or person.mass_kg,
        age_years=age or person.age_years,
        speed_m_per_s=speed,
        stride_s=2 / cadence * float((leg / 9.81) ** 0.5),
    )
