import numpy as np
import pytest
from chapter3.sindy import fit_weak_sindy

from gaitdisc.errors import TrainingError
from gaitdisc.recording import Samples

TIME = np.arange(3000) / 100
TRUE = np.column_stack([np.sin(TIME) + 0.5 * np.sin(2.3 * TIME), np.cos(TIME) + 1.15 * np.cos(2.3 * TIME)])
RATES = np.column_stack([TRUE[:, 1], -np.sin(TIME) - 2.645 * np.sin(2.3 * TIME)])
MISSING = -0.2 * TRUE[:, 0] ** 3


def samples(noise=0.0):
    """What a model knows of the rates of v, which lacks a cubic of x, at states with noise."""
    states = TRUE + noise * np.random.default_rng(1).standard_normal(TRUE.shape)
    known = np.column_stack([states[:, 1], RATES[:, 1] - MISSING])
    return Samples(states, known, ("x", "v"), ("x", "v"), TIME, np.full(len(TIME), np.nan))


def test_a_missing_term_is_found_without_a_derivative():
    assert fit_weak_sindy(samples()).terms("v") == {"x**3": pytest.approx(-0.2, rel=1e-3)}
    assert fit_weak_sindy(samples()).terms("x") == {}


def test_noise_a_hundred_times_the_missing_rate_leaves_the_term():
    noisy = samples(noise=0.1)  # a central difference of it has noise of 7, what is missing is 0.1
    assert fit_weak_sindy(noisy).terms("v")["x**3"] == pytest.approx(-0.2, rel=0.25)


def test_too_short_a_record_says_how_many_windows_it_holds():
    short = samples().rows(slice(0, 120))
    with pytest.raises(TrainingError, match=r"10 terms.*36 windows.*0.5 s.*120 samples.*12"):
        fit_weak_sindy(short)
