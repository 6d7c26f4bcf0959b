import numpy as np
import pytest
from chapter3.burgers import LENGTH, POINTS, BurgersRates, burgers, places, slope_and_bend, smoothed_in_space
from chapter3.record import Conditions, recorded

from gaitdisc.errors import SamplingError


def test_a_small_wave_decays_as_diffusion_says():
    wave = 1e-6 * np.sin(2 * np.pi * places() / LENGTH)
    found = BurgersRates(0.1).run(wave[None], 0.01, 200)[0, -1]
    assert np.allclose(found, wave * np.exp(-0.1 * (2 * np.pi / LENGTH) ** 2 * 2.0), atol=1e-11)


def test_the_sum_is_kept_without_the_hidden_term():
    system = burgers(0.1)
    known, true = (rates.run(system.start[None], 0.01, 100)[0, -1].sum() for rates in (system.known, system.true))
    assert known == pytest.approx(system.start.sum(), rel=1e-10)
    assert true < known


def test_the_first_pulse_of_the_text_cannot_run():
    with pytest.raises(SamplingError, match=r"every bound at 0 s"):
        recorded(burgers(0.01, +1.0), Conditions(duration_s=2.0))


def test_slope_and_bend_of_a_wave_are_its_derivatives():
    k = 2 * np.pi / LENGTH * 5
    slope, bend = slope_and_bend(np.sin(k * places())[None])
    assert slope[0] == pytest.approx(k * np.cos(k * places()), abs=1e-10)
    assert bend[0] == pytest.approx(-(k**2) * np.sin(k * places()), abs=1e-9)


def test_smoothing_in_space_keeps_the_field_and_only_its_share_of_the_noise():
    wave = np.sin(2 * np.pi / LENGTH * 10 * places()) + np.zeros((400, 1))
    noise = 0.05 * np.random.default_rng(0).standard_normal(wave.shape)
    left = smoothed_in_space(wave + noise) - wave
    assert left.std() == pytest.approx(0.05 * np.sqrt(2 * 15 / POINTS), rel=0.1)
