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

from gaitdisc.cohort.body import GRAVITY, Leg, ankle_place, cycle_rate, joint_moments, leg_of
from gaitdisc.cohort.device import FOOT_KG, SHANK_KG, STIFFNESS, Spring
from gaitdisc.cohort.ground import STANCE, gate, habitual_force, pressure_centre
from gaitdisc.cohort.habit import activity, habitual
from gaitdisc.cohort.muscles import LEAST, LENGTHENING, MOST, Strength, cycle_activation, strength_of
from gaitdisc.cohort.person import HARMONICS, JOINTS, MUSCLES, Person

PHASES = 1000
LAG_S = 0.030  # of the actuators that no electrode sees
FIRM = (10.0, 3.0)  # weight of the speed of the foot over the belt, along and up, against the habit
HALF_WIDTH = 0.05  # of the pelvis between the hips, of height
HELD_EDGE = 0.4  # of half the stance
CORRECTED = 6  # harmonics of the correction
SMOOTH = 40  # harmonics of the commands
RELIEVED = (("emg_sol", 0.35), ("emg_gas", 0.12))  # shares of the moment that the spring takes over
GMED = MUSCLES.index("emg_gmed")


class Columns(NamedTuple):
    """Where in a leg's table each quantity begins.

    Parameters
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
    width : int
        Columns in all.
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
    side : int
        0 right, 1 left.
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
    force = habitual_force(phase, person.dimensionless_speed) * whole_kg * GRAVITY
    arm = _lever(leg, psi[:, 2], pressure_centre(phase, leg.sole_m))
    step_s = person.stride_s / PHASES
    hip = cycle_rate(hip_rate, step_s)
    moments = joint_moments(leg, psi, hip, np.hstack([force, arm]), step_s)
    expected = moments.copy()
    expected[:, 2] -= _relief(person, psi)
    excitation = _excitation(person, side, phase, strength, psi)
    activation = cycle_activation(excitation, step_s, 3)
    others = expected - _by_muscles(strength, activation, psi, step_s)
    others = _smoothed(others + LAG_S * cycle_rate(others, step_s))
    side_angles = np.radians(angles[:, 1:3])
    place = ankle_place(leg, psi)
    rows = [psi, _by_phase(psi), place, _by_phase(place), force, arm, gate(phase)[:, None], excitation, others]
    rows += [side_angles, _by_phase(side_angles), cycle_rate(side_angles, 1 / PHASES, 2)]
    table = np.hstack([*rows, activation[:, [GMED]], hip, hip_rate[:, :1]])
    return np.ascontiguousarray(np.vstack([table, table[:1]]))


def habit_angles(person: Person, side: int, phase: NDArray[np.float64], drifted: float = 0.0) -> NDArray[np.float64]:
    """Joint angles of a person's habit, before the belt has its say.

    Parameters
    ----------
    person : Person
        Style, and what was learnt on a spring.
    side : int
        0 right, 1 left.
    phase : ndarray (phase,) [share of a stride]
        0 at contact.
    drifted : float
        How far the habit has wandered [1].

    Returns
    -------
    ndarray (phase, joint) [deg]
        In the order of `JOINTS`; hip flexion is counted from the vertical.
    """
    speed, style = person.dimensionless_speed, person.style
    curves = np.column_stack([habitual(joint, speed).at(phase) for joint in JOINTS])
    curves[:, 0] -= habitual("pelvis_tilt", speed).at(phase)
    mean = curves.mean(axis=0)
    waves = style.wave_deg[side] + drifted * person.drift_deg[side]
    if person.learnt is not None:
        waves = waves + person.learnt.stiffness / STIFFNESS * person.adaptation.habit_deg[side]
    turn = 2 * np.pi * np.outer(phase, np.arange(1, HARMONICS + 1))
    own = np.cos(turn) @ waves[:, :, 0].T + np.sin(turn) @ waves[:, :, 1].T
    return mean + (curves - mean) * style.size + own


def thigh_shank_foot(angles: NDArray[np.float64]) -> NDArray[np.float64]:
    """Absolute angles of the segments from joint angles.

    Parameters
    ----------
    angles : ndarray (phase, joint) [deg]
        In the order of `JOINTS`.

    Returns
    -------
    ndarray (phase, 3) [rad]
    """
    thigh = angles[:, 0]
    shank = thigh - angles[:, 3]
    return np.radians(np.column_stack([thigh, shank, shank + angles[:, 4]]))


def hip_motion(person: Person, phase: NDArray[np.float64]) -> NDArray[np.float64]:
    """Velocity of a hip on the treadmill, along the habit.

    The body's centre moves as the ground forces of both feet accelerate it (2.8 cm up and down, 1.6 cm to and fro in a
    person of 1.62 m at 1.27 m/s); the pelvis turns and tilts about it.

    Parameters
    ----------
    person : Person
        Speed, stride time, size.
    phase : ndarray (phase,) [share of a stride]
        One whole cycle from the contact of the hip's own foot.

    Returns
    -------
    ndarray (phase, 2) [m/s]
        Forwards, upwards; means of zero.
    """
    force = habitual_force(phase, person.dimensionless_speed)
    both = GRAVITY * (force + np.roll(force, len(phase) // 2, axis=0))
    centre = _integrated(both, person.stride_s / len(phase))
    turns = [habitual(name, person.dimensionless_speed).at(phase) for name in ("pelvis_rotation", "pelvis_obliquity")]
    offset = HALF_WIDTH * person.height_m * np.sin(np.radians(np.column_stack(turns)))
    return centre + cycle_rate(offset, person.stride_s / len(phase))


def belt_held(person: Person, leg: Leg, psi: NDArray[np.float64], hip_rate: NDArray[np.float64]) -> NDArray[np.float64]:
    """Habit whose foot moves with the belt while it stands.

    The published curves, with the pelvis that the ground forces move, carry the foot at 0.93 to 1.1 of the belt's
    speed. The smallest smooth correction of thigh, shank and foot is added (least squares over `CORRECTED` harmonics,
    Gauss-Newton) with which the point under the pressure goes backwards at the belt's speed, and neither up nor down.

    Parameters
    ----------
    person : Person
        Speed and stride time.
    leg : Leg
        Lengths.
    psi : ndarray (phase, 3) [rad]
        One whole cycle.
    hip_rate : ndarray (phase, 2) [m/s]
        From `hip_motion`.

    Returns
    -------
    ndarray (phase, 3) [rad]
    """
    phase = np.arange(len(psi)) / len(psi)
    order = np.arange(1, CORRECTED + 1)
    turn = 2 * np.pi * np.outer(phase, order)
    waves = np.hstack([np.cos(turn), np.sin(turn)])
    slopes = 2 * np.pi * np.hstack([-order * np.sin(turn), order * np.cos(turn)])
    weight = _held_window(phase) / (person.speed_m_per_s * person.stride_s)
    reluctance = np.diag(np.tile(np.r_[order, order] ** 0.5, 3)) * np.sqrt(len(psi) / 2)
    pressure = pressure_centre(phase, leg.sole_m)
    wanted = -person.stride_s * (hip_rate + np.array([person.speed_m_per_s, 0.0]))
    moved, found = np.zeros(6 * CORRECTED), psi
    for _ in range(4):
        slip, rate, lever = (
            contact_path(leg, found, pressure) - wanted,
            _by_phase(found),
            _lever(leg, found[:, 2], pressure),
        )
        c, s = np.cos(found), np.sin(found)
        l1, l2 = leg.thigh_m, leg.shank_m
        along = [l1 * c[:, 0], l2 * c[:, 1], -lever[:, 1]], [l1 * s[:, 0], l2 * s[:, 1], lever[:, 0]]
        bend = [-l1 * s[:, 0], -l2 * s[:, 1], -lever[:, 0]], [l1 * c[:, 0], l2 * c[:, 1], -lever[:, 1]]
        left, right = [reluctance], [-reluctance @ moved]
        for axis, firm in enumerate(FIRM):
            pairs = zip(along[axis], (b * rate[:, j] for j, b in enumerate(bend[axis])), strict=True)
            gain = np.hstack([a[:, None] * slopes + b[:, None] * waves for a, b in pairs])
            left.append(firm * weight[:, None] * gain)
            right.append(-firm * weight * slip[:, axis])
        moved = moved + np.linalg.lstsq(np.vstack(left), np.concatenate(right), rcond=None)[0]
        found = psi + waves @ moved.reshape(3, -1).T
    return found


def contact_path(leg: Leg, psi: NDArray[np.float64], pressure: NDArray[np.float64]) -> NDArray[np.float64]:
    """Rate by phase of the foot's point under the pressure, from the hip.

    Parameters
    ----------
    leg : Leg
        Lengths.
    psi : ndarray (phase, 3) [rad]
        One whole cycle.
    pressure : ndarray (phase,) [m]
        Centre of pressure along the foot.

    Returns
    -------
    ndarray (phase, 2) [m]
        Forwards, upwards.
    """
    lever, turning = _lever(leg, psi[:, 2], pressure), _by_phase(psi)[:, 2:]
    return _by_phase(ankle_place(leg, psi)) + turning * lever[:, ::-1] * (-1.0, 1.0)


def engaged_moment(spring: Spring, person: Person, psi: NDArray[np.float64]) -> NDArray[np.float64]:
    """Moment of a spring on the ankle [N m].

    Parameters
    ----------
    spring : Spring
        Of the device.
    person : Person
        Whose fit says where it engages.
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


