"""The equations of motion against mechanics: energy, a pendulum's period, inverse against forward dynamics."""

import numpy as np
import pytest

from gaitdisc.cohort.body import (
    GRAVITY,
    add_ground_force,
    ankle_place,
    bias,
    cycle_rate,
    inertia,
    joint_moments,
    make_leg,
    solved,
)

LEG = make_leg(1.69, 66.5)


def energy(psi, rate):
    m = np.empty((3, 3))
    inertia(LEG, psi, m)
    height = -LEG.s1 * np.cos(psi[0]) - LEG.s2 * np.cos(psi[1])
    height += LEG.foot_kg * (LEG.foot_forward_m * np.sin(psi[2]) - LEG.foot_down_m * np.cos(psi[2]))
    return 0.5 * rate @ m @ rate + GRAVITY * height


def acceleration(psi, rate):
    m, b, x = np.empty((3, 3)), np.empty(3), np.empty(3)
    inertia(LEG, psi, m)
    bias(LEG, psi, rate, 0.0, 0.0, b)
    solved(m, -b, x)
    return x


def test_a_swinging_leg_keeps_its_energy():
    psi, rate, step = np.array([0.6, -0.2, 0.3]), np.array([1.0, -2.0, 0.5]), 2e-4
    first = energy(psi, rate)
    for _ in range(5000):  # one second of Runge-Kutta
        k1 = acceleration(psi, rate)
        k2 = acceleration(psi + step / 2 * rate, rate + step / 2 * k1)
        k3 = acceleration(psi + step / 2 * (rate + step / 2 * k1), rate + step / 2 * k2)
        k4 = acceleration(psi + step * (rate + step / 2 * k2), rate + step * k3)
        psi = psi + step * rate + step**2 / 6 * (k1 + k2 + k3)
        rate = rate + step / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
    assert energy(psi, rate) == pytest.approx(first, abs=1e-6)


def test_the_mass_matrix_is_symmetric_and_positive():
    m = np.empty((3, 3))
    for psi in np.random.default_rng(0).uniform(-1, 1, (20, 3)):
        inertia(LEG, psi, m)
        assert np.array_equal(m, m.T)
        assert np.linalg.eigvalsh(m).min() > 0


def test_solved_is_the_linear_solution():
    m, x = np.empty((3, 3)), np.empty(3)
    inertia(LEG, np.array([0.3, -0.4, 0.2]), m)
    solved(m, np.array([1.0, -2.0, 0.3]), x)
    assert x == pytest.approx(np.linalg.solve(m, [1.0, -2.0, 0.3]), rel=1e-9)


def test_the_ground_force_does_the_work_of_its_point():
    psi, force, arm, q = np.array([0.4, -0.1, 0.2]), np.array([30.0, 700.0]), np.array([0.1, -0.05]), np.zeros(3)
    add_ground_force(LEG, psi, force, arm, q)
    tiny = 1e-6
    for link in range(3):
        turned = psi.copy()
        turned[link] += tiny
        moved = ankle_place(LEG, turned[None])[0] - ankle_place(LEG, psi[None])[0]
        if link == 2:
            moved = moved + tiny * np.array([-arm[1], arm[0]])
        assert q[link] == pytest.approx(force @ moved / tiny, rel=1e-4)


def test_inverse_dynamics_of_a_leg_at_rest_is_its_weight():
    psi = np.tile([0.5, 0.0, 0.0], (16, 1))
    moments = joint_moments(LEG, psi, np.zeros((16, 2)), np.zeros((16, 4)), 0.05)
    foot = GRAVITY * LEG.foot_kg * LEG.foot_forward_m
    assert moments[0, 2] == pytest.approx(foot)
    assert moments[0, 0] == pytest.approx(GRAVITY * LEG.s1 * np.sin(0.5) + foot)


def test_standing_on_one_leg_needs_no_moment_where_the_force_passes_through_the_joints():
    psi = np.zeros((16, 3))
    ground = np.tile([0.0, 650.0, 0.0, -0.07], (16, 1))
    moments = joint_moments(LEG, psi, np.zeros((16, 2)), ground, 0.05)
    foot = GRAVITY * LEG.foot_kg * LEG.foot_forward_m
    assert moments[0, 2] == pytest.approx(foot)
    assert moments[0, 1] == pytest.approx(-foot)


def test_cycle_rate_twice_is_the_second_derivative():
    turn = np.arange(200) * 2 * np.pi / 200
    curve = np.sin(3 * turn) + 0.2 * np.cos(7 * turn)
    twice = cycle_rate(cycle_rate(curve, 0.01), 0.01)
    assert twice == pytest.approx(cycle_rate(curve, 0.01, 2), abs=1e-6 * np.abs(twice).max())


def test_a_taller_person_has_longer_and_heavier_legs():
    tall = make_leg(1.85, 80.0)
    assert tall.thigh_m > LEG.thigh_m
    assert tall.i1 > LEG.i1
    assert make_leg(1.69, 66.5, 0.8).foot_kg == pytest.approx(LEG.foot_kg + 0.8)
