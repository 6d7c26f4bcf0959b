"""A walk: a person, a device, a duration and a seed; and the truth of it, which no laboratory sees."""

from dataclasses import dataclass, field

import numpy as np

from gaitdisc.cohort.body import make_leg
from gaitdisc.cohort.controller import learnt_table
from gaitdisc.cohort.leg_path import Belt
from gaitdisc.cohort.motion import (
    NOISE,
    NOISE_STEPS,
    PACE_NOISE,
    PER_LEG_NOISE,
    SLOW_MUSCLES,
    STEP_S,
    WANDER,
    Loop,
    Worn,
    integrate,
)
from gaitdisc.cohort.muscles import find_strength
from gaitdisc.cohort.person import FOOT_KG, GROUPS, MUSCLES, SHANK_KG, Person, Spring
from gaitdisc.errors import StrideError
from gaitdisc.recording.arrays import Values
from gaitdisc.recording.trial import LEG_OF_STATURE

WARM_UP_S = 8.0  # walked before the recording begins
QUICK_HZ, SLOW_HZ = 1000.0, 100.0
CHANGE_S = 4.0  # a change of gait takes this long
CHANGE_SIZE = 16.0  # of the drift's standard deviation
TYPICAL_KG = 66.5
# standard deviation [N m] and time constant [s] of the noise in the moments of hip, knee, ankle, adduction, rotation
MOMENT_NOISE = (2.6, 2.8, 1.8, 1.2, 0.3)
MOMENT_NOISE_S = 0.12
MUSCLE_NOISE, MUSCLE_NOISE_S = (0.10, 0.06), (0.10, 6.0)
PACE_NOISE_SIZE, PACE_NOISE_S = (0.018, 0.012), (0.3, 10.0)
DRIFT_S = 25.0


@dataclass(frozen=True, eq=False)
class TrueWalk:
    """Everything that happened during a walk.

    >>> from gaitdisc.cohort.person import draw_one
    >>> walk = walked(draw_one("W01", 1, "f"), None, 5.0, seed=3)
    >>> walk.angles.shape, walk.excitation.shape
    ((500, 2, 5), (5000, 2, 9))
    """

    person: Person
    device: Spring
    seed: int
    quick_s: Values = field(repr=False)  # (time,) [s], clock at 1000 Hz
    slow_s: Values = field(repr=False)  # (time,) [s], clock at 100 Hz
    # (quick,) [strides], of the right foot, counted on; a whole number is a contact. The left foot is half a stride off
    phase: Values = field(repr=False)
    force: Values = field(repr=False)  # (quick, 2, 2) [N], side; forwards, upwards
    # (quick, 2, 9) [1], side; muscle group in the order of `GROUPS`, those with electrodes first
    excitation: Values = field(repr=False)
    angles: Values = field(repr=False)  # (slow, 2, 5) [deg], side; joint in the order of `JOINTS`
    # (slow, 2, 3) [N m], side; hip and knee towards flexion, ankle towards dorsiflexion, without the device
    moments: Values = field(repr=False)
    # (slow, 2) [N m], moment of the device on each ankle, towards dorsiflexion
    spring: Values = field(repr=False)
    # (slow, 2) [m/s], speed forwards of the foot's point under the pressure; minus the belt's speed where the foot
    # stands
    sole: Values = field(repr=False)
    acceleration: Values = field(repr=False)  # (slow, 2, 3) [deg/s2], side; hip, knee, ankle
    # (slow, 2) [m], forwards, upwards: how far the pelvis is from its habitual path
    pelvis: Values = field(repr=False)
    # (slow, 2) [N m], of the belt on the foot towards dorsiflexion, beside that of the force at its usual point
    turn: Values = field(repr=False)

    def contacts(self, side: int = 0) -> Values:
        """Times at which a foot meets the belt, from the phase itself [s]."""
        phase = self.phase + 0.5 * side
        return np.interp(np.arange(np.ceil(phase[0]), np.floor(phase[-1]) + 1), phase, self.quick_s)

    def strides(self, values: Values, side: int = 0) -> Values:
        """Each stride on 101 points of its true phase.

        values (slow or quick, ...): a field of this walk
        returns (stride, 101, ...)
        """
        quick = len(values) == len(self.quick_s)
        phase = (self.phase if quick else self.phase[:: round(QUICK_HZ / SLOW_HZ)]) + 0.5 * side
        first, last = int(np.ceil(phase[0])), int(np.floor(phase[-1]))
        grid = (np.arange(first, last)[:, None] + np.linspace(0.0, 1.0, 101)).ravel()
        flat = values.reshape(len(values), -1)
        columns = [np.interp(grid, phase, column) for column in flat.T]
        return np.column_stack(columns).reshape(last - first, 101, *values.shape[1:])


