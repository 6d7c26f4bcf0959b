import numpy as np
import pytest

from gaitdisc.errors import ShapeError
from gaitdisc.kinetics.wrench import Wrench

POINT = np.array([0.31, 0.2, 0.012])
UP = np.array([0.0, 0.0, 1.0])


def test_force_point_and_free_moment_come_back():
    force = np.array([[40.0, -25.0, 640.0], [-10.0, 3.0, 300.0]])
    free = np.array([[0, 0, 4.0], [0, 0, -2.5]])
    place = np.array([[0.4, 0.1, 0.012], [0.2, 0.33, 0.012]])
    wrench = Wrench.at(place, force, free)
    assert wrench.pressure_centre(POINT, UP) == pytest.approx(place)
    assert wrench.about(wrench.pressure_centre(POINT, UP)) @ UP == pytest.approx(free[:, 2])
    assert wrench.about(place) == pytest.approx(free)


def test_no_centre_of_pressure_below_the_limit():
    wrench = Wrench.at(POINT, np.array([[0, 0, 19.9], [0, 0, 20.1], [0, 0, -700.0]]))
    assert np.isfinite(wrench.pressure_centre(POINT, UP)).all(axis=1).tolist() == [False, True, False]
    assert np.isfinite(wrench.pressure_centre(POINT, UP, 19.0)).all(axis=1).tolist() == [True, True, False]


def test_two_plates_under_one_foot_are_one_force_between_them():
    left, right = (
        Wrench.at(np.array([x, 0.0, 0.0]), np.array([[0.0, 0.0, n]])) for x, n in ((0.0, 100.0), (0.4, 300.0))
    )
    assert (left + right).pressure_centre(np.zeros(3), UP) == pytest.approx(np.array([[0.3, 0.0, 0.0]]))
    assert ((left + right) - right).force == pytest.approx(left.force)


def test_a_wrench_of_unlike_shapes_is_refused():
    with pytest.raises(ShapeError, match=r"shape \(sample, 3\).*\(4, 3\).*\(3, 3\)"):
        Wrench(np.zeros((4, 3)), np.zeros((3, 3)))
