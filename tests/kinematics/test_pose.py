"""Poses: rotations, angles of Cardan, rigid bodies from their markers, joint centres against published equations."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from gaitdisc.errors import ShapeError
from gaitdisc.ingest.c3d_parameters import read_body_measures
from gaitdisc.ingest.reading import read_trial
from gaitdisc.kinematics.pose import (
    Pose,
    chord_centre,
    clinical_angles,
    davis_hip,
    fit_pose,
    harrington_hip,
    hip_of_spines,
)


@settings(deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_points_come_back_from_the_laboratory(seed):
    random = np.random.default_rng(seed)
    pose = Pose(random.normal(size=(7, 3)), Rotation.random(7, random_state=seed).as_matrix())
    points = random.normal(size=(4, 3))
    there = pose.to_laboratory(points)
    assert there.shape == (7, 4, 3)
    np.testing.assert_allclose(pose.to_segment(there), np.broadcast_to(points, (7, 4, 3)), atol=1e-12)
    one = pose.to_laboratory(points[0])
    np.testing.assert_allclose(one, there[:, 0], atol=1e-12)
    np.testing.assert_allclose(pose.to_segment(one), np.broadcast_to(points[0], (7, 3)), atol=1e-12)


def test_the_columns_are_the_axes():
    heading = Rotation.from_euler("y", 90, degrees=True).as_matrix()[None]  # forward x becomes laboratory -z
    pose = Pose(np.zeros((1, 3)), heading)
    np.testing.assert_allclose(pose.to_laboratory(np.array([1.0, 0.0, 0.0])), [[0.0, 0.0, -1.0]], atol=1e-15)


def test_frames_that_are_unknown_stay_so():
    rotation = np.tile(np.eye(3), (3, 1, 1))
    rotation[1] = np.nan
    origin = np.zeros((3, 3))
    origin[2, 0] = np.nan
    pose = Pose(origin, rotation)
    assert pose.known.tolist() == [True, False, False]
    assert np.isnan(pose.to_laboratory(np.ones(3))[1]).all()


def test_arrays_are_read_only():
    pose = Pose(np.zeros((1, 3)), np.eye(3)[None])
    assert len(pose) == 1
    with pytest.raises(ValueError, match="read-only"):
        pose.origin[0, 0] = 1.0


def test_frames_that_are_mirrored_or_stretched_or_do_not_fit_are_refused():
    mirrored = np.tile(np.eye(3), (2, 1, 1))
    mirrored[1] = np.diag([1.0, 1.0, -1.0])
    with pytest.raises(ShapeError, match=r"frame 1.*-1.*right"):
        Pose(np.zeros((2, 3)), mirrored)
    with pytest.raises(ShapeError, match=r"1 by up to 0\.21"):
        Pose(np.zeros((1, 3)), np.diag([1.1, 1.0, 1.0])[None])
    with pytest.raises(ShapeError, match=r"\(2, 3\).*\(3, 3, 3\)"):
        Pose(np.zeros((2, 3)), np.tile(np.eye(3), (3, 1, 1)))


HERE = np.eye(3)[None]


def about(axis: str, degrees: float) -> np.ndarray:
    return Rotation.from_euler(axis, degrees, degrees=True).as_matrix()[None]


@pytest.mark.parametrize(("axis", "column"), [("z", 0), ("x", 1), ("y", 2)])
def test_each_angle_is_a_turn_about_its_axis(axis, column):
    expected = np.zeros((1, 3))
    expected[0, column] = 20.0
    np.testing.assert_allclose(clinical_angles(HERE, about(axis, 20.0)), expected, atol=1e-12)


def turned(angles):
    return Rotation.from_euler("ZXY", angles, degrees=True).as_matrix()


@settings(deadline=None)
@given(st.floats(-179, 179), st.floats(-89, 89), st.floats(-179, 179), st.integers(0, 2**32 - 1))
def test_angles_come_back_whatever_the_laboratory(flexion, adduction, rotation, seed):
    """Turned about z, then about the new x, then about the new y, as a hip of OpenSim is."""
    angles = np.array([[flexion, adduction, rotation]])
    proximal = Rotation.random(1, random_state=seed).as_matrix()
    np.testing.assert_allclose(clinical_angles(proximal, proximal @ turned(angles)), angles, atol=1e-9)


def test_the_floating_axis_is_at_right_angles_to_both_fixed_ones():
    """Grood & Suntay's adduction: the angle between the distal long axis and the plane across the proximal z."""
    angles = np.array([[50.0, 17.0, -8.0]])
    distal = turned(angles)[0]
    long_axis, hinge = distal[:, 1], np.array([0, 0, 1.0])
    np.testing.assert_allclose(np.degrees(np.arcsin(long_axis @ hinge)), 17.0, atol=1e-9)


