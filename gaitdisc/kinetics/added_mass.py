"""What a mass at the foot, of which the inertia table knows nothing, adds to a joint's net moment."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gaitdisc.kinetics.newton_euler import GRAVITY
from gaitdisc.signals.derivatives import differentiated


def moment_per_foot_kg(
    joint: NDArray[np.float64],
    heel: NDArray[np.float64],
    toe: NDArray[np.float64],
    up: NDArray[np.float64],
    rate_hz: float,
) -> NDArray[np.float64]:
    """Return the moment that carries 1 kg midway between heel and toes (sample,) [N m/kg].

    It is positive towards dorsiflexion and hip flexion; at the knee that is extension.

    joint, heel, toe (sample, 3): Low-passed places [m]
    up (3,): unit vector against gravity

    >>> still = np.zeros((9, 3))
    >>> found = moment_per_foot_kg(still, still - [0.04, 0, 0], still + [0.16, 0, 0], np.array([0.0, 0, 1]), 100.0)
    >>> round(float(found[4]), 2)  # 6 cm before the joint
    0.59
    """
    middle = (heel + toe) / 2
    forward = toe - heel
    forward = forward - np.outer(forward @ up, up)
    axis = np.cross(forward / np.linalg.norm(forward, axis=1, keepdims=True), up)
    push = differentiated(middle, rate_hz, 2) + GRAVITY * up
    return np.einsum("fx,fx->f", axis, np.cross(middle - joint, push))
