import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gaitdisc.errors import ShapeError, TrainingError
from gaitdisc.recording import Samples


def samples(count=10):
    ramp = np.arange(float(count))
    return Samples(np.column_stack([ramp, -ramp]), ramp[:, None], ("a", "b"), ("c",), ramp / 100, ramp)


@given(st.integers(2, 500), st.floats(0.05, 0.95))
def test_the_last_block_is_contiguous_and_nothing_is_lost(count, share):
    before, last = samples(count).last_block(share)
    assert len(before) + len(last) == count
    np.testing.assert_array_equal(np.vstack([before.x, last.x]), samples(count).x)


def test_rows_and_other_outputs():
    part = samples().rows(slice(2, 4)).with_outputs(np.array([[7.0], [8.0]]))
    assert part.y[:, 0].tolist() == [7.0, 8.0]
    assert part.x[:, 0].tolist() == [2.0, 3.0]


def test_shapes():
    with pytest.raises(ShapeError, match=r"y of the samples.*\(10, 1\).*\(9, 1\)"):
        samples().with_outputs(np.zeros((9, 1)))


def test_the_seam_before_the_last_block_is_left_away():
    before, last = samples(100).last_block(0.2, seam_s=0.105)
    assert (before.time[-1], last.time[0]) == (0.69, 0.8)


def test_too_few_samples_to_fit():
    with pytest.raises(TrainingError, match=r"2 inputs.*1 outputs.*50 samples.*10 usable"):
        samples().trainable(50)


def test_missing_numbers_are_not_fitted():
    hole = samples().with_outputs(np.where(np.arange(10) == 3, np.nan, np.arange(10.0))[:, None])
    with pytest.raises(TrainingError, match=r"1 missing.*10.*0\.030 s"):
        hole.trainable(5)


def test_constant_outputs_are_not_fitted():
    with pytest.raises(TrainingError, match=r"2\.5.*10 samples"):
        samples().with_outputs(np.full((10, 1), 2.5)).trainable(5)
    assert len(samples().trainable(10)) == 10
