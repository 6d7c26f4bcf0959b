"""The leg: thigh, shank and foot in the sagittal plane, hung on a moving hip.

Angles psi are absolute: thigh and shank against the vertical, the foot against the horizontal, each positive where it
swings the segment below forwards (toe up). With S1 = m1 r1 + (m2 + m3) L1 and S2 = m2 r2 + m3 L2 the equations are
M(psi) psi'' + b(psi, psi', hip acceleration) = moments, Lagrange's for three links. x is forwards, y upwards.

Lengths, masses, centres and radii of gyration are Winter's (2009, table 4.1), with the mass of the device on top.
"""

from typing import NamedTuple

import numpy as np

from gaitdisc.cohort.person import FOOT_KG, SHANK_KG
from gaitdisc.compiled import compiled
from gaitdisc.recording.arrays import Values

GRAVITY = 9.81


class Leg(NamedTuple):
    """Masses and lengths of one leg, in the units of the equations."""

    thigh_m: float
    shank_m: float
    s1: float  # first moment S1 [kg m]
    s2: float  # first moment S2 [kg m]
    foot_kg: float  # mass of the foot
    foot_forward_m: float  # its centre from the ankle, forwards
    foot_down_m: float  # its centre from the ankle, downwards
    i1: float  # M11, which does not depend on the angles [kg m2]
    i2: float  # M22, as well
    i3: float  # M33, as well
    ankle_m: float  # height of the ankle over the sole [m]
    sole_m: float  # length of the foot [m]


def make_leg(height_m: float, mass_kg: float, added_foot_kg: float = 0.0) -> Leg:
    """Leg of a person who wears the device.

    Source: Winter DA (2009). Biomechanics and Motor Control of Human Movement, 4th edition, table 4.1 and figure 4.1.

    >>> round(make_leg(1.69, 66.5).thigh_m, 3)
    0.414
    """
    l1, l2, sole, ankle = 0.245 * height_m, 0.246 * height_m, 0.152 * height_m, 0.039 * height_m
    m1, own2, own3 = 0.100 * mass_kg, 0.0465 * mass_kg, 0.0145 * mass_kg
    m2, m3 = own2 + SHANK_KG, own3 + FOOT_KG + added_foot_kg
    r1, r2 = 0.433 * l1, 0.433 * l2
    forward, down = 0.25 * sole, 0.02 * height_m
    i1 = m1 * (0.323 * l1) ** 2 + m1 * r1**2 + (m2 + m3) * l1**2
    i2 = own2 * (0.302 * l2) ** 2 + m2 * r2**2 + m3 * l2**2
    i3 = own3 * (0.475 * sole) ** 2 + m3 * (forward**2 + down**2)
    s1, s2 = m1 * r1 + (m2 + m3) * l1, m2 * r2 + m3 * l2
    return Leg(l1, l2, s1, s2, m3, forward, foot_down_m=down, i1=i1, i2=i2, i3=i3, ankle_m=ankle, sole_m=sole)


@compiled
def inertia(leg, psi, m):
    """Write the mass matrix M(psi) into m (3, 3) [kg m2]."""
    c1, s1, c2, s2, c3, s3 = _turns(psi)
    fx, fy = _foot(leg, c3, s3)
    m[0, 0], m[1, 1], m[2, 2] = leg.i1, leg.i2, leg.i3
    m[0, 1] = leg.s2 * leg.thigh_m * (c1 * c2 + s1 * s2)
    m[0, 2] = leg.foot_kg * leg.thigh_m * (c1 * fx + s1 * fy)
    m[1, 2] = leg.foot_kg * leg.shank_m * (c2 * fx + s2 * fy)
    m[1, 0], m[2, 0], m[2, 1] = m[0, 1], m[0, 2], m[1, 2]


@compiled
def bias(leg, psi, rate, ax, ay, b):
    """Write what gravity, the hip's acceleration and the turning of the links demand into b (3,) [N m]."""
    c1, s1, c2, s2, c3, s3 = _turns(psi)
    fx, fy = _foot(leg, c3, s3)
    bx, by = -leg.foot_forward_m * c3 - leg.foot_down_m * s3, -leg.foot_forward_m * s3 + leg.foot_down_m * c3
    w1, w2, w3 = rate[0] ** 2, rate[1] ** 2, rate[2] ** 2
    up = ay + GRAVITY
    l1, l2, m3 = leg.thigh_m, leg.shank_m, leg.foot_kg
    b[0] = leg.s1 * (c1 * ax + s1 * up) + l1 * (leg.s2 * (s1 * c2 - c1 * s2) * w2 + m3 * (c1 * bx + s1 * by) * w3)
    b[1] = leg.s2 * (c2 * ax + s2 * up) + l1 * leg.s2 * (s2 * c1 - c2 * s1) * w1 + l2 * m3 * (c2 * bx + s2 * by) * w3
    b[2] = m3 * (fx * ax + fy * up + l1 * (fy * c1 - fx * s1) * w1 + l2 * (fy * c2 - fx * s2) * w2)


