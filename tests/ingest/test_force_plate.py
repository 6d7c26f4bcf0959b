from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gaitdisc.ingest.force_plates import ForcePlate, centre_of_pressure

# 0.6 m x 0.4 m, its z axis down: x forwards, y to the right
CORNERS = np.array([[0.6, 0, 0], [0, 0, 0], [0, 0.4, 0], [0.6, 0.4, 0]])
ORIGIN = np.array([0.002, -0.001, -0.04])  # the sensors lie 40 mm below the surface


def _plate(kind, origin=ORIGIN, calibration=None):
    columns = tuple(range(8 if kind == 3 else 6))
    return ForcePlate(1, kind, columns, CORNERS, origin, np.eye(6) if calibration is None else calibration)


def test_axes_of_the_corners():
    plate = _plate(2)
    np.testing.assert_allclose(plate.axes, np.diag([1, -1, -1]))
    np.testing.assert_allclose(plate.centre, [0.3, 0.2, 0])
    assert plate.vertical == 2


points = st.tuples(st.floats(-0.25, 0.25), st.floats(-0.15, 0.15))
forces = st.tuples(st.floats(-200, 200), st.floats(-200, 200), st.floats(-1500, -30))


@given(points, forces, st.floats(-20, 20))
def test_all_types_find_the_force_and_the_point_that_made_their_channels(point, force, free):
    force, at = np.array(force), np.array([*point, 0.0])
    about_surface = np.cross(at, force) + np.array([0, 0, free])
    about_sensors = np.cross(at + ORIGIN, force) + np.array([0, 0, free])
    calibration = np.diag([2.0, 2, 5, 0.5, 0.5, 0.25])
    channels = {
        1: [*force, *point, free],
        2: [*force, *about_sensors],
        4: [*(np.linalg.inv(calibration) @ [*force, *about_sensors])],
    }
    for kind, values in channels.items():
        plate = _plate(kind, calibration=calibration)
        units = ("N", "N", "N", "m", "m", "N m") if kind == 1 else ("N",) * 3 + ("N m",) * 3
        found, moment = plate.wrench(np.array([values]), units)
        np.testing.assert_allclose(found[0], force, atol=1e-9)
        np.testing.assert_allclose(moment[0], about_surface, atol=1e-9)
        np.testing.assert_allclose(centre_of_pressure(found, moment)[0], at, atol=1e-9)


@given(points, st.floats(-1500, -30))
def test_four_pillars_find_the_point_of_a_vertical_force(point, vertical):
    a, b = 0.12, 0.2
    along, across = point[0] / a, point[1] / b
    share = [
        (1 + along) * (1 + across),
        (1 - along) * (1 + across),
        (1 - along) * (1 - across),
        (1 + along) * (1 - across),
    ]
    values = np.array([[0, 0, 0, 0, *(vertical * one / 4 for one in share)]])
    force, moment = _plate(3, np.array([a, b, -0.05])).wrench(values, ("N",) * 8)
    assert force[0, 2] == pytest.approx(vertical)
    np.testing.assert_allclose(centre_of_pressure(force, moment)[0], [*point, 0], atol=1e-9)


def test_four_pillars_sum_the_shear_and_bring_its_moment_to_the_surface():
    values = np.array([[3.0, 7, 1, 4, -100, -100, -100, -100]])
    force, moment = _plate(3, np.array([0.12, 0.2, -0.05])).wrench(values, ("N",) * 8)
    np.testing.assert_allclose(force[0], [10, 5, -400])
    np.testing.assert_allclose(moment[0], [5 * -0.05, -10 * -0.05, 0.2 * 4 + 0.12 * -3], atol=1e-12)


def test_units_of_the_channels_count():
    force, moment = _plate(2, np.zeros(3)).wrench(
        np.array([[1.0, 2, 3, 4000, 5000, 6000]]), ("kN",) * 3 + ("N mm",) * 3
    )
    np.testing.assert_allclose(force, [[1000, 2000, 3000]])
    np.testing.assert_allclose(moment, [[4, 5, 6]])
