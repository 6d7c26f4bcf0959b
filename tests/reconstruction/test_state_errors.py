import numpy as np
import pytest

from gaitdisc.channel import Channel
from gaitdisc.reconstruction.state_errors import (
    Reconstructed,
    angle_columns,
    angles_error,
    phase_curves,
    state_errors,
    stride_numbers,
)
from gaitdisc.recording import Samples

CHANNELS = (Channel("knee_angle_r", "angle", "deg", "r"), Channel("pelvis_tx", "translation", "m"))


@pytest.fixture
def reconstructed():
    time = np.arange(1000) / 100
    y = np.column_stack([30 + 10 * np.sin(2 * np.pi * time), 0.1 * np.cos(2 * np.pi * time)])
    windows = Samples(y, y, ("a", "b"), ("knee_angle_r", "pelvis_tx"), time, 100 * (time % 1))
    return Reconstructed(windows, stride_numbers([windows]), y + np.array([2.0, -0.05]))


def test_each_error_has_its_known_value(reconstructed):
    found = state_errors(reconstructed, CHANNELS).set_index("state")
    assert found["rmse"].tolist() == pytest.approx([2.0, 0.05])
    assert found["unit"].tolist() == ["deg", "m"]
    assert found["relative_l2"].tolist() == pytest.approx([2 / np.sqrt(950), 0.05 / np.sqrt(0.005)])
    assert found["r2"].tolist() == pytest.approx([1 - 4 / 50, 0.5])
    assert found["low"].tolist() == pytest.approx([2.0, 0.05])


def test_strides_are_counted_and_are_what_the_interval_draws(reconstructed):
    assert reconstructed.strides == 10
    states = reconstructed.windows.y + reconstructed.stride[:, None]
    found = state_errors(Reconstructed(reconstructed.windows, reconstructed.stride, states), CHANNELS).iloc[0]
    assert found["rmse"] == pytest.approx(np.sqrt(28.5))
    assert 3.0 < found["low"] < 4.5
    assert 6.0 < found["high"] < 7.5


def test_degrees_and_metres_are_never_averaged(reconstructed):
    found = angles_error(reconstructed, CHANNELS, np.full((1000, 1), 30.0))
    assert found["rmse_deg"] == pytest.approx(2.0)
    assert found["relative_l2"] == pytest.approx(2 / np.sqrt(950))
    assert found["relative_l2_whole"] == pytest.approx(2 / np.sqrt(950 + 900))
    nothing = Reconstructed(reconstructed.windows, reconstructed.stride, reconstructed.states)
    assert np.isnan(angles_error(nothing, (CHANNELS[1], CHANNELS[1]), np.zeros((1000, 0)))["rmse_deg"])


def test_curves_over_the_stride(reconstructed):
    curves = phase_curves(reconstructed, ("knee_angle_r", "pelvis_tx"), 50)
    knee = curves[curves["state"] == "knee_angle_r"]
    assert len(knee) == 50
    np.testing.assert_allclose(knee["reconstructed"] - knee["measured"], 2.0)
    np.testing.assert_allclose(knee["measured"], 30 + 10 * np.sin(2 * np.pi * knee["percent"] / 100), atol=0.6)


def test_columns_that_are_angles():
    assert angle_columns((*CHANNELS, CHANNELS[0])) == [0, 2]
    assert angle_columns(CHANNELS[1:]) == []
