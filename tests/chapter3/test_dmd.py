"""Dynamic mode decomposition: optimised, in bags, exact."""

import numpy as np
import pytest
from chapter3.dmd import _modes, fit_dmd, fit_exact_dmd

from gaitdisc.errors import SamplingError
from gaitdisc.recording import Samples

TIME = np.arange(600) / 100


def samples(y, start=3.0):
    time = np.arange(len(y)) / 100 + start
    return Samples(time[:, None], y, ("t",), tuple("abc"[: y.shape[1]]), time, np.full(len(y), np.nan))


def test_two_oscillations_go_on_as_they_were():
    time = 3.0 + np.arange(900) / 100
    y = np.column_stack([np.sin(4 * time) + 0.3 * np.cos(11 * time), np.exp(-0.1 * time) * np.sin(4 * time + 1)])
    model = fit_dmd(samples(y[:600]), delays=40, rank=6)
    assert np.abs(model(time[600:, None]) - y[600:]).max() < 1e-3
    assert model.eigenvalues.real.max() <= 1e-9


def test_bags_tell_the_spread_of_the_eigenvalues():
    y = np.sin(6 * TIME[:400])[:, None] + 0.01 * np.random.default_rng(0).standard_normal((400, 1))
    model = fit_dmd(samples(y), delays=20, rank=2, bags=5)
    assert np.abs(np.sort(model.eigenvalues.imag) - [-6, 6]).max() < 0.1
    assert 0 < model.spread.max() < 1


def test_what_dies_out_within_a_sample_is_rounding_and_left_out(monkeypatch):
    monkeypatch.setattr("chapter3.dmd._modes", lambda *given: _WithOneDead(_modes(*given)))
    y = np.sin(6 * np.arange(300) / 100)[:, None]
    model = fit_dmd(samples(y), delays=20, rank=3, bags=3)
    assert model.eigenvalues.real.min() > -100  # what is left lives for a sample of 0.01 s at least
    assert len(model.eigenvalues) == len(model.modes) == len(model.spread) > 0


class _WithOneDead:
    """A decomposition whose first eigenvalue is exp(-30) within a sample."""

    def __init__(self, found):
        self.modes, self.amplitudes, self.eigenvalues_std = found.modes, found.amplitudes, found.eigenvalues_std
        self.eigs = np.concatenate([[-3000.0 + 0j], found.eigs[1:]])


def test_a_record_too_short_for_the_delays_says_by_how_much():
    with pytest.raises(SamplingError, match=r"15 modes.*100 delays.*130.*90"):
        fit_dmd(samples(np.random.default_rng(0).standard_normal((90, 1))))


def test_a_gap_in_time_is_refused():
    whole = samples(np.sin(np.arange(300.0))[:, None])
    keep = np.ones(300, bool)
    keep[150] = False
    with pytest.raises(SamplingError, match=r"after 4.49 s.*0.02 s"):
        fit_dmd(whole.rows(keep), delays=20, rank=2)


def test_an_output_that_stands_still_stays_still():
    y = np.column_stack([np.sin(np.arange(300) / 20), np.zeros(300)])
    assert np.abs(fit_dmd(samples(y), delays=10, rank=2)(np.array([[4.0]]))[0, 1]) < 1e-12


def test_before_its_start_a_mode_that_dies_out_is_held_and_does_not_explode():
    t = 1.0 + np.arange(300) / 100
    s = Samples(t[:, None], np.exp(-8.0 * t)[:, None], ("t",), ("a",), t, t)
    found = fit_dmd(s, delays=20, rank=1)
    assert found(np.array([[0.0]])) == pytest.approx(found(np.array([[1.0]])))


def test_what_a_file_rounds_away_is_no_mode():
    y = np.column_stack([np.sin(4 * TIME), np.cos(4 * TIME)]).round(5)  # two modes, however many are asked for
    assert len(fit_dmd(samples(y), delays=60, rank=15).eigenvalues) == 2


@pytest.fixture
def dying_waves():
    """Two frequencies, one of them dying out, in two channels."""
    slow, fast = np.cos(3 * TIME), np.exp(-0.4 * TIME) * np.sin(11 * TIME)
    return np.column_stack([slow + fast, 2 * slow - fast])


def test_rates_and_frequencies_of_clean_waves_are_exact(dying_waves):
    found = fit_exact_dmd(samples(dying_waves, 0.0), delays=20, rank=4)
    order = np.argsort(found.eigenvalues.imag)
    assert found.eigenvalues[order] == pytest.approx([-0.4 - 11j, -3j, 3j, -0.4 + 11j], abs=1e-6)
    assert found(TIME[:, None]) == pytest.approx(dying_waves, abs=1e-6)


def test_modes_that_are_rounding_are_left_out(dying_waves):
    found = fit_exact_dmd(samples(dying_waves, 0.0), delays=20, rank=15)  # four modes are all there is
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
