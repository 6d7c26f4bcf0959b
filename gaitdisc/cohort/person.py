"""A person: size, speed, style of walking, variability, and how the device is met; all drawn from one seed.

Others on request: children, slow and fast walkers, and gait patterns of the clinic, each with its hallmark. A pattern
is a change of the habit, and of strength where the clinic names a weak muscle; mechanics and static optimisation make
the rest. It is a caricature of the pattern's hallmark, not a model of the disease. Sizes of the changes are judgements;
what must come out of them is published (docs/cohort.md) and held by tests.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from gaitdisc.channel import check_word
from gaitdisc.recording.arrays import Values
from gaitdisc.recording.trial import LEG_OF_STATURE

STIFFNESS = 5.0  # N m/deg, Ebers (2023), section 4.2.1
SHANK_KG, FOOT_KG = 0.6, 0.4  # worn in both conditions; general knowledge of such devices


@dataclass(frozen=True)
class Spring:
    """A spring that resists dorsiflexion beyond the angle where it engages.

    >>> Spring(5.0).moment(np.array([-3.0, 4.0]), engaged_deg=-1.0).tolist()
    [-0.0, -25.0]
    """

    stiffness: float = STIFFNESS  # [N m/deg]; 0 is the device without its spring, the Nominal condition

    def moment(self, ankle_deg: Values, engaged_deg: float) -> Values:
        """Moment on the ankle, towards dorsiflexion [N m].

        ankle_deg , any shape [deg]: dorsiflexion
        engaged_deg: dorsiflexion at which the person's spring engages [deg]
        """
        return -self.stiffness * np.maximum(0.0, ankle_deg - engaged_deg)


JOINTS = ("hip_flexion", "hip_adduction", "hip_rotation", "knee_angle", "ankle_angle")
MUSCLES = ("emg_ham", "emg_rf", "emg_vas", "emg_gas", "emg_sol", "emg_ta", "emg_gmed")
GROUPS = (*MUSCLES, "iliopsoas", "gluteus_maximus")  # the last two carry no electrode
SYNERGIES = 5  # loading, mid-stance, push-off, early swing, late swing (Ivanenko et al. 2004)
# how differently people use a muscle, logarithmic standard deviation: least in distal muscles of one joint, most in
# proximal ones and those of two joints (Winter and Yack 1987)
APART = (0.45, 0.35, 0.25, 0.22, 0.10, 0.15, 0.30, 0.30, 0.40)
PEAK = np.array([0.45, 0.22, 0.22, 0.45, 0.5, 0.45, 0.45, 0.5, 0.35])  # of activation in walking, for what rests
# effort that a muscle costs: more in those of two joints, which do at one of them what others have to undo
DEAR = np.array([2.0, 4.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0])
DEAR_APART = np.array([0.9, 0.4, 0.3, 0.15, 0.1, 0.1, 0.1, 0.3, 0.9])  # logarithmic standard deviation between people
HARMONICS = 4
STANCE, STANCE_SPREAD = 0.607, 0.012  # of adults 60 to 62 % (Perry); of the children 59 (Schwartz et al. 2008)
CADENCE, CADENCE_SPEED = 0.565, 0.429  # steps and speed, dimensionless, of Schwartz et al. (2008), Free


@dataclass(frozen=True)
class Bump:
    """A change of one joint's habit over part of the stride, as a raised cosine."""

    side: int  # leg, 0 the right one
    joint: int  # column of `JOINTS`
    centre: float  # share of the stride
    half_width: float  # share of the stride; wider than a stride is a constant
    degrees: float  # at the centre

    def at(self, phase: Values) -> Values:
        """Change at phases of the stride [deg]."""
        apart = np.abs(np.mod(phase - self.centre + 0.5, 1.0) - 0.5) / self.half_width
        shape = np.cos(0.5 * np.pi * np.minimum(apart, 1.0)) ** 2
        return self.degrees * (np.ones_like(shape) if self.half_width > 1.0 else shape)


@dataclass(frozen=True, eq=False)
class Style:
    """How a person's habit differs from the average one."""

    size: Values  # (joint,), factor on each curve
    offset_deg: Values  # (side, joint) [deg], constant shift of what is measured: where the markers sit
    wave_deg: Values  # (side, joint, harmonic, 2) [deg], cosine and sine of the first harmonics on top
    strength: Values  # (side, group), how strong each muscle group is, against others of that body mass
    recruitment: Recruitment  # how the muscles are habitually used
    bumps: tuple[Bump, ...] = ()  # changes of the habit that make a gait pattern of the clinic


