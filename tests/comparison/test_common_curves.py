"""What two walks have in common: channels, whole strides, a shift."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from texts import says

from gaitdisc.channel import Channel
from gaitdisc.cohort.cohort import make_walks
from gaitdisc.cohort.person import draw_one
from gaitdisc.comparison.common_curves import align, common_curves, common_shift, shift_curves
from gaitdisc.errors import ChannelError
from gaitdisc.ingest.reading import read_trial
from gaitdisc.processing.pooled_cycles import STRIDE_COLUMNS, WalkSummary
from gaitdisc.processing.walk_pair import walk_pair
from gaitdisc.recording import PERCENT, Finding

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
    assert any(says(line, "measured: not", "lacks knee_angle_r") for line in said)
    assert any(says(line, "ankle_angle_r_moment", "'N m'", "'N m/kg'") for line in said)


def test_nothing_in_common_is_refused_in_words():
    one, other = summary("sim", units={"hip_flexion_r": "deg"}), summary("measured", units={"knee_angle_r": "deg"})
    with pytest.raises(ChannelError, match=r"sim.*measured.*1.*1 channels, but share no"):
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
    assert says(still, "mtp_angle_r") and says(repeated, "identical", "knee_angle_r")


def test_frozen_channels_are_compared_only_when_asked_for():
    frozen = Finding("warning", "frozen", "a.mot", "one value for 9 s", "", "ankle_angle_r")
    walks = replace(summary("a"), findings=(frozen,)), summary("b", seed=1)
    assert [c.name for c in common_curves(walks).channels] == ["hip_flexion_r"]
    assert "ankle_angle_r (frozen);" in common_curves(walks).findings[0].what
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


CURVES = np.stack(
    [np.cos(2 * np.pi * k * PERCENT / 100 + k) + 0.3 * np.sin(np.pi * PERCENT / 25) for k in (1, 2, 3)], 1
)


@pytest.mark.parametrize("planted", [-10.0, -3.0, 0.0, 3.3, 7.0])
def test_a_planted_shift_is_found_whatever_offsets_there_are(planted):
    found = common_shift(shift_curves(CURVES, -planted) + np.array([5.0, -3.0, 0.0]), CURVES)
    assert found.percent == pytest.approx(planted, abs=0.1)
    assert found.applied is (planted != 0)
    assert found.agreeing == found.channels == 3


def test_one_joint_that_turns_later_is_no_common_shift():
    late = np.array(CURVES)
    late[:, 1] = shift_curves(CURVES, 6.0)[:, 1]
    found = common_shift(late, CURVES)
    assert not found.applied


def test_channels_that_disagree_or_are_few_share_none():
    each = np.stack([shift_curves(CURVES, by)[:, k] for k, by in enumerate((-8.0, 0.0, 7.0))], axis=1)
    assert not common_shift(each, CURVES).applied
    assert not common_shift(shift_curves(CURVES, 5.0)[:, :2], CURVES[:, :2]).applied


def test_a_stride_is_closed():
    np.testing.assert_allclose(shift_curves(shift_curves(CURVES, 4.0), -4.0)[:-1], CURVES[:-1], atol=1e-12)
    [moved] = align([np.stack([CURVES, CURVES + 1])], 4.0)
    np.testing.assert_allclose(moved[1], shift_curves(CURVES, 4.0) + 1)


def test_another_person_whose_marks_lie_apart_is_moved_by_as_much(gait_data):
    """Two walkers: the channels' own best shifts scatter by 10 % of the stride, together they find what was planted."""
    trials = [
        read_trial(gait_data / "treadmill_walk_ik" / "S01DE504_ik.mot"),
        make_walks(draw_one("P60000", 60000, "f"), 15.0).trials["nominal"],
    ]
    first, second = (one.mean(axis=0) for one in common_curves(walk_pair(*trials)).curves)
    as_they_are = common_shift(first, second)
    assert not as_they_are.applied and abs(as_they_are.percent) < 4
    found = common_shift(shift_curves(first, -8.7), second)
    assert found.applied and found.agreeing >= 0.6 * found.channels
    assert found.percent - as_they_are.percent == pytest.approx(8.7, abs=0.4)
    np.testing.assert_allclose(found.otherwise, np.abs(shift_curves(first, -8.7) - second).max(axis=0))
