"""Markers of a recording as arrays, and the stillest half second."""

import numpy as np
import pytest

from gaitdisc.channel import Channel
from gaitdisc.errors import ChannelError
from gaitdisc.kinematics.markers import marker_labels, marker_places, still_places
from gaitdisc.recording import Recording


def recording(places: np.ndarray, labels: tuple[str, ...]) -> Recording:
    channels = tuple(Channel(f"{label}.{axis}", "marker", "m") for label in labels for axis in "xyz")
    return Recording(np.arange(len(places)) / 100, places.reshape(len(places), -1), channels)


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
