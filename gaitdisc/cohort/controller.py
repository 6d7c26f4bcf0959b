"""What a leg has learnt: for every phase of the stride its habit, the load it expects, and the commands for both.

The commands are the exact inverse dynamics of the habit, not the outcome of practice: muscles take their habitual
excitation, and actuators that no electrode sees (iliopsoas, glutei, the rest) make up what is missing. So without noise
the body follows its habit to within the integration's error, and whoever meets no spring has nothing to learn.
(Feedback-error learning does not get there: its orbit goes on changing, which then looks like a response.)
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gaitdisc.cohort.body import GRAVITY, ankle_place, cycle_rate, joint_moments, leg_of
from gaitdisc.cohort.device import FOOT_KG, SHANK_KG, STIFFNESS, Spring
from gaitdisc.cohort.ground import gate, habitual_force, pressure_centre
from gaitdisc.cohort.habit import activity
from gaitdisc.cohort.leg_path import (
    PHASES,
    belt_held,
    by_phase,
    habit_angles,
    hip_motion,
    pressed_point,
    staged,
    thigh_shank_foot,
)
from gaitdisc.cohort.muscles import LEAST, LENGTHENING, MOST, Strength, cycle_activation, strength_of
from gaitdisc.cohort.person import MUSCLES, Person

LAG_S = 0.030  # of the actuators that no electrode sees
SMOOTH = 40  # harmonics of the commands
RELIEVED = (("emg_sol", 0.35), ("emg_gas", 0.12))  # shares of the moment that the spring takes over
GMED = MUSCLES.index("emg_gmed")


class Columns(NamedTuple):
    """Where in a leg's table each quantity begins.

    Attributes
    ----------
    psi, turning : int
        Thigh, shank, foot [rad], and their rate by phase [rad].
    place, path : int
        Ankle from the hip [m], and its rate by phase [m].
    force, arm, gate : int
        Ground force [N], its point from the ankle [m], opening of the gate [1].
    excitation, others : int
        Muscles [1], and the command of the other actuators [N m].
    side : int
        Adduction and rotation: angle, rate and second rate by phase, in turn [rad].
    gmed, hip, sway : int
        Habitual activation of gluteus medius [1], acceleration of the hip [m/s2], its speed forwards [m/s].
    """

    psi: int = 0
    turning: int = 3
    place: int = 6
    path: int = 8
    force: int = 10
    arm: int = 12
    gate: int = 14
    excitation: int = 15
    others: int = 22
    side: int = 25
    gmed: int = 31
    hip: int = 32
    sway: int = 34
    width: int = 35


COLUMNS = Columns()


def learnt_table(person: Person, side: int, drifted: float = 0.0) -> NDArray[np.float64]:
    """What one leg of a person has learnt.

    Parameters
    ----------
    person : Person
        With the spring that the commands are adapted to, if any.
    drifted : float
        How far the habit has wandered along `drift_deg` [1].

    Returns
    -------
    ndarray (phase, column)
        `PHASES` rows and the first once more; columns as in `COLUMNS`.
    """
    phase = np.arange(PHASES) / PHASES
    leg, strength = leg_of(person.height_m, person.mass_kg), strength_of(person.mass_kg)
    angles = habit_angles(person, side, phase, drifted)
    hip_rate = hip_motion(person, phase)
    psi = belt_held(person, leg, thigh_shank_foot(angles), hip_rate)
    whole_kg = person.mass_kg + 2 * (SHANK_KG + FOOT_KG)
    stage = staged(person, phase)
    force = habitual_force(stage, person.dimensionless_speed) * whole_kg * GRAVITY
    arm = pressed_point(leg, psi[:, 2], pressure_centre(stage, leg.sole_m))
    step_s = person.stride_s / PHASES
    hip = cycle_rate(hip_rate, step_s)
    moments = joint_moments(leg, psi, hip, np.hstack([force, arm]), step_s)
    expected = moments.copy()
    expected[:, 2] -= _relief(person, psi)
    excitation = _excitation(person, side, stage, strength, psi)
    activation = cycle_activation(excitation, step_s, 3)
    others = expected - _by_muscles(strength, activation, psi, step_s)
    others = _smoothed(others + LAG_S * cycle_rate(others, step_s))
    side_angles = np.radians(angles[:, 1:3])
    place = ankle_place(leg, psi)
    rows = [psi, by_phase(psi), place, by_phase(place), force, arm, gate(stage)[:, None], excitation, others]
    rows += [side_angles, by_phase(side_angles), cycle_rate(side_angles, 1 / PHASES, 2)]
    table = np.hstack([*rows, activation[:, [GMED]], hip, hip_rate[:, :1]])
    return np.ascontiguousarray(np.vstack([table, table[:1]]))


def engaged_moment(spring: Spring, person: Person, psi: NDArray[np.float64]) -> NDArray[np.float64]:
    """Moment of a spring on the ankle [N m].

    Parameters
    ----------
    psi : ndarray (phase, 3) [rad]
        Thigh, shank, foot.
    """
    return spring.moment(np.degrees(psi[:, 2] - psi[:, 1]), person.engaged_deg)


def _relief(person: Person, psi: NDArray[np.float64]) -> NDArray[np.float64]:
    """Part of the spring's moment that the commands allow for, towards dorsiflexion (so negative) [N m]."""
    if person.learnt is None:
        return np.zeros(len(psi))
    return person.adaptation.relief * engaged_moment(person.learnt, person, psi)


def _excitation(
    person: Person, side: int, phase: NDArray[np.float64], strength: Strength, psi: NDArray[np.float64]
) -> NDArray[np.float64]:
    own = np.column_stack([activity(name, phase, person.dimensionless_speed) for name in MUSCLES])
    own = own * person.style.strength[side]
    if person.learnt is not None:
        own = own * (1 + person.learnt.stiffness / STIFFNESS * person.adaptation.effort)
        spared = np.roll(-_relief(person, psi), -round(LAG_S / person.stride_s * PHASES))
        for name, share in RELIEVED:  # plantarflexion that need not be produced
            muscle = MUSCLES.index(name)
            own[:, muscle] += share * spared / strength.reach[muscle, 2]
    return np.clip(own, LEAST, MOST)


def _by_muscles(
    strength: Strength, activation: NDArray[np.float64], psi: NDArray[np.float64], step_s: float
) -> NDArray[np.float64]:
    rate = cycle_rate(psi, step_s)
    joint_rate = np.column_stack([rate[:, 0], rate[:, 0] - rate[:, 1], rate[:, 2] - rate[:, 1]])
    pull = -joint_rate @ np.sign(strength.reach).T
    return (activation * np.clip(1 + LENGTHENING * pull, 0.7, 1.3)) @ strength.reach


def _smoothed(cycle: NDArray[np.float64]) -> NDArray[np.float64]:
    spectrum = np.fft.rfft(cycle, axis=0)
    spectrum[SMOOTH + 1 :] = 0.0
    return np.fft.irfft(spectrum, len(cycle), axis=0)
