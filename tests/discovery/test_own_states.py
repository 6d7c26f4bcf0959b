from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hidden_in_a_mass import Experiment, mass, record

from gaitdisc.discovery.case import set_up_case
from gaitdisc.discovery.first_states import followed, with_own_states
from gaitdisc.simulation.parts import State
from gaitdisc.simulation.running import compile_simulation


@pytest.fixture(scope="module")
def shooting():
    measured = record(mass(), 3, Experiment(trials=2, seconds=12.0, noise=0.0))
    return set_up_case(mass(), measured).as_read().shooting


def with_lag(seconds):
    return mass().with_state(State("slow", "N", initial=0.0), f"(push - slow)/{seconds}")


def test_a_lag_follows_its_input_as_the_convolution_with_its_exponential(shooting):
    machine = compile_simulation(with_lag(0.3))
    (own,) = followed(shooting, machine.simulation, machine.defaults[None])
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
    both = followed(shooting, machine.simulation, values)
    assert both.shape[0] == 2
    for version in (0, 1):
        np.testing.assert_array_equal(both[version], followed(shooting, machine.simulation, values[version][None])[0])
    assert np.abs(both[0] - both[1]).max() > 0.01


def test_starts_are_completed_by_the_own_states_and_else_left_alone(shooting):
    plain, machine = compile_simulation(mass()), compile_simulation(with_lag(0.3))
    segments = shooting.segments
    starts = np.zeros((len(segments), 2))
    np.testing.assert_array_equal(with_own_states(shooting, plain, plain.defaults, starts), starts)
    whole = with_own_states(shooting, machine, machine.defaults, starts)
    (own,) = followed(shooting, machine.simulation, machine.defaults[None])
    np.testing.assert_array_equal(whole, np.column_stack([starts, own[segments.trial, segments.begin, 0]]))


def test_what_is_not_known_of_the_record_is_bridged(shooting):
    gappy = shooting.past.copy()
    gappy[0, 100:105] = np.nan
    machine = compile_simulation(mass().with_state(State("z", "m", initial=0.0), "v - z/0.2"))
    (own,) = followed(replace(shooting, past=gappy), machine.simulation, machine.defaults[None])
    (whole,) = followed(shooting, machine.simulation, machine.defaults[None])
    assert np.isfinite(own).all()
    assert np.abs(own - whole).max() < 0.1 * whole.std()
