"""Markers as arrays, and the stillest half second; up, forward and the handedness of a frame."""

import numpy as np
import pytest
from changed_trials import markers_at
from scipy.spatial.transform import Rotation
from texts import says

from gaitdisc.channel import Channel
from gaitdisc.errors import ChannelError, ShapeError, StrideError
from gaitdisc.kinematics.markers import (
    check_right_handed,
    marker_labels,
    marker_places,
    still_places,
    up_axis,
    walking_frame,
)
from gaitdisc.recording import Recording


def recording(places: np.ndarray, labels: tuple[str, ...]) -> Recording:
    return markers_at(np.arange(len(places)) / 100, dict(zip(labels, places.swapaxes(0, 1), strict=True)))


def test_places_are_those_of_the_channels():
    places = np.random.default_rng(0).normal(size=(5, 2, 3))
    both = recording(places, ("A", "B"))
    assert marker_labels(both) == ["A", "B"]
    np.testing.assert_array_equal(marker_places(both, ["B", "A"]), places[:, ::-1])


def test_a_marker_is_seen_whole_or_not_at_all():
    places = np.zeros((2, 1, 3))
    places[1, 0, 2] = np.nan
    assert np.isnan(marker_places(recording(places, ("A",)), ["A"])[1]).all()


def test_a_recording_without_markers_is_refused():
    knee = Recording(np.arange(3) / 100, np.zeros((3, 1)), (Channel("knee_angle_r", "angle", "deg", "r"),))
    with pytest.raises(ChannelError, match="the recording has knee_angle_r"):
        marker_labels(knee)


def test_the_stillest_half_second_is_taken():
    """Who moves at 1 m/s for a second, stands for one, and moves on, stands where the second second has them."""
    along = np.concatenate([np.linspace(-1, 0, 100), np.zeros(100), np.linspace(0, 1, 100)])
    places = np.zeros((300, 2, 3))
    places[:, :, 0] = along[:, None]
    found, moved, start = still_places(recording(places, ("A", "B")), {"a": "A", "b": "B"}, ["a", "b"])
    assert moved == 0
    assert 1.0 <= start <= 1.5
    np.testing.assert_array_equal(found["a"], 0)


def test_how_far_the_markers_move_is_in_metres():
    places = np.zeros((50, 1, 3))
    places[:, 0, 1] = np.linspace(0, 0.5, 50)
    _, moved, _ = still_places(recording(places, ("A",)), {"a": "A"}, ["a"])
    np.testing.assert_allclose(moved, 0.25)


UP = np.array([0.0, 0.0, 1.0])


def path(velocity, seconds: float = 3.0, sway: float = 0.02) -> np.ndarray:
    time = np.arange(0, seconds, 0.01)
    across = np.cross(UP, velocity) / max(np.linalg.norm(velocity), 1e-9)
    return time[:, None] * np.asarray(velocity) + sway * np.sin(2 * np.pi * time)[:, None] * across + 0.9 * UP


def facing(direction, frames: int) -> np.ndarray:
    return np.tile(np.asarray(direction, float), (frames, 1))


@pytest.mark.parametrize("axis", range(3))
@pytest.mark.parametrize("sign", [1, -1])
def test_up_is_where_the_pelvis_is_above_the_feet(axis, sign):
    expected = np.zeros(3)
    expected[axis] = sign
    pelvis = np.array([[0.1, 0.1, 0.1], [np.nan, 0, 0]]) + 0.9 * expected
    np.testing.assert_array_equal(up_axis(pelvis, np.full((2, 3), 0.1)), expected)


def test_a_tilted_frame_and_a_trial_that_never_shows_pelvis_and_feet_are_refused():
    with pytest.raises(ShapeError, match=r"lying\.c3d.*\(0, 0\.6, 0\.7\) m"):
        up_axis(np.array([[0, 0.6, 0.7]]), np.zeros((1, 3)), "lying.c3d")
    with pytest.raises(ShapeError, match=r"a\.c3d.*none"):
        up_axis(np.full((2, 3), np.nan), np.zeros((2, 3)), "a.c3d")


