from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from gaitdisc.recording.arrays import runs, spans_s

TIME = np.arange(1000) / 100


@given(st.lists(st.booleans(), max_size=40))
def test_runs_give_the_mask_back(mask):
    mask = np.array(mask, bool)
    back = np.zeros(len(mask), bool)
    for start, end in runs(mask):
        assert end > start
        back[start:end] = True
    assert np.array_equal(back, mask)


def test_spans_reach_one_step_past_the_last_sample():
    assert spans_s(TIME, (TIME >= 1.0) & (TIME < 1.2)) == ((1.0, 1.2),)
