"""Seven muscles of a leg: how excitation becomes activation, and activation moments about the joints."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gaitdisc.cohort.person import MUSCLES
from gaitdisc.compiled import compiled

RISE_S, FALL_S = 0.015, 0.045  # activation dynamics; Winter (2009) and Zajac (1989) give this order
# moment at full activation [N m per kg of body mass] about hip and knee (flexion), ankle (dorsiflexion)
REACH = {
    "emg_ham": (-0.80, 0.60, 0.0),
    "emg_rf": (0.50, -0.60, 0.0),
    "emg_vas": (0.0, -1.30, 0.0),
    "emg_gas": (0.0, 0.30, -0.90),
    "emg_sol": (0.0, 0.0, -1.60),
    "emg_ta": (0.0, 0.0, 0.45),
    "emg_gmed": (0.0, 0.0, 0.0),
}
ABDUCTION = 1.0  # of gluteus medius [N m/kg]
# share of a change of the joint's command that each muscle takes on: (muscle, joint, direction, share)
SHARES = (
    ("emg_ham", 0, -1, 0.35),
    ("emg_rf", 0, 1, 0.25),
    ("emg_ham", 1, 1, 0.35),
    ("emg_rf", 1, -1, 0.20),
    ("emg_vas", 1, -1, 0.60),
    ("emg_gas", 2, -1, 0.30),
    ("emg_sol", 2, -1, 0.55),
    ("emg_ta", 2, 1, 0.60),
)
LENGTHENING = 0.06  # relative gain of moment for each rad/s of lengthening
LEAST, MOST = 0.01, 1.0  # of excitation


class Strength(NamedTuple):
    """Muscles of one person, in the units of the equations.

    Attributes
    ----------
    reach : ndarray (muscle, joint) [N m]
        Moment at full activation.
    take_up, take_down : ndarray (muscle, joint) [1/(N m)]
        Excitation for a change of the command towards flexion (dorsiflexion), and against it.
    abduction : float
        Of gluteus medius [N m].
    """

    reach: NDArray[np.float64]
    take_up: NDArray[np.float64]
    take_down: NDArray[np.float64]
    abduction: float


def strength_of(mass_kg: float) -> Strength:
    """Muscles of a person.

    Examples
    --------
    >>> strength_of(70.0).reach.shape
    (7, 3)
    """
    reach = np.array([REACH[name] for name in MUSCLES]) * mass_kg
    up, down = np.zeros_like(reach), np.zeros_like(reach)
    for name, joint, direction, share in SHARES:
        muscle = MUSCLES.index(name)
        # an antagonist lets go of what the agonist does not need: each muscle answers both ways
        up[muscle, joint] = share / reach[muscle, joint]
        down[muscle, joint] = share / reach[muscle, joint]
        if direction > 0:
            down[muscle, joint] *= 0.5
        else:
            up[muscle, joint] *= 0.5
    return Strength(reach, up, down, ABDUCTION * mass_kg)


@compiled
def activated(excitation, activation, step_s):
    """Activation after one step of first-order dynamics, faster in rising than in falling [1]."""
    pace = RISE_S if excitation > activation else FALL_S
    return activation + (excitation - activation) * step_s / pace


@compiled
def muscle_moments(strength, activation, joint_rate, moments):
    """Add the muscles' moments to moments (3,), with what lengthening gains [N m]."""
    for muscle in range(strength.reach.shape[0]):
        pull = 0.0
        for joint in range(3):
            reach = strength.reach[muscle, joint]
            if reach != 0.0:
                pull -= np.sign(reach) * joint_rate[joint]
        gain = min(1.3, max(0.7, 1.0 + LENGTHENING * pull))
        for joint in range(3):
            moments[joint] += strength.reach[muscle, joint] * activation[muscle] * gain


@compiled
def cycle_activation(excitation, step_s, turns):
    """Periodic activation (phase, muscle) of a periodic excitation, after some turns of the cycle."""
    count, muscles = excitation.shape
    found = excitation.copy()
    for muscle in range(muscles):
        level = excitation[0, muscle]
        for _ in range(turns):
            for sample in range(count):
                found[sample, muscle] = level
                level = activated(excitation[sample, muscle], level, step_s)
    return found
