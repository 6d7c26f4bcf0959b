"""Flexion, adduction and rotation against matrices whose angles are known."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from gaitdisc.kinematics.pose import clinical_angles, rotation_of

HERE = np.eye(3)[None]


def about(axis: str, degrees: float) -> np.ndarray:
    return Rotation.from_euler(axis, degrees, degrees=True).as_matrix()[None]


@pytest.mark.parametrize(("axis", "column"), [("z", 0), ("x", 1), ("y", 2)])
def test_each_angle_is_a_turn_about_its_axis(axis, column):
    expected = np.zeros((1, 3))
    expected[0, column] = 20.0
    np.testing.assert_allclose(clinical_angles(HERE, about(axis, 20.0)), expected, atol=1e-12)


@settings(deadline=None)
@given(st.floats(-179, 179), st.floats(-89, 89), st.floats(-179, 179), st.integers(0, 2**32 - 1))
def test_angles_come_back_whatever_the_laboratory(flexion, adduction, rotation, seed):
    angles = np.array([[flexion, adduction, rotation]])
    proximal = Rotation.random(1, random_state=seed).as_matrix()
    np.testing.assert_allclose(clinical_angles(proximal, proximal @ rotation_of(angles)), angles, atol=1e-9)


def test_the_sequence_is_that_of_opensim():
    """Turned about z, then about the new x, then about the new y, as a hip of OpenSim is."""
    angles = np.array([[35.0, -12.0, 20.0]])
    expected = Rotation.from_euler("ZXY", angles, degrees=True).as_matrix()
    np.testing.assert_allclose(rotation_of(angles), expected, atol=1e-12)


def test_the_floating_axis_is_at_right_angles_to_both_fixed_ones():
    """Grood & Suntay's adduction: the angle between the distal long axis and the plane across the proximal z."""
    angles = np.array([[50.0, 17.0, -8.0]])
    distal = rotation_of(angles)[0]
    long_axis, hinge = distal[:, 1], np.array([0, 0, 1.0])
    np.testing.assert_allclose(np.degrees(np.arcsin(long_axis @ hinge)), 17.0, atol=1e-9)


def test_a_segment_that_is_unknown_has_no_angles():
    assert np.isnan(clinical_angles(HERE, np.full((1, 3, 3), np.nan))).all()
