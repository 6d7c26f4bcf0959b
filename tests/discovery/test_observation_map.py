"""The observation map inverted at points whose states are known, because they were put in."""

from dataclasses import replace

import numpy as np
import pytest
from hidden_in_a_mass import mass

from gaitdisc.discovery.first_states import ObservationMap
from gaitdisc.simulation.running import compile_simulation

RATE = 50.0
T = np.arange(60) / RATE
PUSH = 0.5 * T[:, None]
BOTH = np.ones(2, bool)


def _map(*observations):
    seen = replace(mass(), observations=tuple((f"y{k}", text) for k, text in enumerate(observations)))
    return ObservationMap(compile_simulation(seen), T, PUSH, np.ones(len(observations)))


@pytest.mark.parametrize("text", ["x", "x**2", "3*x + push", "tanh(x) + t", "x - 2*v"])
def test_slopes_are_those_of_the_expression(text):
    rng = np.random.default_rng(0)
    x = rng.uniform(0.2, 1.0, (len(T), 2))
    known = {"x": (1, 0), "x**2": (2 * x[:, 0], 0), "3*x + push": (3, 0), "x - 2*v": (1, -2)}
    known["tanh(x) + t"] = (1 - np.tanh(x[:, 0]) ** 2, 0)
    slopes = _map(text).jacobian(x)[:, 0]
    np.testing.assert_allclose(slopes, np.column_stack(np.broadcast_arrays(*known[text], T))[:, :2], atol=1e-7)


def test_resting_states_are_seen_to_change_by_inputs_and_time():
    drift = _map("x + 3*push + 2*t").drift(np.ones((len(T), 2)), RATE)
    np.testing.assert_allclose(drift, 3 * 0.5 + 2)


def test_two_channels_that_mix_two_states_give_both():
    x = np.random.default_rng(1).normal(size=(len(T), 2))
    seeing = _map("x + 2*v", "x - v + push")
    states, known = seeing.solved(seeing.at(x), np.zeros((len(T), 2)), BOTH)
    np.testing.assert_allclose(states, x, atol=1e-8)
    assert known.all()


def test_a_square_is_solved_though_it_is_flat_where_the_search_begins():
    x = np.column_stack([np.linspace(0.5, 2.0, len(T)), np.zeros(len(T))])
    seeing = _map("x**2")
    states, known = seeing.solved(seeing.at(x), np.zeros((len(T), 2)), BOTH)
    np.testing.assert_allclose(np.abs(states[:, 0]), x[:, 0], atol=1e-6)
    assert known[:, 0].all()
    assert not known[:, 1].any()


def test_what_no_state_can_give_is_not_solved():
    seeing = _map("sin(x)")
    _, known = seeing.solved(np.full((len(T), 1), 3.0), np.zeros((len(T), 2)), BOTH)
    assert not known.any()


def test_what_is_late_is_taken_as_now():
    x = np.random.default_rng(2).normal(size=(len(T), 2))
    seeing = _map("delay(x, 0.1)")
    np.testing.assert_allclose(seeing.at(x)[:, 0], x[:, 0])
