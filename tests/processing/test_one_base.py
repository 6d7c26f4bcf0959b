import numpy as np
import pytest

from gaitdisc.channel import Channel
from gaitdisc.processing.process import on_one_base
from gaitdisc.recording import Recording, Trial


def test_streams_meet_on_the_slow_base(trial):
    both = on_one_base(trial, 100.0)
    assert both.rate_hz == 100.0
    assert len(both.names) == sum(len(stream.names) for stream in trial.streams.values())
    emg = both["emg_sol_r"][100:-100]
    assert emg.min() > -1e-5  # an envelope, not the raw signal


def test_what_is_too_fast_does_not_fold_into_the_result():
    time = np.arange(4000) / 1000
    force = Recording(time, np.sin(2 * np.pi * 97 * time)[:, None], (Channel("sync", "signal", "V"),))
    slow = on_one_base(Trial("walk", {"signals": force}), 100.0)  # unfiltered it would alias to 3 Hz
    assert np.abs(slow["sync"][50:-50]).max() < 0.01


def test_streams_that_are_asked_for(trial):
    assert on_one_base(trial, 100.0, ("forces",)).names == ("ground_force_r_vy", "ground_force_l_vy")
    with pytest.raises(ValueError, match="read for its markers"):
        on_one_base(trial, 100.0, ("markers",))
