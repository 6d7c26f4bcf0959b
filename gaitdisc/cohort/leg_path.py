"""The path of a leg's habit over the stride, and the belt: what it does to a foot along that path, and how firmly.

The vertical force is mostly prescribed: it follows the habitual curve of `habit.csv`, as does the shear. What is
mechanical is what differs from the habit. A foot that is lower than usual is pushed up, one that the belt has carried
further or less far than the leg's habit is pulled along: it sticks to the belt, whose speed is constant, whatever the
phase does. All of this passes through a gate that is exactly zero in swing.
"""

from typing import NamedTuple

import numpy as np

from gaitdisc.cohort.body import GRAVITY, Leg, ankle_place, cycle_rate
from gaitdisc.cohort.habit import STANCE, Curve, habitual
from gaitdisc.cohort.person import HARMONICS, JOINTS, STIFFNESS, Person
from gaitdisc.recording.arrays import Values

# centre of pressure from the ankle, as a share of the foot's length, over the stance: from the heel's edge to the great
# toe, fast over the heel, slow under the forefoot (general knowledge), moved by up to 2 cm so that the moments of the
# calibration people come near the published ones
ROLLED = (0.0, 0.05, 0.12, 0.25, 0.40, 0.55, 0.70, 0.80, 0.90, 1.0)
PRESSURE = (-0.17, -0.14, -0.02, 0.085, 0.255, 0.405, 0.49, 0.515, 0.59, 0.62)
# half waves over the stance that are added to the published shear [body weight], for the same reason
SHEAR = (0.002, -0.005, -0.002, 0.001)
RISE, FALL = 0.10, 0.16  # shares of the stance over which the gate opens and closes


class Belt(NamedTuple):
    """How firmly the belt holds a foot."""

    along: float = 6000.0  # stiffness [N/m]
    up: float = 12000.0  # stiffness [N/m]
    turn: float = 120.0  # stiffness [N m/rad]
    along_damping: float = 180.0  # [N s/m]
    up_damping: float = 360.0  # [N s/m]
    turn_damping: float = 3.0  # [N m s/rad]


def gate(phase: Values) -> Values:
    """How much of a foot is on the belt by share of the stride since contact: 0 in swing, 1 in mid-stance.

    >>> gate(np.array([0.0, 0.3, 0.7])).tolist()
    [0.0, 1.0, 0.0]
    """
    share = np.mod(phase, 1.0) / STANCE
    opening = np.sin(0.5 * np.pi * np.clip(share / RISE, 0.0, 1.0)) ** 2
    closing = np.sin(0.5 * np.pi * np.clip((1.0 - share) / FALL, 0.0, 1.0)) ** 2
    return np.where(share < 1.0, opening * closing, 0.0)


def habitual_force(phase: Values, speed: float) -> Values:
    """Ground force along the habit, of body weight 1.

    Over a stride both feet carry the body's weight and push as much as they brake, as steady walking demands; the
    published curves are scaled and shifted by a few percent for it.

    phase (phase,) [share of a stride]: one whole cycle, evenly spaced, without its end
    speed: dimensionless speed [1]
    returns (phase, 2) [body weight]: forwards, upwards
    """
    up = np.maximum(0.0, habitual("ground_vy", speed).at(phase))
    up = up * 0.5 / up.mean()
    along = habitual("ground_vx", speed).at(phase) + Curve("stance sine", 0.0, SHEAR).at(phase)
    along = along - up * along.mean() / up.mean()
    return np.column_stack([along, up])


def pressure_centre(phase: Values, sole_m: float) -> Values:
    """Centre of pressure along the foot from the ankle [m], by share of the stride; in swing it means nothing."""
    from scipy.interpolate import PchipInterpolator

    share = np.mod(phase, 1.0) / STANCE
    rolled = PchipInterpolator(ROLLED, PRESSURE)(np.minimum(share, 1.0))
    back = np.clip((share - 1.0) / (1.0 / STANCE - 1.0), 0.0, 1.0)
    return sole_m * (rolled + (PRESSURE[0] - PRESSURE[-1]) * np.sin(0.5 * np.pi * back) ** 2)


