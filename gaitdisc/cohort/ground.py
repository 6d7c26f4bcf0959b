"""The belt: what it does to a foot along the habitual path, and how firmly.

The vertical force is mostly prescribed: it follows the habitual curve of `habit.csv`, as does the shear. What is
mechanical is what differs from the habit. A foot that is lower than usual is pushed up, one that the belt has carried
further or less far than the leg's habit is pulled along: it sticks to the belt, whose speed is constant, whatever the
phase does. All of this passes through a gate that is exactly zero in swing.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gaitdisc.cohort.habit import STANCE, Curve, habitual

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

    along: float = 6000.0  # stiffness [N/m, N/m, N m/rad]
    up: float = 12000.0  # stiffness [N/m, N/m, N m/rad]
    turn: float = 120.0  # stiffness [N/m, N/m, N m/rad]
    along_damping: float = 180.0  # [N s/m, N s/m, N m s/rad]
    up_damping: float = 360.0  # [N s/m, N s/m, N m s/rad]
    turn_damping: float = 3.0  # [N s/m, N s/m, N m s/rad]


def gate(phase: NDArray[np.float64]) -> NDArray[np.float64]:
    """How much of a foot is on the belt by share of the stride since contact: 0 in swing, 1 in mid-stance.

    >>> gate(np.array([0.0, 0.3, 0.7])).tolist()
    [0.0, 1.0, 0.0]
    """
    share = np.mod(phase, 1.0) / STANCE
    opening = np.sin(0.5 * np.pi * np.clip(share / RISE, 0.0, 1.0)) ** 2
    closing = np.sin(0.5 * np.pi * np.clip((1.0 - share) / FALL, 0.0, 1.0)) ** 2
    return np.where(share < 1.0, opening * closing, 0.0)


def habitual_force(phase: NDArray[np.float64], speed: float) -> NDArray[np.float64]:
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


def pressure_centre(phase: NDArray[np.float64], sole_m: float) -> NDArray[np.float64]:
    """Centre of pressure along the foot from the ankle [m], by share of the stride; in swing it means nothing."""
    from scipy.interpolate import PchipInterpolator

    share = np.mod(phase, 1.0) / STANCE
    rolled = PchipInterpolator(ROLLED, PRESSURE)(np.minimum(share, 1.0))
    back = np.clip((share - 1.0) / (1.0 / STANCE - 1.0), 0.0, 1.0)
    return sole_m * (rolled + (PRESSURE[0] - PRESSURE[-1]) * np.sin(0.5 * np.pi * back) ** 2)
