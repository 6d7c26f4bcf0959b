from __future__ import annotations

import numpy as np

from gaitdisc.channel import Channel, vocabulary
from gaitdisc.processing.pelvis_and_foot import PLUG_IN_GAIT, with_pelvis_and_foot
from gaitdisc.recording import Recording

LABELS = ("RPelvisAngles.x", "LPelvisAngles.y", "RPelvisAngles.z", "RFootProgressAngles.z", "LFootProgressAngles.z")


def _recording(*labels, unit="deg"):
    values = np.arange(1.0, 4.0)[:, None] * np.arange(1, len(labels) + 1)
    suspect = np.zeros(values.shape, bool)
    suspect[1, 0] = True
    quantity = "angle" if unit == "deg" else "signal"
    channels = tuple(Channel(label, quantity, unit) for label in labels)
    return Recording(np.arange(3) / 100, values, channels, suspect=suspect)


def test_plug_in_gait_tilts_forwards_and_the_house_backwards():
    found = with_pelvis_and_foot(_recording(*LABELS))
    assert found.names == (*LABELS, *PLUG_IN_GAIT)
    np.testing.assert_allclose(found["pelvis_tilt"], [-1.0, -2.0, -3.0])
    np.testing.assert_allclose(found["pelvis_list"], [2.0, 4.0, 6.0])
    np.testing.assert_allclose(found["foot_progression_angle_l"], [5.0, 10.0, 15.0])
    assert found.channels[-1] == vocabulary().named("foot_progression_angle_l")
    assert found.suspect[:, 5].tolist() == [False, True, False]


def test_what_is_there_already_stays_and_numbers_without_a_unit_are_no_angle():
    own = _recording("RPelvisAngles.x", "pelvis_tilt")
    assert with_pelvis_and_foot(own).names == own.names
    bare = _recording(*LABELS, unit="1")
    assert with_pelvis_and_foot(bare).names == LABELS
