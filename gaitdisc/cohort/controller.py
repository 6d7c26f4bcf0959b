"""What a leg has learnt: for every phase of the stride its habit, the load it expects, and the commands for both.

The commands are the exact inverse dynamics of the habit, not the outcome of practice: nine muscle groups share the
moments by static optimisation around the person's habitual activity (so that more than the demand is co-contraction),
and what they leave, because activation falls no faster than it does, is made up behind a lag. So without noise the body
follows its habit to within the integration's error, and whoever meets no spring has nothing to learn.
(Feedback-error learning does not get there: its orbit goes on changing, which then looks like a response.)
"""

from typing import NamedTuple

import numpy as np

from gaitdisc.cohort.body import GRAVITY, ankle_place, cycle_rate, joint_moments, make_leg
from gaitdisc.cohort.habit import activity
from gaitdisc.cohort.leg_path import (
    PHASES,
    belt_held,
    by_phase,
    gate,
    habit_angles,
    habitual_force,
    hip_motion,
    map_phase,
    pressure_centre,
    pressure_point,
    thigh_shank_foot,
)
from gaitdisc.cohort.muscles import MOST, capacities, cycle_activation, cycle_excitation, find_strength
from gaitdisc.cohort.person import FOOT_KG, GROUPS, SHANK_KG, STIFFNESS, Person, Recruitment, Spring
from gaitdisc.recording.arrays import Values

LAG_S = 0.030  # of what the muscles leave of the moments
SMOOTH = 40  # scale of the harmonics of what the muscles leave
TAPER = 28  # and of the activations
AT_REST = 1e-6  # excitation that is at rest but for rounding
GMED = GROUPS.index("emg_gmed")


class Columns(NamedTuple):
    """Where in a leg's table each quantity begins."""

    psi: int = 0  # thigh, shank, foot [rad]
    turning: int = 3  # their rate by phase [rad]
    place: int = 6  # ankle from the hip [m]
    path: int = 8  # its rate by phase [m]
    force: int = 10  # ground force [N]
    arm: int = 12  # its point from the ankle [m]
    gate: int = 14  # opening of the gate [1]
    excitation: int = 15  # muscle groups [1]
    others: int = 24  # what they leave of the moments [N m]
    side: int = 27  # adduction and rotation: angle, rate and second rate by phase, in turn [rad]
    gmed: int = 33  # habitual activation of gluteus medius [1]
    hip: int = 34  # acceleration of the hip [m/s2]
    sway: int = 36  # speed of the hip forwards [m/s]
    width: int = 37


COLUMNS = Columns()


def learnt_table(person: Person, side: int, drifted: float = 0.0) -> Values:
    """What one leg of a person has learnt.

    person: with the spring that the commands are adapted to, if any
    drifted: how far the habit has wandered along `drift_deg` [1]
    returns (phase, column): `PHASES` rows and the first once more; columns as in `COLUMNS`
    """
    phase = np.arange(PHASES) / PHASES
    leg = make_leg(person.height_m, person.mass_kg)
    angles = habit_angles(person, side, phase, drifted)
    hip_rate = hip_motion(person, phase)
    psi = belt_held(person, leg, thigh_shank_foot(angles), hip_rate)
    whole_kg = person.mass_kg + 2 * (SHANK_KG + FOOT_KG)
    stage = map_phase(person, phase)
    force = habitual_force(stage, person.dimensionless_speed) * whole_kg * GRAVITY
    arm = pressure_point(leg, psi[:, 2], pressure_centre(stage, leg.sole_m))
    step_s = person.stride_s / PHASES
    hip = cycle_rate(hip_rate, step_s)
    moments = joint_moments(leg, psi, hip, np.hstack([force, arm]), step_s)
    expected = moments.copy()
    if person.learnt is not None:  # the commands allow for a part of the spring's moment
        expected[:, 2] -= person.adaptation.relief * spring_moment(person.learnt, person, psi)
    strength = find_strength(person.mass_kg, person.style.strength[side])
    joint, joint_rate = _by_joint(psi), _by_joint(cycle_rate(psi, step_s))
    capacity = capacities(strength, joint, joint_rate)
    habit = habitual_activation(person, side, stage)
    recruitment = person.style.recruitment
    # where a muscle cannot let go in time, others act in the second pass
    rest = np.broadcast_to(recruitment.rest, habit.shape)
    excitation, activation = _nearest(share(expected, capacity, habit, rest, recruitment.dear), recruitment, step_s)
    least = np.where(excitation > rest + AT_REST, rest, activation)
    excitation, activation = _nearest(share(expected, capacity, habit, least, recruitment.dear), recruitment, step_s)
    others = expected - np.matmul(activation[:, None], capacity)[:, 0]
    others = _smooth(others + LAG_S * cycle_rate(others, step_s), SMOOTH)
    side_angles = np.radians(angles[:, 1:3])
    place = ankle_place(leg, psi)
    rows = [psi, by_phase(psi), place, by_phase(place), force, arm, gate(stage)[:, None], excitation, others]
    rows += [side_angles, by_phase(side_angles), cycle_rate(side_angles, 1 / PHASES, 2)]
    table = np.hstack([*rows, activation[:, [GMED]], hip, hip_rate[:, :1]])
    return np.ascontiguousarray(np.vstack([table, table[:1]]))


