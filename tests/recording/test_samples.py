import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gaitdisc.errors import ShapeError
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
    with pytest.raises(ShapeError, match=r"samples need y of shape \(10, 1\); found \(9, 1\)"):
        samples().with_outputs(np.zeros((9, 1)))