PHASES = 1000
LOADED_SHARE = 0.596  # of the stride: where the habitual vertical force of a typical adult falls below 20 N
FIRM = (10.0, 1.0)  # weight of the speed of the foot over the belt, along and up, against the habit
HALF_WIDTH = 0.05  # of the pelvis between the hips, of height
HELD_EDGE = 0.4  # of half the stance
CORRECTED = 6  # harmonics of the correction
RELUCTANCE = 1.5  # power of a harmonic's order that makes it dear: swing needs no moments for the belt's sake
# added to the published hip and knee flexion: with their legs' lean the moments come near the published ones [deg]
LEAN_DEG = {0: 0.6, 3: -0.7}


def map_phase(person: Person, phase: Values) -> Values:
    """Phase of the published curves at a phase of the person's own stride.

    Contact stays contact; the middle of the stride comes later, by as much as puts the end of the stance where the
    person has it: stage = phase - delay (1 - cos(2 pi phase)) / 2.

    phase , any shape [share of a stride]: 0 at contact

    >>> from gaitdisc.cohort.person import draw_one
    >>> person = draw_one("W01", 1, "f")
    >>> round(float(map_phase(person, np.array([person.stance]))[0]), 3) == LOADED_SHARE
    True
    """
    delay = 2 * (person.stance - LOADED_SHARE) / (1 - np.cos(2 * np.pi * person.stance))
    return phase - 0.5 * delay * (1 - np.cos(2 * np.pi * phase))


def habit_angles(person: Person, side: int, phase: Values, drifted: float = 0.0) -> Values:
    """Joint angles of a person's habit, before the belt has its say.

    phase (phase,) [share of a stride]: 0 at contact; the curves follow the person's own stance (`map_phase`)
    drifted: how far the habit has wandered [1]
    returns (phase, joint) [deg]: in the order of `JOINTS`; hip flexion is counted from the vertical
    """
    speed, style, phase = person.dimensionless_speed, person.style, map_phase(person, phase)
    curves = np.column_stack([habitual(joint, speed).at(phase) for joint in JOINTS])
    curves[:, 0] -= habitual("pelvis_tilt", speed).at(phase)
    for joint, lean in LEAN_DEG.items():
        curves[:, joint] += lean
    mean = curves.mean(axis=0)
    waves = style.wave_deg[side] + drifted * person.drift_deg[side]
    if person.learnt is not None:
        waves = waves + person.learnt.stiffness / STIFFNESS * person.adaptation.habit_deg[side]
    turn = 2 * np.pi * np.outer(phase, np.arange(1, HARMONICS + 1))
    deviation = np.cos(turn) @ waves[:, :, 0].T + np.sin(turn) @ waves[:, :, 1].T
    for bump in (bump for bump in style.bumps if bump.side == side):
        deviation[:, bump.joint] += bump.at(phase)
    return mean + (curves - mean) * style.size + deviation


def thigh_shank_foot(angles: Values) -> Values:
    """Absolute angles of the segments (phase, 3) [rad] from angles (phase, joint) [deg] in the order of `JOINTS`."""
    thigh = angles[:, 0]
    shank = thigh - angles[:, 3]
    return np.radians(np.column_stack([thigh, shank, shank + angles[:, 4]]))


