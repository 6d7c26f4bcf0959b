from dataclasses import replace

import numpy as np
import pytest

from gaitdisc.discovery.linearised import Linearised, carry_change, linearise, pushable
from gaitdisc.simulation.evaluating import Points, evaluate
from gaitdisc.simulation.parts import Term
from gaitdisc.simulation.running import compile_simulation

SMALL = 1e-4


@pytest.fixture(scope="module")
def line(case, as_read):
    return linearise(as_read, case.search.places)


def _run(as_read, simulation):
    fit, machine = as_read.fit, compile_simulation(simulation)
    values = np.concatenate([fit.values, machine.defaults[len(fit.values) :]])
    return as_read.shooting.run(machine, fit.starts[None], values[None])


def _pushed(as_read, line, term):
    """What a small effect on the port does, by running it, and to first order."""
    base = as_read.simulation
    states, _ = _run(as_read, base)
    moved, _ = _run(as_read, base.with_effect(Term("load", "port", "tried", f"{SMALL}*({term})")))
    points = states[0].reshape(-1, 2)
    push = evaluate(base, term, Points(np.zeros(len(points)), points, np.zeros((len(points), 1))))
    return (moved - states)[0] / SMALL, line.of_push(0, push.reshape(*states.shape[1:3], 1))[..., 0]


@pytest.mark.parametrize("term", ["x**3", "v", "1 + 0*x", "tanh(5*v)"])
def test_the_response_to_first_order_is_that_of_the_run(as_read, line, term):
    ran, first_order = _pushed(as_read, line, term)
    np.testing.assert_allclose(first_order, ran, atol=0.02 * np.abs(ran).max())


def test_a_change_of_the_start_goes_on_as_in_the_run(as_read, line):
    fit, machine = as_read.fit, as_read.machine
    states, _ = as_read.shooting.run(
        machine, np.stack([fit.starts, fit.starts + np.array([SMALL, 0.0])]), np.tile(fit.values, (2, 1))
    )
    change = np.broadcast_to([1.0, 0.0], fit.starts.shape)[..., None]
    for step in range(line.onward.shape[1]):
        change = line.onward[:, step] @ change
    np.testing.assert_allclose(change[..., 0], (states[1] - states[0])[:, -1] / SMALL, rtol=1e-3, atol=1e-6)


def test_steps_land_on_the_run(as_read, line):
    np.testing.assert_allclose(line.landed, as_read.fit.states[:, 1:], rtol=1e-9)


def test_pushes_have_parameters_that_are_zero(case, as_read):
    machine = pushable(as_read.simulation, case.search.places)
    assert machine.parameters[-1] == "push_0"
    assert machine.defaults[-1] == 0.0


def test_what_is_seen_of_a_change_is_the_observation_of_it(as_read):
    fit = as_read.fit
    change = np.random.default_rng(0).normal(size=(*fit.states.shape, 3))
    gained = as_read.simulation.with_observation("x", "2*x - 0.5*v")
    seen = carry_change(replace(as_read, machine=compile_simulation(gained)), change)
    np.testing.assert_allclose(seen[:, :, 0], 2 * change[:, :, 0] - 0.5 * change[:, :, 1], rtol=1e-6, atol=1e-6)


def test_a_late_sensor_sees_the_change_late(as_read):
    fit, late = as_read.fit, 5
    change = np.zeros((*fit.states.shape, 1))
    change[:, 10:, 0] = 1.0
    lagging = as_read.simulation.with_observation("x", f"delay(x, {late / 50})")
    seen = carry_change(replace(as_read, machine=compile_simulation(lagging)), change)[:, :, 0, 0]
    np.testing.assert_allclose(seen[:, 10 + late :], 1.0, rtol=1e-4)
    np.testing.assert_allclose(seen[:, late : 10 + late - 1], 0.0, atol=1e-6)


def test_a_hidden_state_whose_guess_stands_still_is_no_chaos():
    onward = np.broadcast_to([[0.9, 0.0], [5.0, 0.9]], (4, 30, 2, 2))
    moving = np.random.default_rng(0).normal(size=(4, 31, 2))
    still = moving * [1.0, 0.0] + [0.0, 0.3]
    line = Linearised(onward, np.zeros(0), np.zeros(0))
    assert line.first_growth(5.0, still) is None
    assert line.first_growth(5.0, moving) in {1, 2}
