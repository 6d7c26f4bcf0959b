"""Foot off from a path that is known, and from real files against their own events."""

from __future__ import annotations

import numpy as np
import pytest

from gaitdisc.channel import Channel
from gaitdisc.recording import Recording
from gaitdisc.signals.contact_movement import angle_foot_off, marker_foot_off, stance_windows
from gaitdisc.signals.direction import given_direction

OFFS = np.array([0.62, 1.637, 2.65])
TIME = np.arange(330) / 100


def _dips(at, depth=0.4):
    """Deepest at each time, smooth between."""
    return -depth * np.exp(-(((TIME[:, None] - at) / 0.12) ** 2)).sum(axis=1)


def _toe(speed=1.2):
    toe = np.column_stack([speed * TIME + _dips(OFFS), 0 * TIME, 0 * TIME])
    pelvis = np.column_stack([speed * TIME, 0 * TIME, 0 * TIME + 0.9])
    channels = tuple(Channel(f"{name}.{axis}", "marker", "m") for name in ("RTOE", "SACR") for axis in "xyz")
    return Recording(TIME, np.hstack([toe, pelvis]), channels)


def test_a_window_lies_in_the_stance_after_each_contact_and_before_the_first():
    assert stance_windows(np.array([1.0, 2.0]), 1.0) == [(0.25, 0.85), (1.25, 1.85), (2.25, 2.85)]
    assert np.array(stance_windows(np.array([0.0, 2.0]), 2.0)) == pytest.approx(
        np.array([(-1.5, -0.3), (0.5, 1.7), (2.5, 3.7)])
    )
    assert stance_windows(np.empty(0), 1.0) == []


def test_the_toe_leaves_where_it_is_farthest_behind():
    windows = stance_windows(np.array([1.0, 2.0]), 1.0)
    found = marker_foot_off(_toe(), "RTOE", ["SACR"], given_direction((1, 0, 0)), windows)
    assert np.abs(found - OFFS).max() < 0.002  # between the samples, which are 0.01 s apart


def test_walking_the_other_way_has_no_such_time():
    windows = stance_windows(np.array([1.0, 2.0]), 1.0)
    found = marker_foot_off(_toe(), "RTOE", ["SACR"], given_direction((-1, 0, 0)), windows)
    assert not any(np.abs(found - at).min() < 0.05 for at in OFFS) if len(found) else True


def test_a_gap_in_the_window_gives_none():
    toe = _toe()
    values = toe.values.copy()
    values[140:200] = np.nan
    windows = stance_windows(np.array([1.0, 2.0]), 1.0)
    found = marker_foot_off(toe.with_values(values), "RTOE", ["SACR"], given_direction((1, 0, 0)), windows)
    assert found == pytest.approx(OFFS[[0, 2]], abs=0.002)


def test_the_ankle_is_most_plantarflexed_about_then():
    ankle = Recording(TIME, _dips(OFFS, 20.0)[:, None], (Channel("ankle_angle_r", "angle", "deg", "r"),))
    found = angle_foot_off(ankle, "ankle_angle_r", stance_windows(np.array([1.0, 2.0]), 1.0))
    assert found == pytest.approx(OFFS, abs=0.005)
