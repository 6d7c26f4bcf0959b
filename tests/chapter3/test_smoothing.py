import numpy as np
from chapter3.record import noise_cutoff_hz, smoothed

T = np.arange(3000) / 100
CLEAN = np.sin(2 * np.pi * 0.5 * T) + 0.2 * np.sin(2 * np.pi * 3 * T)
NOISE = np.random.default_rng(0).standard_normal(3000)


def test_more_noise_lowers_the_cutoff_and_no_signal_is_lost():
    cutoffs = [noise_cutoff_hz(CLEAN + level * NOISE, 100.0) for level in (0.001, 0.05, 3.0)]
    assert cutoffs[0] >= cutoffs[1] >= cutoffs[2]
    assert cutoffs[1] > 3


def test_noise_shrinks_and_signal_stays():
    left = smoothed((CLEAN + 0.05 * NOISE)[:, None], 100.0)[200:-200, 0] - CLEAN[200:-200]
    assert left.std() < 0.03


def test_a_constant_stays_constant():
    assert np.allclose(smoothed(np.full((500, 1), 7.0), 100.0, 4.0), 7.0)