@compiled
def add_ground_force(leg, psi, forces, arm, q):
    """Add the ground's force (x, y) at `arm` (x, y) from the ankle to the generalised moments q (3,) [N m]."""
    c1, s1, c2, s2, _, _ = _turns(psi)
    q[0] += leg.thigh_m * (c1 * forces[0] + s1 * forces[1])
    q[1] += leg.shank_m * (c2 * forces[0] + s2 * forces[1])
    q[2] += arm[0] * forces[1] - arm[1] * forces[0]


@compiled
def solved(m, q, x):
    """Write M^-1 q into x (3,) by Cholesky, M being symmetric and positive."""
    l00 = np.sqrt(m[0, 0])
    l10, l20 = m[1, 0] / l00, m[2, 0] / l00
    l11 = np.sqrt(m[1, 1] - l10 * l10)
    l21 = (m[2, 1] - l20 * l10) / l11
    l22 = np.sqrt(m[2, 2] - l20 * l20 - l21 * l21)
    y0 = q[0] / l00
    y1 = (q[1] - l10 * y0) / l11
    x[2] = (q[2] - l20 * y0 - l21 * y1) / l22 / l22
    x[1] = (y1 - l21 * x[2]) / l11
    x[0] = (y0 - l10 * x[1] - l20 * x[2]) / l00


@compiled
def _turns(psi):
    return np.cos(psi[0]), np.sin(psi[0]), np.cos(psi[1]), np.sin(psi[1]), np.cos(psi[2]), np.sin(psi[2])


@compiled
def _foot(leg, c3, s3):
    """How the foot's centre moves with its angle."""
    return -leg.foot_forward_m * s3 + leg.foot_down_m * c3, leg.foot_forward_m * c3 + leg.foot_down_m * s3


def ankle_place(leg: Leg, psi: Values) -> Values:
    """Where the ankle is from the hip, forwards and upwards (time, 2) [m]; psi (time, 3) [rad]: thigh, shank, foot."""
    x = leg.thigh_m * np.sin(psi[:, 0]) + leg.shank_m * np.sin(psi[:, 1])
    y = -leg.thigh_m * np.cos(psi[:, 0]) - leg.shank_m * np.cos(psi[:, 1])
    return np.column_stack([x, y])


def joint_moments(leg: Leg, psi: Values, hip: Values, ground: Values, step_s: float) -> Values:
    """Net joint moments of a periodic motion, by inverse dynamics.

    psi (phase, 3) [rad]: one whole cycle, evenly spaced, without its end
    hip (phase, 2) [m/s2]: acceleration of the hip
    ground (phase, 4) [N, N, m, m]: force forwards and upwards, and its point from the ankle
    step_s: between two samples [s]
    returns (phase, 3) [N m]: hip and knee towards flexion, ankle towards dorsiflexion
    """
    return _inverse_dynamics(leg, psi, cycle_rate(psi, step_s), cycle_rate(psi, step_s, 2), hip, ground)


@compiled
def _inverse_dynamics(leg, psi, rate, speedup, hip, ground):
    m, b, q, moments = np.empty((3, 3)), np.empty(3), np.empty(3), np.empty((len(psi), 3))
    for sample in range(len(psi)):
        inertia(leg, psi[sample], m)
        bias(leg, psi[sample], rate[sample], hip[sample, 0], hip[sample, 1], b)
        q[:] = 0.0
        add_ground_force(leg, psi[sample], ground[sample, :2], ground[sample, 2:], q)
        for link in range(3):
            b[link] -= q[link]
            for other in range(3):
                b[link] += m[link, other] * speedup[sample, other]
        moments[sample, 0], moments[sample, 1], moments[sample, 2] = b[0] + b[1] + b[2], -b[1] - b[2], b[2]
    return moments


def cycle_rate(cycle: Values, step: float, order: int = 1) -> Values:
    """Derivative of one whole cycle (phase, ...) without its end, even, exact for the harmonics that it holds.

    >>> turn = np.arange(64) * 2 * np.pi / 64
    >>> bool(np.allclose(cycle_rate(np.sin(turn), 2 * np.pi / 64), np.cos(turn)))
    True
    """
    count = len(cycle)
    turns = (2j * np.pi * np.fft.rfftfreq(count, step)) ** order
    spectrum = np.fft.rfft(cycle, axis=0) * turns.reshape(-1, *[1] * (cycle.ndim - 1))
    return np.fft.irfft(spectrum, count, axis=0)