def walked(person: Person, device: Spring | None, duration_s: float, seed: int) -> TrueWalk:
    """Walk on the treadmill for a while.

    device: none, or stiffness 0, is the device without its spring; both give the same walk to the last bit
    duration_s: length of the recording, after `WARM_UP_S` that are not kept [s]
    seed: of the variability; the same seed gives the same walk

    >>> from gaitdisc.cohort.person import draw_one
    >>> walk = walked(draw_one("W01", 1, "f"), Spring(5.0), 5.0, seed=3)
    >>> bool(walk.spring.min() < -5.0)
    True
    """
    device = device or Spring(0.0)
    leg = make_leg(person.height_m, person.mass_kg, person.foot_kg)
    strengths = [find_strength(person.mass_kg, person.style.strength[side]) for side in (0, 1)]
    for strength in strengths:
        strength.reach[[MUSCLES.index("emg_gas"), MUSCLES.index("emg_sol")], 2] *= person.plantarflexors
    stiffness, engaged = float(np.degrees(device.stiffness)), float(np.radians(person.engaged_deg))
    worn = Worn(stiffness, engaged, person.speed_m_per_s, person.stride_s)
    tables = np.stack(
        [np.stack([learnt_table(person, side, drifted) for side in (0, 1)]) for drifted in (0.0, CHANGE_SIZE)]
    )
    noise = _noise(person, device, duration_s + WARM_UP_S, seed)
    quick, slow, upright = integrate(
        leg, tuple(strengths), Belt(), _loop(person), worn=worn, tables=tables, noise=noise
    )
    if not upright:
        raise StrideError(
            "the legs of a simulated walk must stay under the body",
            f"{person.name}, {device.stiffness:g} N m/deg, seed {seed}: a segment turned by more than 143 deg",
            "Draw another person, and please report the seed.",
        )
    return _keep_walk(person, device, seed, quick, slow)


def _loop(person: Person) -> Loop:
    size = person.mass_kg / TYPICAL_KG
    leg_m = LEG_OF_STATURE * person.height_m
    return Loop(
        stiffness=size * np.array([60.0, 35.0, 35.0]),
        damping=size * np.array([8.0, 2.0, 1.5]),
        loaded=np.array([1.0, 4.5, 3.0]),
        reflex=25.0 * size,
        reflex_lag_s=0.040,
        side_stiffness=size * np.array([150.0, 30.0]),
        side_damping=size * np.array([15.0, 2.0]),
        side_inertia=size * np.array([3.5 * leg_m, 0.5]),
        hurry=0.25,
        moment_noise=person.unrest * size * np.array(MOMENT_NOISE),
        muscle_noise=person.unrest * np.array(MUSCLE_NOISE),
        pace_noise=person.unrest * np.array(PACE_NOISE_SIZE),
        whole_kg=person.mass_kg + 2 * (SHANK_KG + FOOT_KG),
        pelvis=size * np.array([600.0, 350.0, 4000.0, 500.0]),
    )


def _noise(person: Person, device: Spring, duration_s: float, seed: int) -> Values:
    """Coloured noise of standard deviation 1 at 200 Hz, and in its last channel how far the habit has drifted."""
    from scipy.signal import lfilter

    rng = np.random.default_rng([seed, 11])
    step_s = STEP_S * NOISE_STEPS
    count = round(duration_s / step_s) + 1
    colours = np.empty(NOISE)
    for side in range(2):
        leg_colours = colours[side * PER_LEG_NOISE : (side + 1) * PER_LEG_NOISE]
        leg_colours[:5] = MOMENT_NOISE_S
        leg_colours[5:SLOW_MUSCLES], leg_colours[SLOW_MUSCLES:] = MUSCLE_NOISE_S
    colours[PACE_NOISE : PACE_NOISE + 2] = PACE_NOISE_S
    colours[WANDER] = DRIFT_S
    noise = np.empty((count, NOISE))
    for channel, colour in enumerate(colours):
        keep = np.exp(-step_s / colour)
        shocks = rng.normal(size=count) * np.sqrt(1 - keep**2)
        shocks[0] = rng.normal()
        noise[:, channel] = lfilter([1.0], [1.0, -keep], shocks)
    noise[:, WANDER] = np.clip(noise[:, WANDER], -2.5, 2.5)
    if device.stiffness > 0:
        time = np.arange(count) * step_s - WARM_UP_S
        noise[:, WANDER] += CHANGE_SIZE * np.clip((time - person.change_s) / CHANGE_S, 0.0, 1.0)
    noise[:, WANDER] /= CHANGE_SIZE
    return noise


def _keep_walk(person: Person, device: Spring, seed: int, quick: Values, slow: Values) -> TrueWalk:
    quick, slow = quick[round(WARM_UP_S * QUICK_HZ) :], slow[round(WARM_UP_S * SLOW_HZ) :]
    psi = slow[:, 1:7].reshape(-1, 2, 3)
    hips = slow[:, 7:11].reshape(-1, 2, 2)
    flexion = [psi[:, :, 0], hips[:, :, 0], hips[:, :, 1], psi[:, :, 0] - psi[:, :, 1], psi[:, :, 2] - psi[:, :, 1]]
    speedup = slow[:, 23:29].reshape(-1, 2, 3)
    joints = [speedup[:, :, 0], speedup[:, :, 0] - speedup[:, :, 1], speedup[:, :, 2] - speedup[:, :, 1]]
    return TrueWalk(
        person,
        device,
        seed,
        quick_s=np.arange(len(quick)) / QUICK_HZ,
        slow_s=np.arange(len(slow)) / SLOW_HZ,
        phase=quick[:, 0],
        force=quick[:, 1:5].reshape(-1, 2, 2),
        excitation=quick[:, 5:].reshape(-1, 2, len(GROUPS)),
        angles=np.degrees(np.stack(flexion, axis=2)),
        moments=slow[:, 11:17].reshape(-1, 2, 3),
        spring=slow[:, 17:19],
        sole=slow[:, 19:21],
        acceleration=np.degrees(np.stack(joints, axis=2)),
        pelvis=slow[:, 21:23],
        turn=slow[:, 29:31],
    )
