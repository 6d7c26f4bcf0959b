import numpy as np
import pytest

from gaitdisc.recording.arrays import read_only


def test_the_view_cannot_be_written_and_shares_memory():
    values = np.zeros(3)
    view = read_only(values)
    with pytest.raises(ValueError, match="read-only"):
        view[0] = 1.0
    assert np.shares_memory(view, values)
    values[0] = 2.0  # the caller's own array stays writable