def _held_window(phase: NDArray[np.float64]) -> NDArray[np.float64]:
    """1 while the foot stands alone, falling to 0 at contact and at the toe's end: there a shoe gives and rolls."""
    share = (phase - 0.5 * STANCE) / (0.5 * STANCE)
    return np.clip((1.0 - np.abs(share)) / HELD_EDGE, 0.0, 1.0)


def _lever(leg: Leg, foot: NDArray[np.float64], pressure: NDArray[np.float64]) -> NDArray[np.float64]:
    """Point under the pressure, from the ankle, in the laboratory's directions [m]."""
    c, s = np.cos(foot), np.sin(foot)
    return np.column_stack([pressure * c + leg.ankle_m * s, pressure * s - leg.ankle_m * c])


def _by_phase(cycle: NDArray[np.float64]) -> NDArray[np.float64]:
    return cycle_rate(cycle, 1 / len(cycle))


def _integrated(cycle: NDArray[np.float64], step_s: float) -> NDArray[np.float64]:
    """Periodic integral without its mean."""
    spectrum = np.fft.rfft(cycle, axis=0)
    turns = 2j * np.pi * np.fft.rfftfreq(len(cycle), step_s)
    spectrum[1:] /= turns[1:, None]
    spectrum[0] = 0.0
    return np.fft.irfft(spectrum, len(cycle), axis=0)


def _smoothed(cycle: NDArray[np.float64]) -> NDArray[np.float64]:
    spectrum = np.fft.rfft(cycle, axis=0)
    spectrum[SMOOTH + 1 :] = 0.0
    return np.fft.irfft(spectrum, len(cycle), axis=0)
