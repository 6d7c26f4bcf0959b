import numpy as np
import pytest

from gaitdisc.discovery.noise import LEAST, sensor_noise

T = np.arange(3000) / 100


def record(sd, seed=0):
    return np.sin(2 * np.pi * 0.9 * T) + np.random.default_rng(seed).normal(0, sd, T.size)


@pytest.mark.parametrize("sd", [0.001, 0.02, 0.3])
def test_white_noise_is_found_whatever_moves_below_it(sd):
    found = sensor_noise(np.stack([record(sd, seed) for seed in range(3)])[:, :, None])
    assert found == pytest.approx([sd], rel=0.06)


def test_each_channel_has_its_own_and_ends_of_trials_are_left_out():
    two = np.stack([record(0.02), record(0.1, 1)], axis=-1)[None]
    longer = np.concatenate([two, np.full((1, 500, 2), np.nan)], axis=1)
    assert sensor_noise(longer) == pytest.approx(sensor_noise(two))
    assert sensor_noise(two) == pytest.approx([0.02, 0.1], rel=0.06)


def test_a_record_without_noise_keeps_what_rounding_leaves():
    cubic = (T**3)[None, :, None]
    assert sensor_noise(cubic)[0] == pytest.approx(LEAST * cubic.std())


def test_a_trial_of_ten_samples_says_nothing():
    short = np.full((2, 3000, 1), np.nan)
    short[0, :, 0] = record(0.05)
    short[1, :10, 0] = 100 * np.random.default_rng(2).normal(size=10)
    assert sensor_noise(short) == pytest.approx(sensor_noise(short[:1]), rel=0.5)
    assert sensor_noise(short[:1]) == pytest.approx([0.05], rel=0.06)
