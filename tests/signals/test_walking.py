from __future__ import annotations

import numpy as np
import pytest
from texts import says

from gaitdisc.errors import StrideError
from gaitdisc.recording import Strides
from gaitdisc.signals.contact_movement import angle_contacts
from gaitdisc.signals.strides import cut_strides
from gaitdisc.signals.walking import measured_walking, verify_walking


def strides_of(contacts):
    return Strides(contacts[:-1], contacts[1:], "r", "force")


def test_a_made_walk_is_walking(made):
    walk, contacts = made.walk(20)
    found = verify_walking(walk, strides_of(contacts))
    assert found.strides == 20
    assert found.stride_s == pytest.approx(1.1, abs=0.02)
    assert found.coverage > 0.95
    assert found.regularity > 0.95
    assert found.knee_deg > 45


def test_what_is_not_walking_is_refused_with_its_numbers(made):
    walk, contacts = made.walk(20)
    rng = np.random.default_rng(0)
    still = walk.with_values(walk.values * 0 + np.cumsum(rng.normal(size=walk.values.shape), axis=0) / 5)
    with pytest.raises(StrideError) as refusal:
        verify_walking(still, strides_of(contacts[:3]))
    assert says(refusal.value.needed, "3 strides", "60 %")
    for words in ("2 strides where 3", "strides cover 10 % of", "repeat with a correlation of", "a knee moves"):
        assert words in refusal.value.found


def test_a_short_walk_over_ground_is_judged_without_regularity(made):
    walk, contacts = made.walk(2)
    found = measured_walking(walk, strides_of(contacts))
    assert np.isnan(found.regularity)
    assert verify_walking(walk, strides_of(contacts), fewest=1).strides == 2


def test_real_walks_pass_and_range_of_motion_trials_do_not(gait_data, real):
    trials = real.treadmill_walks(gait_data)
    trials["S01DN603"] = real.mot(gait_data / "treadmill_walk_ik" / "S01DN603_ik.mot")
    for name, trial in trials.items():
        strides = cut_strides(angle_contacts(trial)["r"], trial)
        if name in ("S01DE503", "S01DN603"):
            with pytest.raises(StrideError, match=r"3.*needed; strides cover [38] %"):
                verify_walking(trial, strides)
        else:
            assert verify_walking(trial, strides).regularity > 0.8
