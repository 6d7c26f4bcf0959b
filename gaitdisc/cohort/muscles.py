"""Nine muscle groups of a leg: arms, strengths, activation and force-velocity, and their moments about the joints.

A group's moment about a joint is its largest force, times its arm there, times activation, times what speed and length
leave of it. Seven of the nine carry an electrode; iliopsoas and gluteus maximus lie too deep.

Isometric forces, fibre lengths and arms are of the order of those in Arnold et al. (2010), written from memory and not
looked up: whoever needs a person's muscles takes a musculoskeletal model. How much of a path's change of length the
fibres see (a long tendon takes the rest) and how the moment grows with the joint's angle are general knowledge.

References
----------
Arnold EM, Ward SR, Lieber RL, Delp SL (2010). A model of the lower limb for analysis of human movement. Ann Biomed Eng
38(2), 269-279. Zajac FE (1989). Muscle and tendon. Crit Rev Biomed Eng 17(4), 359-411.
"""

from typing import NamedTuple

import numpy as np

from gaitdisc.cohort.person import GROUPS
from gaitdisc.compiled import compiled
from gaitdisc.recording.arrays import Values

RISE_S, FALL_S = 0.015, 0.045  # activation dynamics; Winter (2009) and Zajac (1989) give this order
FASTEST = 10.0  # fibre lengths a second, at which a muscle gives nothing
ECCENTRIC = 0.4  # of the isometric force, on top of it, in fast lengthening
# force [N per kg of body mass], fibres [m], share of the path's change that the fibres see, arm [m] about hip and knee
# (towards flexion) and ankle (towards dorsiflexion), gain of the moment with the angle of each joint [1/rad]
ANATOMY = {
    "emg_ham": (31.0, 0.100, 0.7, (-0.055, 0.035, 0.0), (0.1, 0.1, 0.0)),
    "emg_rf": (11.5, 0.085, 0.7, (0.040, -0.042, 0.0), (-0.1, 0.2, 0.0)),
    "emg_vas": (57.0, 0.095, 0.7, (0.0, -0.042, 0.0), (0.0, 0.2, 0.0)),
    "emg_gas": (24.0, 0.055, 0.35, (0.0, 0.020, -0.048), (0.0, -0.2, 0.8)),
    "emg_sol": (50.0, 0.045, 0.35, (0.0, 0.0, -0.048), (0.0, 0.0, 0.8)),
    "emg_ta": (18.0, 0.085, 0.5, (0.0, 0.0, 0.040), (0.0, 0.0, -0.5)),
    "emg_gmed": (30.0, 0.065, 0.7, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)),
    "iliopsoas": (33.0, 0.110, 0.7, (0.040, 0.0, 0.0), (-0.2, 0.0, 0.0)),
    "gluteus_maximus": (28.0, 0.145, 0.7, (-0.055, 0.0, 0.0), (0.1, 0.0, 0.0)),
}
ABDUCTION = 1.0  # of gluteus medius [N m/kg]
# share of a change of the joint's command that each muscle takes on: those that pull that way, and those that let go
FLEXORS: tuple[dict[str, float], ...] = (
    {"iliopsoas": 0.45, "emg_rf": 0.20, "emg_ham": 0.20, "gluteus_maximus": 0.15},
    {"emg_ham": 0.50, "emg_gas": 0.15, "emg_vas": 0.25, "emg_rf": 0.10},
    {"emg_ta": 0.60, "emg_sol": 0.28, "emg_gas": 0.12},
)
EXTENSORS: tuple[dict[str, float], ...] = (
    {"gluteus_maximus": 0.40, "emg_ham": 0.30, "iliopsoas": 0.20, "emg_rf": 0.10},
    {"emg_vas": 0.55, "emg_rf": 0.20, "emg_ham": 0.25},
    {"emg_sol": 0.50, "emg_gas": 0.20, "emg_ta": 0.30},
)
LEAST, MOST = 0.004, 1.0  # of excitation
LEAST_GAIN, MOST_GAIN = 0.5, 1.5  # of a moment with the joint's angle