@dataclass(frozen=True, eq=False)
class Recruitment:
    """How a person habitually uses the muscles, before what the moments demand."""

    delay: Values  # (side, synergy) [share of a stride], by which each synergy is late
    weight: Values  # (side, group, synergy), factor on each muscle's part in each synergy
    width: Values  # (group,), factor on how long the bursts last
    rest: Values  # (group,), excitation between bursts, of 1 at the largest effort
    # (group,), effort that each muscle costs in static optimisation, against others: what people share out differently
    dear: Values
    cocontraction: float  # factor on all habitual activity: what exceeds the demand is co-contraction


@dataclass(frozen=True, eq=False)
class Adaptation:
    """What a person learns on a spring of 5 N m/deg; in proportion on another."""

    relief: float  # share of the spring's moment that the commands allow for
    # (side, joint, harmonic, 2) [deg], change of the habit, cosine and sine of the first harmonics
    habit_deg: Values
    effort: Values  # (group,), relative change of each muscle's habitual excitation


@dataclass(frozen=True, eq=False)
class Person:
    """Somebody of the cohort.

    >>> person = draw_one("W01", seed=1, sex="f")
    >>> person.learnt is None, person.adapt_to(Spring()).learnt
    (True, Spring(stiffness=5.0))
    """

    name: str
    sex: str
    age_years: float
    height_m: float
    mass_kg: float
    speed_m_per_s: float
    stride_s: float
    engaged_deg: float  # dorsiflexion at which the device's spring engages [deg]
    style: Style = field(repr=False)
    adaptation: Adaptation = field(repr=False)
    # (side, joint, harmonic, 2) [deg], habit towards which the person wanders slowly, and back
    drift_deg: Values = field(repr=False)
    unrest: float = 1.0  # factor on all variability from stride to stride
    stance: float = STANCE  # share of the stride that a foot is loaded by more than 20 N
    change_s: float = float("inf")  # time of a change of gait on the device [s]; infinite for those who stay the same
    learnt: Spring | None = None  # spring that the commands are adapted to; None before any device
    # strength of soleus and gastrocnemius that the person's own commands do not know of; 1 is as they expect
    plantarflexors: float = 1.0
    foot_kg: float = 0.0  # mass on each foot that the commands do not know of [kg]

    def adapt_to(self, spring: Spring) -> Person:
        """Return the same person after practice with a spring."""
        return replace(self, learnt=spring)

    def unadapted(self) -> Person:
        """Return the same person, who never learns: commands, habit and effort stay what they were."""
        nothing = Adaptation(0.0, 0 * self.adaptation.habit_deg, 0 * self.adaptation.effort)
        return replace(self, adaptation=nothing)

    @property
    def dimensionless_speed(self) -> float:
        """Speed over the square root of gravity times leg length."""
        return self.speed_m_per_s / float(np.sqrt(9.81 * LEG_OF_STATURE * self.height_m))


def draw_one(name: str, seed: int, sex: str) -> Person:
    """Draw a person.

    Sizes follow the dissertation's twelve adults (1.69 +- 0.10 m, 66.5 +- 11.7 kg, 1.36 +- 0.11 m/s); cadence follows
    speed and leg length with the dimensionless cadence of Schwartz et al. (2008), as the square root of speed.

    >>> 1.4 < draw_one("W01", 7, "f").height_m < 1.9
    True
    """
    rng = np.random.default_rng([seed, 4])
    height = (1.63 if sex == "f" else 1.755) + 0.065 * _bounded_normal(rng)
    mass = (22.6 if sex == "f" else 23.8) * (1 + 0.09 * _bounded_normal(rng)) * height**2
    speed = 1.36 + 0.11 * _bounded_normal(rng)
    leg = LEG_OF_STATURE * height
    cadence = CADENCE * np.sqrt(speed / np.sqrt(9.81 * leg) / CADENCE_SPEED) * (1 + 0.02 * _bounded_normal(rng))
    return Person(
        name,
        sex,
        age_years=float(23.9 + 1.8 * _bounded_normal(rng)),
        height_m=float(height),
        mass_kg=float(mass),
        speed_m_per_s=float(speed),
        stride_s=float(2 / cadence * np.sqrt(leg / 9.81)),
        engaged_deg=float(-1.0 + 1.5 * _bounded_normal(rng)),
        style=_style(rng, np.random.default_rng([seed, 15])),
        adaptation=Adaptation(
            float(np.clip(0.40 + 0.15 * _bounded_normal(rng), 0.05, 0.95)),
            _waves(rng, 0.9, 0.3),
            np.clip(0.10 * rng.normal(size=len(GROUPS)), -0.25, 0.25),
        ),
        drift_deg=_waves(rng, 0.15, 0.06),
        unrest=float(np.clip(1 + 0.15 * _bounded_normal(rng), 0.7, 1.3)),
        stance=float(STANCE + STANCE_SPREAD * _bounded_normal(rng)),
    )


