import numpy as np
import pytest

from gaitdisc.cohort.cohort import walks_of
from gaitdisc.cohort.person import drawn
from gaitdisc.comparison.common_curves import aligned, common_curves, common_shift, shifted
from gaitdisc.ingest.reading import read_trial
from gaitdisc.processing.walk_pair import walk_pair
from gaitdisc.recording import PERCENT

CURVES = np.stack(
    [np.cos(2 * np.pi * k * PERCENT / 100 + k) + 0.3 * np.sin(2 * np.pi * PERCENT / 50) for k in (1, 2, 3)], 1
)


@pytest.mark.parametrize("planted", [-10.0, -3.0, 0.0, 3.3, 7.0])
def test_a_planted_shift_is_found_whatever_offsets_there_are(planted):
    found = common_shift(shifted(CURVES, -planted) + np.array([5.0, -3.0, 0.0]), CURVES)
    assert found.percent == pytest.approx(planted, abs=0.1)
    assert found.applied is (planted != 0)
    assert found.agreeing == found.channels == 3


def test_one_joint_that_turns_later_is_no_common_shift():
    late = np.array(CURVES)
    late[:, 1] = shifted(CURVES, 6.0)[:, 1]
    found = common_shift(late, CURVES)
    assert not found.applied


def test_channels_that_disagree_or_are_few_share_none():
    each = np.stack([shifted(CURVES, by)[:, k] for k, by in enumerate((-8.0, 0.0, 7.0))], axis=1)
    assert not common_shift(each, CURVES).applied
    assert not common_shift(shifted(CURVES, 5.0)[:, :2], CURVES[:, :2]).applied


def test_a_stride_is_closed():
    np.testing.assert_allclose(shifted(shifted(CURVES, 4.0), -4.0)[:-1], CURVES[:-1], atol=1e-12)
    [moved] = aligned([np.stack([CURVES, CURVES + 1])], 4.0)
    np.testing.assert_allclose(moved[1], shifted(CURVES, 4.0) + 1)


def test_another_person_whose_marks_lie_apart_is_moved_by_as_much(gait_data):
    """Two walkers: the channels' own best shifts scatter by 10 % of the stride, together they find what was planted."""
    trials = [
        read_trial(gait_data / "treadmill_walk_ik" / "S01DE504_ik.mot"),
        walks_of(drawn("P60000", 60000, "f"), 15.0).trials["nominal"],
    ]
    first, second = (one.mean(axis=0) for one in common_curves(walk_pair(*trials)).curves)
    as_they_are = common_shift(first, second)
    assert not as_they_are.applied and abs(as_they_are.percent) < 4
    found = common_shift(shifted(first, -8.7), second)
    assert found.applied and found.agreeing >= 0.6 * found.channels
    assert found.percent - as_they_are.percent == pytest.approx(8.7, abs=0.4)
    np.testing.assert_allclose(found.otherwise, np.abs(shifted(first, -8.7) - second).max(axis=0))