class Strength(NamedTuple):
    """Muscles of one person's leg, in the units of the equations."""

    reach: Values  # (muscle, joint) [N m], moment at full activation, at rest and at zero angle
    # (muscle, joint) [s/rad], lengthening, of the fastest shortening, for each rad/s of the joint
    pace: Values
    bend: Values  # (muscle, joint) [1/rad], relative gain of the moment with the joint's angle
    take_up: Values  # (muscle, joint) [1/(N m)], excitation for a change of the command towards flexion (dorsiflexion)
    take_down: Values  # the same for a change against it
    abduction: float  # of gluteus medius [N m]


def find_strength(mass_kg: float, strong: Values | None = None) -> Strength:
    """Muscles of a person's leg; `strong` is how strong each group is against others of that mass.

    >>> find_strength(70.0).reach.shape
    (9, 3)
    """
    anatomy = [ANATOMY[name] for name in GROUPS]
    arms = np.array([row[3] for row in anatomy])
    force = mass_kg * np.array([row[0] for row in anatomy]) * (1.0 if strong is None else strong)
    pace = -arms * np.array([row[2] / (FASTEST * row[1]) for row in anatomy])[:, None]
    reach = arms * force[:, None]
    up, down = np.zeros_like(reach), np.zeros_like(reach)
    for take, shares in ((up, FLEXORS), (down, EXTENSORS)):
        for joint, taken in enumerate(shares):
            for name, share in taken.items():
                muscle = GROUPS.index(name)
                take[muscle, joint] = share / reach[muscle, joint]
    return Strength(reach, pace, np.array([row[4] for row in anatomy]), up, down, ABDUCTION * mass_kg)


@compiled
def activate(excitation, activation, step_s):
    """Activation after one step of first-order dynamics, faster in rising than in falling [1]."""
    pace = RISE_S if excitation > activation else FALL_S
    return activation + (excitation - activation) * step_s / pace


@compiled
def force_at_speed(lengthening):
    """Share of the isometric force at a speed, of the fastest shortening; hyperbolic, with one slope at rest [1]."""
    if lengthening < 0.0:
        return max(0.0, 1.0 + lengthening) / (1.0 - 4.0 * lengthening)
    return 1.0 + ECCENTRIC * lengthening / (lengthening + 0.2 * ECCENTRIC)


@compiled
def muscle_moments(strength, activation, joint, joint_rate, moments):
    """Add the muscles' moments at joint angles and rates (3,) to moments (3,) [N m]."""
    for muscle in range(strength.reach.shape[0]):
        speed = 0.0
        for j in range(3):
            speed += strength.pace[muscle, j] * joint_rate[j]
        force = activation[muscle] * force_at_speed(speed)
        for j in range(3):
            reach = strength.reach[muscle, j]
            if reach != 0.0:
                gain = min(MOST_GAIN, max(LEAST_GAIN, 1.0 + strength.bend[muscle, j] * joint[j]))
                moments[j] += reach * gain * force


@compiled
def capacities(strength, joint, joint_rate):
    """Moment of each muscle at full activation along a motion: (time, muscle, joint) [N m]."""
    count, muscles = len(joint), strength.reach.shape[0]
    moments = np.zeros((count, muscles, 3))
    alone = np.zeros(muscles)
    for sample in range(count):
        for muscle in range(muscles):
            alone[:] = 0.0
            alone[muscle] = 1.0
            muscle_moments(strength, alone, joint[sample], joint_rate[sample], moments[sample, muscle])
    return moments


@compiled
def cycle_activation(excitation, step_s, turns):
    """Periodic activation (phase, muscle) of a periodic excitation, after some turns of the cycle."""
    count, muscles = excitation.shape
    activation = excitation.copy()
    for muscle in range(muscles):
        level = excitation[0, muscle]
        for _ in range(turns):
            for sample in range(count):
                activation[sample, muscle] = level
                level = activate(excitation[sample, muscle], level, step_s)
    return activation


def cycle_excitation(activation: Values, rest: Values, step_s: float) -> Values:
    """Excitation, no less than `rest`, whose activation comes nearest to a periodic one (phase, muscle)."""
    rate = (np.roll(activation, -1, axis=0) - np.roll(activation, 1, axis=0)) / (2 * step_s)
    return np.clip(activation + rate * np.where(rate > 0, RISE_S, FALL_S), rest, MOST)