def _bounded_normal(rng: np.random.Generator) -> float:
    """Normal number, held within two standard deviations: a cohort of nondisabled people has no outliers."""
    return float(np.clip(rng.normal(), -2.0, 2.0))


def _style(rng: np.random.Generator, muscles: np.random.Generator) -> Style:
    common = rng.normal(size=len(JOINTS)) * (3.0, 1.2, 3.0, 2.0, 1.8)
    sides = rng.normal(size=(2, len(JOINTS))) * (0.8, 0.6, 1.2, 0.8, 0.8)
    groups = len(GROUPS)
    strength = np.exp(0.12 * muscles.normal(size=groups) + 0.04 * muscles.normal(size=(2, groups)))
    size = np.clip(1 + rng.normal(size=len(JOINTS)) * (0.03, 0.15, 0.15, 0.05, 0.08), 0.7, 1.3)
    return Style(size, common + sides, _waves(rng, 0.6, 0.3), strength, _recruitment(muscles))


def _recruitment(rng: np.random.Generator) -> Recruitment:
    apart = np.array(APART)[:, None]
    shape = (len(GROUPS), SYNERGIES)
    delay = np.clip(0.020 * rng.normal(size=SYNERGIES) + 0.006 * rng.normal(size=(2, SYNERGIES)), -0.05, 0.05)
    weight = np.exp(apart * (0.9 * rng.normal(size=shape) + 0.3 * rng.normal(size=(2, *shape))))
    width = np.clip(1 + 0.10 * rng.normal(size=len(GROUPS)), 0.75, 1.25)
    rest = PEAK * rng.uniform(0.02, 0.05, len(GROUPS))
    cocontraction = float(np.exp(0.25 * _bounded_normal(rng)))
    dear = DEAR * np.exp(DEAR_APART * rng.normal(size=len(GROUPS)))
    return Recruitment(delay, weight, width, rest, dear, cocontraction)


def _waves(rng: np.random.Generator, both: float, side: float) -> Values:
    """Harmonics that fall with their order, most of them common to both sides [deg]."""
    fall = 1.0 / np.arange(1.0, HARMONICS + 1)[:, None]
    shape = (len(JOINTS), HARMONICS, 2)
    scale = np.array([1.0, 0.5, 0.7, 1.2, 1.0])[:, None, None]
    common = both * rng.normal(size=shape)
    return np.stack([(common + side * rng.normal(size=shape)) * fall * scale for _ in range(2)])


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
# what differs from an adult: size, age, or the speed over that of an adult of the same dimensionless speed
SIZES: dict[str, dict[str, float]] = {
    "child": {"height_m": 1.26, "mass_kg": 26.0, "age_years": 8.0}, "slow": {"faster": 0.65}, "fast": {"faster": 1.35},
}  # fmt: skip
WEAK = "weak plantarflexor"
PEOPLE = (*SIZES, *PATTERNS, WEAK)
WEAKNESS = 0.6  # of soleus and gastrocnemius, which the person's own commands do not know of


def somebody(kind: str, seed: int = 1, sex: str = "f") -> Person:
    """Somebody of one of `PEOPLE`, drawn from a seed."""
    check_word(kind, PEOPLE, "the kind of person")
    person = draw_one(kind, seed, sex)
    if kind in SIZES:
        return _resize(person, **SIZES[kind])
    if kind == WEAK:
        return replace(person, plantarflexors=WEAKNESS)
    return walking_with(person, kind)


def walking_with(person: Person, pattern: str) -> Person:
    """Return the same person, who walks in one of `PATTERNS`."""
    check_word(pattern, PATTERNS, "the kind of person")
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


def _resize(person: Person, faster: float = 1.0, **size: float) -> Person:
    """A person of another size or speed, with the cadence that goes with both."""
    sized, speed = replace(person, **size), faster * person.dimensionless_speed
    leg = LEG_OF_STATURE * sized.height_m
    cadence = CADENCE * (speed / CADENCE_SPEED) ** 0.5
    return replace(
        sized, speed_m_per_s=speed * float((9.81 * leg) ** 0.5), stride_s=2 / cadence * float((leg / 9.81) ** 0.5)
    )
