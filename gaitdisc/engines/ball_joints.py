"""Three angles in the place of a quaternion of a ball or free joint: about y, then the new x, then the new z.

MuJoCo turns these joints by quaternions and angular velocities of the body; a column shows an angle, and an equation
has its rate. With z up and x ahead the angles of a hip are flexion, abduction and rotation.

balls: first coordinate of each such three; the others stand among MuJoCo's positions in the same order
"""

from collections.abc import Sequence

import numpy as np
from scipy.spatial.transform import Rotation

from gaitdisc.recording.arrays import Values

ABOUT = tuple(("rad", f" about {axis}") for axis in "yxz")  # unit and name of each
ALONG = tuple(("m", f" along {axis}") for axis in "xyz")
WAYS = ((*ALONG, *ABOUT), ABOUT, (("m", ""),), (("rad", ""),))  # of a free joint, a ball, a slide and a hinge
STEEPEST = 1.4  # [rad], of the angle in the middle: at a right angle the other two are one
NUDGE = 1e-5  # [s]


def to_positions(balls: Sequence[int], q: Values, v: Values) -> tuple[Values, Values]:
    """MuJoCo's positions and velocities (point, each) of coordinates and speeds (point, coordinate)."""
    v = np.array(v)
    for k in reversed(balls):
        some = slice(k, k + 3)
        v[:, some] = np.einsum("pij,pj->pi", _axes(q[:, some]), v[:, some])
        q = np.hstack([q[:, :k], Rotation.from_euler("YXZ", q[:, some]).as_quat(scalar_first=True), q[:, k + 3 :]])
    return q, v


def to_coordinates(balls: Sequence[int], q: Values, v: Values, begun: Values) -> Values:
    """Coordinates, then speeds (run, sample, each) of positions and velocities; an angle goes on beyond half a turn.

    begun (run, coordinate): where each begins
    """
    v = np.array(v)
    for k in balls:
        w, x, y, z = np.moveaxis(q[..., k : k + 4], -1, 0)
        about_x = np.arcsin(np.clip(2 * (w * x - y * z), -1, 1))
        about_y = np.arctan2(2 * (x * z + w * y), 1 - 2 * (x * x + y * y))
        about_z = np.arctan2(2 * (x * y + w * z), 1 - 2 * (x * x + z * z))
        angles = np.stack([about_y, about_x, about_z], axis=-1)
        angles = np.unwrap(np.concatenate([begun[:, None, k : k + 3], angles], axis=1), axis=1)[:, 1:]
        v[..., k : k + 3] = np.linalg.solve(_axes(angles), v[..., k : k + 3, None])[..., 0]
        q = np.concatenate([q[..., :k], angles, q[..., k + 4 :]], axis=2)
    return np.concatenate([q, v], axis=2)


def to_accelerations(balls: Sequence[int], q: Values, v: Values, rates: Values) -> Values:
    """Accelerations (point, coordinate) where MuJoCo's velocities have some rates, which are replaced."""
    for k in balls:
        x, speed, some = q[:, k : k + 3], v[:, k : k + 3], slice(k, k + 3)
        turning = (_axes(x + NUDGE * speed) - _axes(x - NUDGE * speed)) / (2 * NUDGE)
        rates[:, some] -= np.einsum("pij,pj->pi", turning, speed)
        rates[:, some] = np.linalg.solve(_axes(x), rates[:, some, None])[..., 0]
    return rates


def to_forces(balls: Sequence[int], q: Values, forces: Values) -> Values:
    """Forces on MuJoCo's velocities (point, each) that do the work of those on coordinates."""
    forces = np.array(forces)
    for k in balls:
        axes = np.swapaxes(_axes(q[:, k : k + 3]), 1, 2)
        forces[:, k : k + 3] = np.linalg.solve(axes, forces[:, k : k + 3, None])[..., 0]
    return forces


def _axes(angles: Values) -> Values:
    """Axes of three angles in the turned body, as columns (..., 3, 3): they make its velocity of the angles' rates."""
    (cb, cc), (sb, sc) = (of(np.moveaxis(angles[..., 1:], -1, 0)) for of in (np.cos, np.sin))
    rows = [[cb * sc, cc, 0 * cc], [cb * cc, -sc, 0 * cc], [-sb, 0 * cc, 1 + 0 * cc]]
    return np.moveaxis(np.array(rows), (0, 1), (-2, -1))
