import copy
import pickle

import numpy as np
import pytest

from gaitdisc.channel import Channel
from gaitdisc.errors import ChannelError, SamplingError
from gaitdisc.recording import Recording, Trial

KNEE = Channel("knee_angle_r", "angle", "deg", "r")
FORCE = Channel("ground_force_r_vy", "vertical_force", "N", "r")


def trial(start=0.0):
    slow, fast = np.arange(101) / 100, start + np.arange(2001) / 1000
    return Trial(
        "walk",
        {
            "kinematics": Recording(slow, 2 * slow[:, None], (KNEE,)),
            "forces": Recording(fast, 3 * fast[:, None], (FORCE,)),
        },
    )


def test_one_base_is_the_common_span_at_the_rate_asked_for():
    both = trial(start=0.25).on_one_base(200.0)
    assert both.names == ("knee_angle_r", "ground_force_r_vy")
    assert both.rate_hz == 200.0
    assert (both.time[0], both.time[-1]) == (0.25, 1.0)
    np.testing.assert_allclose(both.values, np.column_stack([2 * both.time, 3 * both.time]), atol=1e-9)


def test_streams_without_common_time():
    with pytest.raises(SamplingError, match=r"5.000 s.*1.000 s"):
        trial(start=5.0).on_one_base(100.0)


def test_a_stream_that_is_not_there():
    with pytest.raises(ChannelError, match=r"emg.*has kinematics, forces"):
        trial().stream("emg")


def test_an_unknown_kind_of_stream():
    with pytest.raises(ChannelError, match="walk has 'grf'"):
        Trial("walk", {"grf": trial().stream("forces")})


def test_streams_are_frozen():
    with pytest.raises(TypeError):
        trial().streams["emg"] = trial().stream("forces")


@pytest.mark.parametrize("sent", [lambda one: pickle.loads(pickle.dumps(one)), copy.deepcopy], ids=["pickle", "copy"])
def test_a_trial_goes_to_another_process_and_stays_frozen(sent):
    again = sent(trial())
    assert repr(again) == repr(trial())
    np.testing.assert_array_equal(again.stream("forces").values, trial().stream("forces").values)
    with pytest.raises(TypeError):
        again.streams["emg"] = again.stream("forces")
