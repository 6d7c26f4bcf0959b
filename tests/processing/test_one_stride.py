import numpy as np
import pytest
from texts import says

from gaitdisc.channel import Channel
from gaitdisc.errors import StrideError
from gaitdisc.processing.walk_pair import TIMES, repeated_stride
from gaitdisc.recording import Recording, Trial

HIP = Channel("hip_flexion_r", "angle", "deg", "r")


def stride(samples=101, end=1.0):
    t = np.linspace(0.0, end, samples)
    return Recording(t, 30 * np.cos(2 * np.pi * t)[:, None], (HIP,))


@pytest.mark.parametrize(("samples", "end"), [(101, 1.0), (100, 0.99)])
def test_the_closing_sample_is_not_walked_twice(samples, end):
    walk = repeated_stride(Trial("sim", {"kinematics": stride(samples, end)}))
    angle = walk.stream("kinematics")
    assert len(angle.time) == TIMES * 100
    np.testing.assert_allclose(angle.values[:, 0], 30 * np.cos(2 * np.pi * angle.time), atol=1e-9)
    assert walk.findings[-1].kind == "one stride"


def test_streams_on_another_base_are_left_out_and_said():
    force = Recording(np.arange(1000) / 1000, np.ones((1000, 1)), (Channel("f", "vertical_force", "N", "r"),))
    walk = repeated_stride(Trial("sim", {"kinematics": stride(), "forces": force}))
    assert set(walk.streams) == {"kinematics"}
    assert says(walk.findings[-1].what, "forces left", "another time base")


def test_half_a_stride_and_a_long_walk_are_refused_in_words():
    with pytest.raises(StrideError, match=r"hip_flexion_r.*60\.0 deg"):
        repeated_stride(Trial("half", {"kinematics": stride(51, end=0.5)}))
    with pytest.raises(StrideError, match=r"0\.4.*2\.5 s.*long.*5\.01 s"):
        repeated_stride(Trial("long", {"kinematics": stride(501, end=5.0)}))
    still = Recording(np.arange(100) / 100, np.ones((100, 1)), (HIP,))
    with pytest.raises(StrideError, match=r"no.*legs that moves"):
        repeated_stride(Trial("still", {"kinematics": still}))
