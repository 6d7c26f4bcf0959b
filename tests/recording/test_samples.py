"""Samples, the scale of their columns, and the trajectory that they come from."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from gaitdisc.channel import Channel
from gaitdisc.errors import SamplingError, ShapeError, TrainingError
from gaitdisc.recording import Samples, Trajectory, fit_scale


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


@pytest.mark.parametrize(
    ("outputs", "least", "words"),
    [
        (np.arange(10.0), 50, r"2 inputs.*1 outputs.*50 samples.*10 usable"),
        (np.where(np.arange(10) == 3, np.nan, np.arange(10.0)), 5, r"1 of 10.*missing.*0\.030 s"),
        (np.full(10, 2.5), 5, r"2\.5.*10 samples"),
    ],
)
def test_too_few_missing_and_constant_numbers_are_not_fitted(outputs, least, words):
    with pytest.raises(TrainingError, match=words):
        samples().with_outputs(outputs[:, None]).trainable(least)
    assert len(samples().trainable(10)) == 10


@given(arrays(float, (20, 3), elements=st.floats(-1e4, 1e4)))
def test_unscaling_undoes_scaling(values):
    scale = fit_scale(values)
    np.testing.assert_allclose(scale.unscaled(scale.scaled(values)), values, atol=2e-5)


def test_constant_columns_weigh_nothing_also_where_they_vary_later():
    scale = fit_scale(np.column_stack([np.full(10, 0.1), np.arange(10.0), np.full(10, -3.0) + 1e-13]))
    assert scale.constant.tolist() == [True, False, True] and not scale.mean.flags.writeable
    np.testing.assert_array_equal(scale.scaled(np.array([[5.0, 4.5, 9.0]])), [[0.0, 0.0, 0.0]])


def test_small_units_are_not_taken_for_constant():
    assert not fit_scale(1e-6 * np.sin(np.arange(50.0))[:, None]).constant[0]


def test_missing_values_take_no_part():
    values = np.array([[1.0, np.nan, 5.0], [np.nan, np.nan, 7.0], [3.0, np.nan, 6.0]])
    scale = fit_scale(values)
    np.testing.assert_array_equal(scale.mean, [2.0, 0.0, 6.0])
    assert scale.sd[0] == 1.0
    assert scale.constant.tolist() == [False, True, False]


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
    with pytest.raises(SamplingError, match=r"longer than.*30 s.*0.3 s.*P01.*10.00 s"):
        trajectory(1000).split(30.0)
    with pytest.raises(SamplingError):
        trajectory(1000).split(0.0)


def test_shapes_of_a_trajectory():
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
