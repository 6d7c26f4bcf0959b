"""What a laboratory knows of one ankle of the embedded cohort: its motion, its moments, and with which errors.

The motion is the cohort's recorded angle. Moments are the walk's own with errors of the usual size: a centre of
pressure that is off by 3 mm moves the moment of inverse dynamics, muscle moments waver by 5 % (plantarflexors, from
EMG) and by 1.5 N m (all others). They are moments of muscles that no device can enter, as a musculoskeletal estimate
gives them.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline
from scipy.signal import butter, sosfiltfilt

from gaitdisc.cohort.body import bias, inertia, make_leg
from gaitdisc.cohort.leg_path import PHASES, hip_motion
from gaitdisc.cohort.measurement import measure
from gaitdisc.cohort.muscles import activate, capacities, find_strength
from gaitdisc.cohort.person import FOOT_KG, GROUPS, Person
from gaitdisc.cohort.walk import QUICK_HZ, SLOW_HZ, TrueWalk
from gaitdisc.simulation.measured import Measured, TrialColumns, check_measured

INPUTS = ("recorded", "per_kg", "plantarflexors", "others", "phase")
LOWPASS_HZ, EDGE_S, TRIALS = 10.0, 2.0, 8
PRESSURE_M, ERROR_HZ = 0.003, 6.0
TRACKED = (800.0, 57.0, 1.0)  # of angle, rate and acceleration, as in tracked_ankle.toml
ANKLE, SIDE = 2, 0
FLEXIONS = [0, 3, 4]  # hip, knee and ankle among the walk's angles
Values = NDArray[np.float64]


def own_foot_kg(person: Person) -> float:
    """Mass of foot and device that the laboratory knows of [kg]."""
    return 0.0145 * person.mass_kg + FOOT_KG


def ankle_trials(walk: TrueWalk, emg_late_s: float, emg_error: float, others_nm: float) -> Measured:
    """Stretches of a walk, as inputs and observation of tracked_ankle.toml; errors are standard deviations."""
    rng = np.random.default_rng([walk.seed, 31])
    trial = measure(walk, walk.person.name, "", emg_late_s).stream("kinematics")
    angle = np.radians(trial.values[:, trial.names.index("ankle_angle_r")])
    path = CubicSpline(walk.slow_s, _low(angle))
    by_emg, per_kg = plantarflexor_moment(walk), moments_per_foot_kg(walk, hip=False)[:, ANKLE]
    others = walk.moments[:, SIDE, ANKLE] - walk.person.plantarflexors * by_emg
    net = walk.moments[:, SIDE, ANKLE] + walk.spring[:, SIDE]
    net = net - (own_foot_kg(walk.person) + walk.person.foot_kg) * per_kg
    net = net + PRESSURE_M * _wander(rng, len(net)) * np.interp(walk.slow_s, walk.quick_s, walk.force[:, SIDE, 1])
    others = others + others_nm * _wander(rng, len(net))
    late = np.interp(walk.slow_s - emg_late_s, walk.slow_s, by_emg * (1 + emg_error * _wander(rng, len(net))))
    recorded = sum(factor * path(walk.slow_s, order) for order, factor in enumerate(TRACKED)) - _low(net)
    columns = [recorded, *map(_low, (per_kg, late, others)), np.mod(walk.phase[:: round(QUICK_HZ / SLOW_HZ)], 1)]
    inner = slice(round(EDGE_S * SLOW_HZ), -round(EDGE_S * SLOW_HZ))
    inputs, seen = np.column_stack(columns)[inner], angle[inner, None]
    length = len(inputs) // TRIALS
    cuts, time = [slice(n * length, (n + 1) * length) for n in range(TRIALS)], np.arange(length) / SLOW_HZ
    trials = [TrialColumns(str(n), time, inputs[cut], seen[cut]) for n, cut in enumerate(cuts, 1)]
    return check_measured(trials, INPUTS, ("theta",), walk.person.name)


def plantarflexor_moment(walk: TrueWalk) -> Values:
    """Moment of gastrocnemius and soleus at the strength of the Nominal walk, towards dorsiflexion (time,) [N m]."""
    person = walk.person
    joint = np.radians(walk.angles[:, SIDE][:, FLEXIONS])
    rate = np.gradient(joint, 1 / SLOW_HZ, axis=0)
    reach = capacities(find_strength(person.mass_kg, person.style.strength[SIDE]), joint, rate)[:, :, ANKLE]
    total = np.zeros(len(walk.slow_s))
    for name in ("emg_gas", "emg_sol"):
        muscle = GROUPS.index(name)
        excitation = walk.excitation[:, SIDE, muscle]
        active, level = np.empty(len(excitation)), excitation[0]
        for sample, drive in enumerate(excitation):
            active[sample] = level
            level = activate(drive, level, 1 / QUICK_HZ)
        total += reach[:, muscle] * active[:: round(QUICK_HZ / SLOW_HZ)]
    return total


def moments_per_foot_kg(walk: TrueWalk, hip: bool = True) -> Values:
    """What each kg at the foot adds to the moments of hip, knee and ankle (time, 3) [N m/kg]; `hip`: it accelerates."""
    angles, speedup = np.radians(walk.angles[:, SIDE]), np.radians(walk.acceleration[:, SIDE])
    psi = _segments(angles[:, 0], angles[:, 3], angles[:, 4])
    turning = np.gradient(psi, 1 / SLOW_HZ, axis=0)
    faster = _segments(speedup[:, 0], speedup[:, 1], speedup[:, 2])
    carried = np.zeros((len(psi), 2))
    if hip:  # acceleration forwards and upwards [m/s2]
        grid, phase = np.arange(PHASES) / PHASES, walk.phase[:: round(QUICK_HZ / SLOW_HZ)] % 1.0
        speed = [np.interp(phase, grid, one, period=1.0) for one in hip_motion(walk.person, grid).T]
        whole = np.column_stack(speed) + np.gradient(walk.pelvis, 1 / SLOW_HZ, axis=0)
        carried = np.gradient(whole, 1 / SLOW_HZ, axis=0)
    person, found = walk.person, np.zeros((len(psi), 3))
    for kilograms, sign in ((0.0, -1), (1.0, 1)):
        leg, m, b = make_leg(person.height_m, person.mass_kg, kilograms), np.zeros((3, 3)), np.zeros(3)
        for sample in range(len(psi)):
            inertia(leg, psi[sample], m)
            bias(leg, psi[sample], turning[sample], *carried[sample], b)
            found[sample] += sign * (m @ faster[sample] + b)
    return np.column_stack([found.sum(axis=1), -found[:, 1] - found[:, 2], found[:, 2]])


def _segments(hip: Values, knee: Values, ankle: Values) -> Values:
    return np.column_stack([hip, hip - knee, hip - knee + ankle])


def _low(values: Values, cutoff_hz: float = LOWPASS_HZ) -> Values:
    return sosfiltfilt(butter(4, cutoff_hz, fs=SLOW_HZ, output="sos"), values)


def _wander(rng: np.random.Generator, count: int) -> Values:
    """Error of standard deviation 1 that changes no faster than the filters let through."""
    slow = _low(rng.normal(size=count), ERROR_HZ)
    return slow / slow.std()