def spring_moment(spring: Spring, person: Person, psi: Values) -> Values:
    """Moment of a spring on the ankle [N m]; psi (phase, 3) [rad]: thigh, shank, foot."""
    return spring.moment(np.degrees(psi[:, 2] - psi[:, 1]), person.engaged_deg)


def habitual_activation(person: Person, side: int, phase: Values) -> Values:
    """Activation (phase, group) that a person's synergies give each muscle, before what the moments demand."""
    habit = person.style.recruitment
    bursts = [
        activity(name, phase, person.dimensionless_speed, habit.delay[side], habit.weight[side, group], width)
        for group, (name, width) in enumerate(zip(GROUPS, habit.width, strict=True))
    ]
    activation = habit.cocontraction * np.column_stack(bursts)
    if person.learnt is not None:
        activation = activation * (1 + person.learnt.stiffness / STIFFNESS * person.adaptation.effort)
    return np.minimum(habit.rest + activation, MOST)


def _nearest(activation: Values, recruitment: Recruitment, step_s: float) -> tuple[Values, Values]:
    """Excitation and activation that come nearest to an activation which need not be possible."""
    excitation = cycle_excitation(_smooth(activation, TAPER), recruitment.rest, step_s)
    return excitation, cycle_activation(excitation, step_s, 3)


def _by_joint(psi: Values) -> Values:
    return np.column_stack([psi[:, 0], psi[:, 0] - psi[:, 1], psi[:, 2] - psi[:, 1]])


def _smooth(cycle: Values, harmonics: int) -> Values:
    spectrum = np.fft.rfft(cycle, axis=0)
    spectrum *= np.exp(-((np.arange(len(spectrum)) / harmonics) ** 2))[:, None]
    return np.fft.irfft(spectrum, len(cycle), axis=0)


SOFTNESS = 1e-4  # of the squared strength of a typical joint: what is missing stays below a percent where it can
STEPS, HALVINGS = 60, 20
NEARLY = 1e-7  # of the largest moment


def share(moments: Values, capacity: Values, habit: Values, least: Values, dear: Values) -> Values:
    """Activations (phase, muscle) nearest to `habit` that give moments (phase, joint); `dear` is each muscle's cost.

    Static optimisation around a habit, for all phases of a stride at once. At every phase the activations a minimise
    dear |a - habit|^2 + |missing moment|^2 / softness  within their bounds, where the missing moment is what the
    muscles leave of the wanted one. The problem is convex with three multipliers m, one a joint: a = clip(habit +
    capacity m / dear), missing = softness m. Newton's method on the multipliers, all phases together, ends after a few
    steps, because the equations are linear between changes of the set of muscles that stand at a bound.
    """
    soft = SOFTNESS * float(np.mean(np.sum(capacity**2, axis=1)))
    small = NEARLY * (1.0 + np.abs(moments).max())
    multiplier, activation = np.zeros_like(moments), np.clip(habit, least, 1.0)
    unsolved = np.arange(len(moments))  # phases whose equations do not hold yet
    for _ in range(STEPS):
        task = moments[unsolved], capacity[unsolved], habit[unsolved], least[unsolved], dear, soft
        activation[unsolved], missing = _at(multiplier[unsolved], *task)
        keep = np.abs(missing).max(axis=1) > small
        unsolved, missing, task = unsolved[keep], missing[keep], (*(part[keep] for part in task[:4]), dear, soft)
        if not len(unsolved):
            break
        free = (activation[unsolved] > task[3]) & (activation[unsolved] < 1.0)
        slope = np.matmul((task[1] * (free / dear)[:, :, None]).transpose(0, 2, 1), task[1]) + soft * np.eye(3)
        multiplier[unsolved] += _step(
            np.linalg.solve(slope, missing[:, :, None])[:, :, 0], multiplier[unsolved], missing, task
        )
    return activation


def _step(step, multiplier, missing, task):
    """Newton's step, halved at every phase until the equations hold better."""
    size = np.sum(missing**2, axis=1)
    for _ in range(HALVINGS):
        worse = np.sum(_at(multiplier + step, *task)[1] ** 2, axis=1) > size
        if not worse.any():
            break
        step[worse] *= 0.5
    return step


def _at(multiplier, moments, capacity, habit, least, dear, soft):
    """Activations of the multipliers, and what is left of the equations."""
    activation = np.clip(habit + np.matmul(capacity, multiplier[:, :, None])[:, :, 0] / dear, least, 1.0)
    return activation, moments - np.matmul(activation[:, None], capacity)[:, 0] - soft * multiplier