def hip_motion(person: Person, phase: Values) -> Values:
    """Velocity of a hip on the treadmill, along the habit.

    The body's centre moves as the ground forces of both feet accelerate it (2.8 cm up and down, 1.6 cm to and fro in a
    person of 1.62 m at 1.27 m/s); the pelvis turns and tilts about it.

    phase (phase,) [share of a stride]: one whole cycle from the contact of the hip's own foot
    returns (phase, 2) [m/s]: forwards, upwards; means of zero
    """
    phase = map_phase(person, phase)
    force = habitual_force(phase, person.dimensionless_speed)
    both = GRAVITY * (force + np.roll(force, len(phase) // 2, axis=0))
    spectrum = np.fft.rfft(both, axis=0)  # its periodic integral, without the mean
    spectrum[1:] /= 2j * np.pi * np.fft.rfftfreq(len(both), person.stride_s / len(phase))[1:, None]
    spectrum[0] = 0.0
    centre = np.fft.irfft(spectrum, len(both), axis=0)
    turns = [habitual(name, person.dimensionless_speed).at(phase) for name in ("pelvis_rotation", "pelvis_obliquity")]
    offset = HALF_WIDTH * person.height_m * np.sin(np.radians(np.column_stack(turns)))
    return centre + cycle_rate(offset, person.stride_s / len(phase))


def belt_held(person: Person, leg: Leg, psi: Values, hip_rate: Values) -> Values:
    """Habit whose foot moves with the belt while it stands.

    The published curves, with the pelvis that the ground forces move, carry the foot at 0.93 to 1.1 of the belt's
    speed. The smallest smooth correction of thigh, shank and foot is added (least squares over `CORRECTED` harmonics,
    Gauss-Newton) with which the point under the pressure goes backwards at the belt's speed, and neither up nor down.

    psi (phase, 3) [rad]: one whole cycle
    hip_rate (phase, 2) [m/s]: from `hip_motion`
    returns (phase, 3) [rad]
    """
    phase = np.arange(len(psi)) / len(psi)
    order = np.arange(1, CORRECTED + 1)
    turn = 2 * np.pi * np.outer(phase, order)
    waves = np.hstack([np.cos(turn), np.sin(turn)])
    slopes = 2 * np.pi * np.hstack([-order * np.sin(turn), order * np.cos(turn)])
    stage = map_phase(person, phase)
    # 1 while the foot stands alone, falling to 0 at contact and at the toe's end: there a shoe gives and rolls
    share = (stage - 0.5 * STANCE) / (0.5 * STANCE)
    weight = np.clip((1.0 - np.abs(share)) / HELD_EDGE, 0.0, 1.0) / (person.speed_m_per_s * person.stride_s)
    reluctance = np.tile(np.r_[order, order] ** (2 * RELUCTANCE), 3) * len(psi) / 2
    pressure = pressure_centre(stage, leg.sole_m)
    target = -person.stride_s * (hip_rate + np.array([person.speed_m_per_s, 0.0]))
    moved, angles = np.zeros(6 * CORRECTED), psi
    for _ in range(4):
        slip, rate = contact_path(leg, angles, pressure) - target, by_phase(angles)
        lever = pressure_point(leg, angles[:, 2], pressure)
        c, s = np.cos(angles), np.sin(angles)
        l1, l2 = leg.thigh_m, leg.shank_m
        along = [l1 * c[:, 0], l2 * c[:, 1], -lever[:, 1]], [l1 * s[:, 0], l2 * s[:, 1], lever[:, 0]]
        bend = [-l1 * s[:, 0], -l2 * s[:, 1], -lever[:, 0]], [l1 * c[:, 0], l2 * c[:, 1], -lever[:, 1]]
        left, right = np.diag(reluctance), -reluctance * moved
        for axis, firm in enumerate(FIRM):
            pairs = zip(along[axis], (b * rate[:, j] for j, b in enumerate(bend[axis])), strict=True)
            gain = np.hstack([a[:, None] * slopes + b[:, None] * waves for a, b in pairs]) * (firm * weight)[:, None]
            left += gain.T @ gain
            right -= gain.T @ (firm * weight * slip[:, axis])
        moved = moved + np.linalg.solve(left, right)  # normal equations: the reluctance keeps them well conditioned
        angles = psi + waves @ moved.reshape(3, -1).T
    return angles


def contact_path(leg: Leg, psi: Values, pressure: Values) -> Values:
    """Rate by phase of the foot's point under the pressure, from the hip.

    psi (phase, 3) [rad]: one whole cycle
    pressure (phase,) [m]: centre of pressure along the foot
    returns (phase, 2) [m]: forwards, upwards
    """
    lever, turning = pressure_point(leg, psi[:, 2], pressure), by_phase(psi)[:, 2:]
    return by_phase(ankle_place(leg, psi)) + turning * lever[:, ::-1] * (-1.0, 1.0)


def pressure_point(leg: Leg, foot: Values, pressure: Values) -> Values:
    """Point under the pressure, from the ankle, in the laboratory's directions.

    foot (phase,) [rad]: absolute angle of the foot
    pressure (phase,) [m]: centre of pressure along the foot, from the ankle
    returns (phase, 2) [m]: forwards, upwards
    """
    c, s = np.cos(foot), np.sin(foot)
    return np.column_stack([pressure * c + leg.ankle_m * s, pressure * s - leg.ankle_m * c])


def by_phase(cycle: Values) -> Values:
    """Rate by phase of one whole cycle (phase, ...), evenly spaced, without its end."""
    return cycle_rate(cycle, 1 / len(cycle))
