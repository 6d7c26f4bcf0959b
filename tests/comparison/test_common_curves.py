from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from texts import says

from gaitdisc.channel import Channel
from gaitdisc.comparison.common_curves import common_curves
from gaitdisc.errors import ChannelError
from gaitdisc.recording import Finding
from gaitdisc.results.pooled_cycles import STRIDE_COLUMNS, WalkSummary

NO_STRIDES = pd.DataFrame(columns=pd.Index(STRIDE_COLUMNS))


def summary(name, strides=10, units=None, seed=0):
    units = units or {"hip_flexion_r": "deg", "ankle_angle_r": "deg"}
    curves = np.random.default_rng(seed).normal(size=(strides, 101, len(units)))
    channels = tuple(Channel(key, "angle", unit, "r") for key, unit in units.items())
    return WalkSummary("", name, 10.0, 100.0, "angles", channels, curves, NO_STRIDES, (), {})


def test_channels_that_one_lacks_and_other_units_are_left_out_and_said():
    one = summary("sim", units={"hip_flexion_r": "deg", "ankle_angle_r_moment": "N m", "knee_angle_r": "deg"})
    other = summary("measured", units={"hip_flexion_r": "deg", "ankle_angle_r_moment": "N m/kg"}, seed=1)
    found = common_curves((one, other))
    assert [c.name for c in found.channels] == ["hip_flexion_r"]
    said = [finding.line() for finding in found.findings]
    assert any(says(line, "measured: not", "no knee_angle_r") for line in said)
    assert any(says(line, "ankle_angle_r_moment", "'N m'", "'N m/kg'") for line in said)


def test_nothing_in_common_is_refused_in_words():
    one, other = summary("sim", units={"hip_flexion_r": "deg"}), summary("measured", units={"knee_angle_r": "deg"})
    with pytest.raises(ChannelError, match=r"sim.*measured.*1.*1 channels, none"):
        common_curves((one, other))
    with pytest.raises(ChannelError, match=r"'hip_flexion_r'.*to be compared; measured"):
        common_curves((one, other), ("hip_flexion_r",))


def test_locked_and_repeated_channels_are_left_out():
    walks = []
    for name, seed in (("a", 0), ("b", 1)):
        walk = summary(name, units={"hip_flexion_r": "deg", "mtp_angle_r": "deg", "knee_angle_r": "deg"}, seed=seed)
        curves = np.array(walk.curves)
        curves[:, :, 1], curves[:, :, 2] = 4.0, curves[:, :, 0]
        walks.append(replace(walk, curves=curves))
    found = common_curves(walks)
    assert [c.name for c in found.channels] == ["hip_flexion_r"]
    still, repeated = (f.what for f in found.findings)
    assert says(still, "mtp_angle_r") and says(repeated, "knee_angle_r", "repeat")


def test_frozen_channels_are_compared_only_when_asked_for():
    frozen = Finding("warning", "frozen", "a.mot", "one value for 9 s", "", "ankle_angle_r")
    walks = replace(summary("a"), findings=(frozen,)), summary("b", seed=1)
    assert [c.name for c in common_curves(walks).channels] == ["hip_flexion_r"]
    assert "ankle_angle_r (frozen):" in common_curves(walks).findings[0].what
    assert [c.name for c in common_curves(walks, ("ankle_angle_r",)).channels] == ["ankle_angle_r"]


def test_a_stride_with_a_gap_is_left_out_and_a_channel_full_of_gaps_too():
    walk = summary("a")
    curves = np.array(walk.curves)
    curves[3, 50, 0] = np.nan
    curves[:8, 20, 1] = np.nan
    found = common_curves((replace(walk, curves=curves), summary("b", 7, seed=1)))
    assert [c.name for c in found.channels] == ["hip_flexion_r"]
    assert [len(c) for c in found.curves] == [9, 7]
    assert any(says(f.what, "8 of 10 strides") for f in found.findings)


def test_headings_on_either_side_of_180_deg_are_neighbours():
    one, other = (summary(name, units={"pelvis_rotation": "deg", "hip_flexion_r": "deg"}, seed=0) for name in "ab")
    one, other = replace(one, curves=one.curves + 178), replace(other, curves=other.curves - 179)
    found = common_curves((one, other))
    gap = found.curves[0].mean(axis=(0, 1)) - found.curves[1].mean(axis=(0, 1))
    np.testing.assert_allclose(gap, [-3.0, 357.0], atol=1e-9)  # a hip does not come round