def test_a_segment_that_is_unknown_has_no_angles():
    assert np.isnan(clinical_angles(HERE, np.full((1, 3, 3), np.nan))).all()


BODY = np.array([[0, 0, 0], [0.1, 0.02, 0], [0.0, 0.2, 0.01], [0.03, 0.1, 0.08], [-0.05, 0.15, 0.02]])


def moved(seed: int, frames: int = 12) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    random = np.random.default_rng(seed)
    rotation = Rotation.random(frames, random_state=seed).as_matrix()
    origin = random.normal(size=(frames, 3))
    return origin, rotation, origin[:, None] + np.einsum("fij,pj->fpi", rotation, BODY)


@settings(deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_pose_comes_back(seed):
    origin, rotation, places = moved(seed)
    fit = fit_pose(BODY, places)
    np.testing.assert_allclose(fit.pose.rotation, rotation, atol=1e-9)
    np.testing.assert_allclose(fit.pose.origin, origin, atol=1e-9)
    np.testing.assert_allclose(fit.residual_m, 0, atol=1e-9)


@settings(deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_any_three_markers_carry_the_others(seed):
    origin, rotation, places = moved(seed)
    random = np.random.default_rng(seed)
    for frame in range(len(places)):
        places[frame, random.permutation(5)[: random.integers(0, 3)]] = np.nan
    fit = fit_pose(BODY, places)
    np.testing.assert_allclose(fit.pose.rotation, rotation, atol=1e-9)
    np.testing.assert_allclose(fit.pose.origin, origin, atol=1e-9)


def test_two_markers_tell_no_pose():
    _, _, places = moved(1)
    places[3, :3] = np.nan
    fit = fit_pose(BODY, places)
    assert fit.pose.known.tolist() == [frame != 3 for frame in range(12)]
    assert np.isnan(fit.residual_m[3])


def test_three_markers_on_a_line_tell_no_pose():
    line = np.array([[0, 0, 0], [0, 0.1, 0], [0, 0.2, 0], [0.1, 0, 0]])
    places = np.tile(line, (2, 1, 1))
    places[1, 3] = np.nan
    assert fit_pose(line, places).pose.known.tolist() == [True, False]


def test_a_mirrored_body_is_not_followed_into_the_mirror():
    _, _, places = moved(2)
    fit = fit_pose(BODY * [1, 1, -1], places)
    np.testing.assert_allclose(np.linalg.det(fit.pose.rotation), 1, atol=1e-12)
    assert (fit.residual_m > 0.01).all()


def test_the_fit_is_the_least_of_squares():
    """Turning the body a little to any side from the fit makes the squares larger."""
    random = np.random.default_rng(3)
    _, _, places = moved(3, 1)
    places = places + 0.01 * random.normal(size=places.shape)
    fit = fit_pose(BODY, places)
    best = fit.residual_m[0]
    middle = places[0].mean(axis=0)
    centred = BODY - BODY.mean(axis=0)
    for turn in Rotation.random(50, random_state=4):
        little = Rotation.from_rotvec(0.01 * turn.as_rotvec()).as_matrix()
        apart = places[0] - middle - centred @ (little @ fit.pose.rotation[0]).T
        assert np.sqrt((apart**2).sum() / 5) > best


def test_residual_is_the_distance_of_the_markers():
    """Of a square two opposite corners move out by 1 mm and two in: nothing turns, each is 1 mm off."""
    square = np.array([[1, 0, 0], [0, 1, 0], [-1, 0, 0], [0, -1, 0.0]]) * 0.1
    places = (square * np.array([1.01, 0.99, 1.01, 0.99])[:, None])[None]
    np.testing.assert_allclose(fit_pose(square, places).residual_m, 1e-3, rtol=1e-9)


def test_harrington_has_the_numbers_of_the_paper():
    """x = -0.24 PD - 9.9, y = -0.30 PW - 10.9, z = 0.33 PW + 7.3 mm, for PW 240 mm and PD 150 mm."""
    np.testing.assert_allclose(harrington_hip(0.240, 0.150, "r"), [-0.0459, -0.0829, 0.0865], atol=1e-12)
    np.testing.assert_allclose(harrington_hip(0.240, 0.150, "l"), [-0.0459, -0.0829, -0.0865], atol=1e-12)


@pytest.mark.parametrize("side", ["l", "r"])
def test_the_hip_goes_with_the_pelvis(side):
    """Spines 240 mm apart and 150 mm deep, turned by 30 deg and carried: the same point of the pelvis."""
    turn = np.array(
        [
            [math.cos(math.pi / 6), 0, math.sin(math.pi / 6)],
            [0, 1, 0],
            [-math.sin(math.pi / 6), 0, math.cos(math.pi / 6)],
        ]
    )
    spines = np.array([[0, 0, -0.12], [0, 0, 0.12], [-0.15, 0, 0]])
    frames = np.stack([spines, spines @ turn.T + 1.0])
    found = hip_of_spines(*np.swapaxes(frames, 0, 1), side)
    point = harrington_hip(0.240, 0.150, side)
    np.testing.assert_allclose(found, [point, turn @ point + 1.0], atol=1e-12)


@pytest.mark.parametrize("person", ["HC030A", "HC031A"])
def test_hips_are_where_a_laboratory_s_own_model_has_them(gait_data, person):
    """The static files hold hips by Harrington and by Davis, computed by the laboratory's software."""
    path = gait_data / "young_static" / person / f"{person}01.c3d"
    markers, measures = read_trial(path).stream("markers"), read_body_measures(path)
    place = {
        name: np.stack([markers[f"{name}.{axis}"] for axis in "xyz"], axis=1)
        for name in ("LASI", "RASI", "SACR", "LHJC", "RHJC", "LHJCHarrington", "RHJCHarrington")
    }
    middle = (place["LASI"] + place["RASI"]) / 2
    right = place["RASI"] - place["LASI"]
    up = np.cross(right, middle - place["SACR"])
    right, up = (v / np.linalg.norm(v, axis=1, keepdims=True) for v in (right, up))
    axes = np.stack([np.cross(up, right), up, right], axis=2)
    depth = float(np.median(np.linalg.norm(middle - place["SACR"], axis=1)))
    width, legs = measures.inter_asis_m, measures.leg_length_m
    assert width is not None
    assert measures.marker_diameter_m is not None
    for side in "lr":
        davis = davis_hip(width, (legs["l"] + legs["r"]) / 2, legs[side], measures.marker_diameter_m / 2, side)
        for name, ours in (("HJCHarrington", harrington_hip(width, depth, side)), ("HJC", davis)):
            theirs = np.einsum("fji,fj->fi", axes, place[f"{side.upper()}{name}"] - middle)
            np.testing.assert_allclose(ours, np.median(theirs, axis=0), atol=1e-3, err_msg=f"{side} {name}")


def test_chord_makes_a_right_angle_in_the_plane():
    random = np.random.default_rng(0)
    for _ in range(20):
        hip, wand, lateral = random.normal(size=(3, 3))
        centre = chord_centre(hip, wand, lateral, 0.05)
        assert math.isclose(np.linalg.norm(lateral - centre), 0.05, rel_tol=1e-9)
        assert abs((hip - centre) @ (lateral - centre)) < 1e-9
        assert abs(np.cross(wand - hip, lateral - hip) @ (centre - hip)) < 1e-9
        across = np.cross(np.cross(wand - hip, lateral - hip), lateral - hip)
        assert (wand - hip) @ across * ((centre - hip) @ across) < 0  # on the side away from the wand


def test_a_marker_inside_of_the_joint_and_a_wand_on_the_line_are_refused():
    with pytest.raises(ShapeError, match=r"0\.05 m.*0\.06 m"):
        chord_centre(np.zeros(3), np.array([0, 0, 0.1]), np.array([0, -0.05, 0]), 0.06)
    with pytest.raises(ShapeError, match="0 m off the line"):
        chord_centre(np.zeros(3), np.array([0, -0.2, 0]), np.array([0, -0.4, 0]), 0.06)
