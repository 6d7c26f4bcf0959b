import numpy as np
import pytest

from gaitdisc.channel import Channel
from gaitdisc.errors import SamplingError, ShapeError
from gaitdisc.recording import Trajectory

KNEE = Channel("knee_angle_r", "angle", "deg", "r")


def trajectory(samples=24_000, rate_hz=100.0):
    time = np.arange(samples) / rate_hz
    x = time[:, None]
    return Trajectory(
        time, x, np.ones_like(x), np.zeros_like(x), time % 1 * 100, (KNEE,), np.ones(x.shape, bool), "P01"
    )


def test_the_dissertation_holds_out_30_of_240_s():
    training, held_out = trajectory().split(30.0)
    assert len(held_out.time) == 3000
    assert len(training.time) == 21_000 - 30
    assert held_out.time[0] - training.time[-1] == pytest.approx(0.31)


def test_a_held_out_part_longer_than_the_trial():
    with pytest.raises(SamplingError, match=r"too short.*30 s.*0.3 s.*P01.*10.00 s"):
        trajectory(1000).split(30.0)
    with pytest.raises(SamplingError):
        trajectory(1000).split(0.0)


def test_shapes():
    whole = trajectory(10)
    with pytest.raises(ShapeError, match="xdot of a trajectory must"):
        Trajectory(whole.time, whole.x, whole.x[:5], whole.x, whole.phi, (KNEE,), whole.usable)
    with pytest.raises(ShapeError, match="phi of a trajectory must"):
        Trajectory(whole.time, whole.x, whole.x, whole.x, whole.phi[:3], (KNEE,), whole.usable)


def test_rows_and_columns():
    part = trajectory(10).rows(slice(2, 5))
    np.testing.assert_allclose(part.time, [0.02, 0.03, 0.04])
    assert part.columns(["knee_angle_r"]) == [0]
    assert part.rate_hz == 100.0
