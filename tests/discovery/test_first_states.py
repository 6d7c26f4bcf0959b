from dataclasses import replace

import numpy as np
import pytest
from hidden_in_a_mass import MASS, Experiment, mass, record

from gaitdisc.discovery.case import set_up_case
from gaitdisc.discovery.first_states import ObservationMap, follow, guess_states, with_own_states
from gaitdisc.discovery.segments import Segments
from gaitdisc.simulation.compiled_simulation import Drive
from gaitdisc.simulation.measured import Measured
from gaitdisc.simulation.parts import State
from gaitdisc.simulation.running import compile_simulation
from gaitdisc.simulation.simulation_file import parse_simulation

RATE, PERIOD = 50.0, 2.0
T = np.arange(400) / RATE
X, V = np.sin(2 * np.pi * T / PERIOD), 2 * np.pi / PERIOD * np.cos(2 * np.pi * T / PERIOD)


def _guess(observed, simulation=None):
    ends = [int(np.flatnonzero(np.isfinite(one).any(axis=1))[-1]) + 1 for one in observed]
    drive = Drive.of([0.1 * T[:end, None] for end in ends], RATE)
    measured = Measured(drive, observed, tuple(map(str, range(len(observed)))), ("x",))
    return guess_states(simulation or mass(), measured, PERIOD, {"x": "v"})


def test_a_measured_state_and_its_rate_are_found():
    noise = np.random.default_rng(0).normal(0, 0.01, len(T))
    states = _guess((X + noise)[None, :, None])[0]
    np.testing.assert_allclose(states[:, 0], X, atol=0.05)
    np.testing.assert_allclose(states[10:-10, 1], V[10:-10], atol=0.25)


def test_samples_that_are_missing_are_bridged():
    seen = X.copy()
    seen[100:103] = np.nan
    np.testing.assert_allclose(_guess(seen[None, :, None])[0, 95:110, 0], X[95:110], atol=0.05)


def test_beyond_the_end_of_a_trial_there_is_no_state():
    two = np.stack([X, np.where(T < 4, X, np.nan)])[..., None]
    states = _guess(two)
    assert np.isfinite(states[1, :200]).all()
    assert np.isnan(states[1, 200:]).all()


@pytest.mark.parametrize(("rate", "expected"), [("-hidden", 0.7 * np.exp(-T)), ("0*hidden", np.full(len(T), 0.7))])
def test_a_state_that_is_not_measured_follows_its_equation_where_it_forgets_its_start(rate, expected):
    text = MASS.replace("[inputs.push]", "[states.hidden]\ninitial = 0.7\n[inputs.push]")
    text = text.replace("[equations]", f'[equations]\nhidden = "{rate}"')
    text = text.replace('[observations]\nx = "x"', '[observations.x]\nexpression = "x"\nsd = 0.01')
    states = _guess(X[None, :, None], parse_simulation(text, "three.toml"))
    np.testing.assert_allclose(states[0, :, 2], expected, atol=1e-6)


def test_starts_are_the_states_at_each_first_sample_and_a_run_replaces_them():
    guess = _guess(X[None, :, None])
    segments = Segments(np.array([0, 0]), np.array([0, 50]), 50)
    np.testing.assert_array_equal(segments.starts(guess), guess[0, [0, 50]])
    better = segments.put(guess, np.ones((2, 50, 2)))
    assert (better[0, :100] == 1).all()
    np.testing.assert_array_equal(better[0, 100:], guess[0, 100:])


@pytest.mark.parametrize(
    ("text", "seen"),
    [
        ("1*x", lambda x: x),
        ("57.2958*x", lambda x: 57.2958 * x),
        ("-x", lambda x: -x),
        ("0.3 - 2*x", lambda x: 0.3 - 2 * x),
        ("x + 3*push", lambda x: x + 0.3 * T),
        ("k*x", lambda x: 24.0 * x),
        ("x + 0.5*t", lambda x: x + 0.5 * T),
    ],
)
def test_one_record_through_any_map_gives_the_same_states(text, seen):
    noisy = X + np.random.default_rng(0).normal(0, 0.01, len(T))
    plain = _guess(noisy[None, :, None])
    through = _guess(seen(noisy)[None, :, None], mass().with_observation("x", text))
    np.testing.assert_allclose(through, plain, rtol=0, atol=1e-6)


@pytest.mark.parametrize(
    ("text", "seen", "atol"),
    [("sin(x)", np.sin(X), 0.01), ("exp(2*x)", np.exp(2 * X), 0.06), ("x + 0.05*v", X + 0.05 * V, 0.04)],
)
def test_a_curved_map_and_one_that_sees_the_rate_beside_are_solved(text, seen, atol):
    states = _guess(seen[None, :, None], mass().with_observation("x", text))[0, 10:-10]
    np.testing.assert_allclose(states[:, 0], X[10:-10], atol=atol)
    np.testing.assert_allclose(states[:, 1], V[10:-10], atol=6 * atol)


def test_a_product_with_a_state_that_stands_still_is_bridged():
    mixed = mass().with_state(State("gain", initial=2.0), "0")
    mixed = mixed.with_observation("x", "x*gain").with_observation("y", "gain")
    drive = Drive.of([0.1 * T[:, None]], RATE)
    measured = Measured(drive, np.column_stack([3 * X, 3 + 0 * X])[None], ("1",), ("x", "y"))
    states = guess_states(mixed, measured, PERIOD, {"x": "v"})[0]
    np.testing.assert_allclose(states[10:-10, 0], X[10:-10], atol=2e-3)
    np.testing.assert_allclose(states[10:-10, 2], 3.0, atol=1e-6)


