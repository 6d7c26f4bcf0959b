from __future__ import annotations

import numpy as np
import pytest

from gaitdisc.batch.demonstration import DROP_DEG, FOUND_AS, PLANTED, planted
from gaitdisc.channel import Channel
from gaitdisc.clinic.rules import rules
from gaitdisc.errors import SchemaError
from gaitdisc.recording import Recording, Trial


def _trial():
    slow, quick = np.arange(400) / 100, np.arange(4000) / 1000
    angles = np.column_stack([30 - 30 * np.cos(2 * np.pi * slow), np.zeros_like(slow)])
    channels = (Channel("knee_angle_l", "angle", "deg", "l"), Channel("ankle_angle_l", "angle", "deg", "l"))
    load = 500.0 * (quick % 1.0 < 0.6)[:, None]
    force = Channel("ground_force_l_vy", "vertical_force", "N", "l")
    return Trial("a", {"kinematics": Recording(slow, angles, channels), "forces": Recording(quick, load, (force,))})


def test_a_stiff_knee_bends_less_in_swing_alone():
    knee = planted(_trial(), "stiff knee", "l").stream("kinematics")["knee_angle_l"]
    before = _trial().stream("kinematics")["knee_angle_l"]
    assert knee.max() == pytest.approx(40.0)
    np.testing.assert_array_equal(knee[before <= 20], before[before <= 20])


def test_a_foot_hangs_while_it_is_lifted_alone():
    ankle = planted(_trial(), "drop foot", "l").stream("kinematics")["ankle_angle_l"]
    assert ankle[180] == pytest.approx(-DROP_DEG, abs=0.1)
    assert ankle[130] == pytest.approx(0.0, abs=0.1)


def test_nothing_and_what_is_not_known():
    trial = _trial()
    assert planted(trial, "", "l") is trial
    with pytest.raises(SchemaError, match=r"stiff knee, drop.*'limp'"):
        planted(trial, "limp", "l")
    assert set(FOUND_AS) == set(PLANTED) and set(FOUND_AS.values()) <= {rule.name for rule in rules()}
