import numpy as np
import pytest

from gaitdisc.kinetics.newton_euler import moment_per_foot_kg

UP = np.array([0.0, 0.0, 1.0])


def test_a_mass_swung_on_a_circle_needs_the_moment_of_a_pendulum():
    """1 kg at radius r: r^2 times the angular acceleration, and r g sin of the angle from hanging."""
    rate, radius = 200.0, 0.4
    t = np.arange(400) / rate
    angle = 0.5 * np.sin(2 * np.pi * t)
    middle = radius * np.column_stack([np.sin(angle), 0 * t, -np.cos(angle)])
    ahead = np.column_stack([np.cos(angle), 0 * t, np.sin(angle)]) * 0.1
    found = moment_per_foot_kg(np.zeros((400, 3)), middle - ahead, middle + ahead, UP, rate)
    speedup = -0.5 * (2 * np.pi) ** 2 * np.sin(2 * np.pi * t)
    true = radius**2 * speedup + 9.80665 * radius * np.sin(angle)
    inner = slice(5, -5)
    assert found[inner] == pytest.approx(true[inner], abs=0.01)


def test_it_does_not_matter_which_way_the_person_walks():
    still = np.zeros((9, 3))
    turned = [moment_per_foot_kg(still, still - one, still + 3 * one, UP, 100.0)[4] for one in 0.04 * np.eye(3)[:2]]
    assert turned[0] == pytest.approx(turned[1])