def test_what_the_channels_say_only_together_stays_near_where_it_began():
    states = _guess((X + 2 * V)[None, :, None], mass().with_observation("x", "x + 2*v"))[0]
    assert np.isfinite(states).all()
    np.testing.assert_allclose((states @ [1, 2])[10:-10], (X + 2 * V)[10:-10], atol=0.1)


RATE = 50.0
TIMES = np.arange(60) / RATE
PUSH = 0.5 * TIMES[:, None]
BOTH = np.ones(2, bool)


def _map(*observations):
    seen = replace(mass(), observations=tuple((f"y{k}", text) for k, text in enumerate(observations)))
    return ObservationMap(compile_simulation(seen), TIMES, PUSH, np.ones(len(observations)))


@pytest.mark.parametrize("text", ["x", "x**2", "3*x + push", "tanh(x) + t", "x - 2*v"])
def test_slopes_are_those_of_the_expression(text):
    rng = np.random.default_rng(0)
    x = rng.uniform(0.2, 1.0, (len(TIMES), 2))
    known = {"x": (1, 0), "x**2": (2 * x[:, 0], 0), "3*x + push": (3, 0), "x - 2*v": (1, -2)}
    known["tanh(x) + t"] = (1 - np.tanh(x[:, 0]) ** 2, 0)
    slopes = _map(text).jacobian(x)[:, 0]
    np.testing.assert_allclose(slopes, np.column_stack(np.broadcast_arrays(*known[text], TIMES))[:, :2], atol=1e-7)


def test_resting_states_are_seen_to_change_by_inputs_and_time():
    drift = _map("x + 3*push + 2*t").drift(np.ones((len(TIMES), 2)), RATE)
    np.testing.assert_allclose(drift, 3 * 0.5 + 2)


def test_two_channels_that_mix_two_states_give_both():
    x = np.random.default_rng(1).normal(size=(len(TIMES), 2))
    seeing = _map("x + 2*v", "x - v + push")
    states, known = seeing.solved(seeing.at(x), np.zeros((len(TIMES), 2)), BOTH)
    np.testing.assert_allclose(states, x, atol=1e-8)
    assert known.all()


def test_a_square_is_solved_though_it_is_flat_where_the_search_begins():
    x = np.column_stack([np.linspace(0.5, 2.0, len(TIMES)), np.zeros(len(TIMES))])
    seeing = _map("x**2")
    states, known = seeing.solved(seeing.at(x), np.zeros((len(TIMES), 2)), BOTH)
    np.testing.assert_allclose(np.abs(states[:, 0]), x[:, 0], atol=1e-6)
    assert known[:, 0].all()
    assert not known[:, 1].any()


def test_what_no_state_can_give_is_not_solved():
    seeing = _map("sin(x)")
    _, known = seeing.solved(np.full((len(TIMES), 1), 3.0), np.zeros((len(TIMES), 2)), BOTH)
    assert not known.any()


def test_what_is_late_is_taken_as_now():
    x = np.random.default_rng(2).normal(size=(len(TIMES), 2))
    seeing = _map("delay(x, 0.1)")
    np.testing.assert_allclose(seeing.at(x)[:, 0], x[:, 0])


@pytest.fixture(scope="module")
def shooting():
    measured = record(mass(), 3, Experiment(trials=2, seconds=12.0, noise=0.0))
    return set_up_case(mass(), measured).as_read().shooting


def with_lag(seconds):
    return mass().with_state(State("slow", "N", initial=0.0), f"(push - slow)/{seconds}")


def test_a_lag_follows_its_input_as_the_convolution_with_its_exponential(shooting):
    machine = compile_simulation(with_lag(0.3))
    (own,) = follow(shooting, machine.simulation, machine.defaults[None])
    drive = shooting.measured.drive
    push, dt = drive.inputs[0, : drive.samples[0], 0], 1 / drive.rate
    k = 400  # the start is forgotten
    past = np.arange(k + 1) * dt
    weights = np.exp(-past / 0.3) / 0.3
    expected = np.trapezoid(weights * push[k::-1], past)
    assert own[0, k, 0] == pytest.approx(expected, abs=0.01 * push.std())


def test_several_versions_are_followed_at_once_as_one_by_one(shooting):
    machine = compile_simulation(mass().with_state(State("z", "m", initial=0.0), "v - k*z"))
    values = np.stack([machine.defaults, machine.defaults])
    values[1, machine.parameters.index("k")] = 3.0
    both = follow(shooting, machine.simulation, values)
    assert both.shape[0] == 2
    for version in (0, 1):
        np.testing.assert_array_equal(both[version], follow(shooting, machine.simulation, values[version][None])[0])
    assert np.abs(both[0] - both[1]).max() > 0.01


def test_starts_are_completed_by_the_own_states_and_else_left_alone(shooting):
    plain, machine = compile_simulation(mass()), compile_simulation(with_lag(0.3))
    segments = shooting.segments
    starts = np.zeros((len(segments), 2))
    np.testing.assert_array_equal(with_own_states(shooting, plain, plain.defaults, starts), starts)
    whole = with_own_states(shooting, machine, machine.defaults, starts)
    (own,) = follow(shooting, machine.simulation, machine.defaults[None])
    np.testing.assert_array_equal(whole, np.column_stack([starts, own[segments.trial, segments.begin, 0]]))


def test_what_is_not_known_of_the_record_is_bridged(shooting):
    gappy = shooting.past.copy()
    gappy[0, 100:105] = np.nan
    machine = compile_simulation(mass().with_state(State("z", "m", initial=0.0), "v - z/0.2"))
    (own,) = follow(replace(shooting, past=gappy), machine.simulation, machine.defaults[None])
    (whole,) = follow(shooting, machine.simulation, machine.defaults[None])
    assert np.isfinite(own).all()
    assert np.abs(own - whole).max() < 0.1 * whole.std()
