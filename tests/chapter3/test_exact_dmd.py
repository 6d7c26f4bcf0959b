import numpy as np
import pytest
from chapter3.dmd import fit_dmd, fit_exact_dmd

from gaitdisc.recording import Samples

TIME = np.arange(600) / 100


def samples(y):
    return Samples(TIME[:, None], y, ("t",), tuple("ab")[: y.shape[1]], TIME, np.full(len(TIME), np.nan))


@pytest.fixture
def dying_waves():
    """Two frequencies, one of them dying out, in two channels."""
    slow, fast = np.cos(3 * TIME), np.exp(-0.4 * TIME) * np.sin(11 * TIME)
    return np.column_stack([slow + fast, 2 * slow - fast])


def test_rates_and_frequencies_of_clean_waves_are_exact(dying_waves):
    found = fit_exact_dmd(samples(dying_waves), delays=20, rank=4)
    order = np.argsort(found.eigenvalues.imag)
    assert found.eigenvalues[order] == pytest.approx([-0.4 - 11j, -3j, 3j, -0.4 + 11j], abs=1e-6)
    assert found(TIME[:, None]) == pytest.approx(dying_waves, abs=1e-6)


def test_modes_that_are_rounding_are_left_out(dying_waves):
    found = fit_exact_dmd(samples(dying_waves), delays=20, rank=15)  # four modes are all there is
    assert np.isfinite(found.modes).all()
    assert found(TIME[:, None]) == pytest.approx(dying_waves, abs=1e-5)


def test_under_noise_its_waves_die_where_those_of_optimised_dmd_do_not(dying_waves):
    # noise in both factors of least squares shrinks the map (Dawson et al. 2016), so that waves seem to die
    wave = np.column_stack([np.cos(9 * TIME), np.sin(9 * TIME)])
    noisy = samples(wave + 0.3 * np.random.default_rng(0).standard_normal(wave.shape))
    exact, optimised = fit_exact_dmd(noisy, delays=5, rank=2), fit_dmd(noisy, delays=5, rank=2)
    assert exact.eigenvalues.real.max() < optimised.eigenvalues.real.min() - 0.05


def test_nothing_grows():
    found = fit_exact_dmd(samples(np.exp(0.3 * TIME)[:, None]), delays=10, rank=1)
    assert found.eigenvalues.real.max() == 0.0
