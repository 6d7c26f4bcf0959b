import numpy as np
import pytest
from hidden_in_a_mass import MASS, mass

from gaitdisc.discovery.first_states import guess_states
from gaitdisc.discovery.segments import Segments
from gaitdisc.simulation.simulation_file import simulation_of

RATE, PERIOD = 50.0, 2.0
T = np.arange(400) / RATE
X, V = np.sin(2 * np.pi * T / PERIOD), 2 * np.pi / PERIOD * np.cos(2 * np.pi * T / PERIOD)


def _guess(observed, simulation=None):
    return guess_states(simulation or mass(), observed, RATE, PERIOD, {"x": "v"})


def test_a_measured_state_and_its_rate_are_found():
    noise = np.random.default_rng(0).normal(0, 0.01, len(T))
    states = _guess((X + noise)[None, :, None]).states[0]
    np.testing.assert_allclose(states[:, 0], X, atol=0.05)
    np.testing.assert_allclose(states[10:-10, 1], V[10:-10], atol=0.25)


def test_samples_that_are_missing_are_bridged():
    seen = X.copy()
    seen[100:103] = np.nan
    np.testing.assert_allclose(_guess(seen[None, :, None]).states[0, 95:110, 0], X[95:110], atol=0.05)


def test_beyond_the_end_of_a_trial_there_is_no_state():
    two = np.stack([X, np.where(T < 4, X, np.nan)])[..., None]
    states = _guess(two).states
    assert np.isfinite(states[1, :200]).all()
    assert np.isnan(states[1, 200:]).all()


def test_a_state_that_is_not_measured_begins_at_its_initial():
    text = MASS.replace("[inputs.push]", "[states.hidden]\ninitial = 0.7\n[inputs.push]")
    text = text.replace("[equations]", '[equations]\nhidden = "-hidden"')
    states = _guess(X[None, :, None], simulation_of(text, "three.toml")).states
    assert states[0, :, 2] == pytest.approx(0.7)


def test_starts_are_the_states_at_each_first_sample_and_a_run_replaces_them():
    guess = _guess(X[None, :, None])
    segments = Segments(np.array([0, 0]), np.array([0, 50]), 50)
    np.testing.assert_array_equal(guess.starts(segments), guess.states[0, [0, 50]])
    better = guess.with_run(segments, np.ones((2, 50, 2)))
    assert (better.states[0, :100] == 1).all()
    np.testing.assert_array_equal(better.states[0, 100:], guess.states[0, 100:])
