import numpy as np
import pytest

from gaitdisc.comparison.alignment import aligned, common_shift, own_shift, shifted
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
    assert own_shift(shifted(CURVES, 4.0)[:, 0], CURVES[:, 0]) == pytest.approx(-4.0, abs=0.1)
    np.testing.assert_allclose(shifted(shifted(CURVES, 4.0), -4.0)[:-1], CURVES[:-1], atol=1e-12)
    [moved] = aligned([np.stack([CURVES, CURVES + 1])], 4.0)
    np.testing.assert_allclose(moved[1], shifted(CURVES, 4.0) + 1)