def test_a_mirrored_pelvis_is_refused():
    mirrored = np.diag([1.0, -1.0, 1.0])[None]
    with pytest.raises(ShapeError, match=r"frame is mirrored.*left.*right"):
        check_right_handed(mirrored, np.array([0.0, 1.0, 0.0]), "a.c3d")
    check_right_handed(np.eye(3)[None], np.array([0.0, 1.0, 0.0]))


@pytest.mark.parametrize("velocity", [(1.2, 0, 0), (0, -1.0, 0), (0.6, 0.8, 0)])
def test_forward_is_along_a_straight_path(velocity):
    origin = path(velocity)
    frame = walking_frame(origin, facing(np.array(velocity), len(origin)), UP, 100.0)
    forward = np.asarray(velocity) / np.linalg.norm(velocity)
    assert np.degrees(np.arccos(np.clip(frame.rotation[:, :, 0] @ forward, -1, 1))).max() < 1.0  # of sway
    np.testing.assert_allclose(frame.rotation[:, :, 2], np.cross(frame.rotation[:, :, 0], frame.rotation[:, :, 1]))
    np.testing.assert_allclose(np.linalg.det(frame.rotation), 1)
    assert says(frame.how, "forward is along the")


def test_gaps_of_the_pelvis_do_not_turn_forward():
    origin = path((1.2, 0, 0))
    origin[50:80] = np.nan
    frame = walking_frame(origin, facing((1, 0, 0), len(origin)), UP, 100.0)
    assert frame.rotation[:, 0, 0].min() > 0.9998


def test_forward_turns_with_the_path():
    """A quarter of a circle at 1 m/s and 2 m radius: 90 deg in 3.14 s."""
    angle = np.arange(0, np.pi / 2, 0.005)
    origin = 2 * np.stack([np.sin(angle), 1 - np.cos(angle), 0 * angle], axis=1)
    along = np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
    frame = walking_frame(origin, along, UP, 100.0)
    inside = slice(50, -50)
    np.testing.assert_allclose(frame.rotation[inside, :, 0], along[inside], atol=1e-9)
    assert "the path turns by" in frame.how


def test_on_a_treadmill_forward_is_where_the_pelvis_faces():
    origin = path((0, 0, 0))
    origin[:, 0] += 0.05 * np.sin(np.arange(len(origin)) / 30)
    yaw = Rotation.from_euler("z", 10 * np.sin(2 * np.pi * np.arange(300) / 100)[:, None], degrees=True)
    frame = walking_frame(origin, yaw.apply([0.0, 1.0, -0.2]), UP, 100.0)
    np.testing.assert_allclose(frame.rotation[:, :, 0], facing((0, 1, 0), 300), atol=1e-9)
    assert "stays in place" in frame.how


def test_who_walks_backwards_still_has_forward_before_the_face():
    origin = path((-1.0, 0, 0))
    frame = walking_frame(origin, facing((1, 0, 0), len(origin)), UP, 100.0)
    assert frame.rotation[:, 0, 0].min() > 0.9998
    assert "backwards" in frame.how


def test_a_trial_shorter_than_a_second_has_its_mean_path():
    origin = path((0, 1.2, 0), 0.6, 0.0)
    frame = walking_frame(origin, facing((0, 1, 0), 60), UP, 100.0)
    np.testing.assert_allclose(frame.rotation[:, 1, 0], 1, atol=1e-9)


def test_a_given_direction_is_made_level():
    frame = walking_frame(np.zeros((2, 3)), np.zeros((2, 3)), UP, 100.0, (0, -3, 0.3))
    np.testing.assert_allclose(frame.rotation[:, :, 0], [[0, -1, 0]] * 2, atol=1e-12)


@pytest.mark.parametrize("given", [(0, 0, 0), (0, 0, 1), (1, 0), (np.nan, 0, 0)])
def test_a_direction_that_is_none_is_refused(given):
    with pytest.raises(StrideError, match="horizontal vector of three numbers"):
        walking_frame(np.zeros((2, 3)), np.zeros((2, 3)), UP, 100.0, given)


def test_a_pelvis_that_is_never_seen_is_refused():
    with pytest.raises(StrideError, match="must have the pelvis markers; none has"):
        walking_frame(np.full((2, 3), np.nan), np.zeros((2, 3)), UP, 100.0)
