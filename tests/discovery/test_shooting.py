from dataclasses import replace

import numpy as np
import pytest
from hidden_in_a_mass import Experiment, mass, neuron, record

from gaitdisc.discovery.case import set_up_case
from gaitdisc.discovery.noise import white_noise
from gaitdisc.simulation.parts import Sensor
from gaitdisc.simulation.running import compile_simulation

COVERED = 20


def _shooting(seed=0, noise=0.02, value=24.0):
    case = set_up_case(mass(), record(mass().with_values({"k": value}), seed, Experiment(3, 8.0, noise)))
    segments = case.segments((0, 1, 2))
    shooting = case.shooting(segments)
    size = max(noise, 1e-6) * np.nanstd(case.measured.observed)
    return shooting.with_noise(white_noise(np.array([size]))), segments.starts(case.guess)


def test_a_parameter_that_is_wrong_in_the_file_is_found_without_noise():
    shooting, starts = _shooting(noise=0.0, value=31.0)
    machine = compile_simulation(mass())
    fit = shooting.fitted(machine, ("k",), machine.defaults, starts)
    assert fit.values[machine.parameters.index("k")] == pytest.approx(31.0, rel=2e-3)
    assert np.abs(fit.residual).max() < 2e-3


def test_start_states_are_found_from_far_away():
    shooting, starts = _shooting(noise=0.0)
    machine = compile_simulation(mass())
    fit = shooting.fitted(machine, (), machine.defaults, starts + 3.0, 30)
    assert np.abs(fit.residual).max() < 2e-3


def test_a_segment_that_began_on_the_wrong_side_of_a_threshold_is_begun_elsewhere():
    truth = neuron().with_values({"b": 1.0})
    case = set_up_case(neuron(), record(truth, 2, Experiment(seconds=20.0, noise=0.01)))
    segments = case.segments(case.learned)
    size = white_noise(0.01 * np.nanstd(case.measured.observed, axis=(0, 1)))
    shooting, machine = case.shooting(segments).with_noise(size), compile_simulation(neuron())
    fit = shooting.fitted(machine, ("b",), machine.defaults, segments.starts(case.guess), 30)
    assert (fit.misfits < 1.6 * fit.white.shape[1]).all()
    assert fit.values[machine.parameters.index("b")] == pytest.approx(1.0, abs=1e-3)


def test_the_interval_of_a_parameter_covers_the_truth_as_often_as_it_says():
    machine = compile_simulation(mass())
    place, inside = machine.parameters.index("k"), 0
    for seed in range(COVERED):
        shooting, starts = _shooting(seed, 0.05, 26.0)
        fit = shooting.fitted(machine, ("k",), machine.defaults, starts)
        inside += abs(fit.values[place] - 26.0) < 1.96 * np.sqrt(fit.covariance[0, 0])
    assert inside >= COVERED - 4  # 19 of 20; fewer than 16 has a chance of 3 in 1000


def test_slopes_are_those_of_finite_differences():
    shooting, starts = _shooting()
    machine = compile_simulation(mass())
    fit = shooting.at(machine, ("k",), machine.defaults, starts)
    values = machine.defaults.copy()
    values[machine.parameters.index("k")] += 0.01
    states, observed = shooting.run(machine, np.stack([starts, starts]), np.stack([machine.defaults, values]))
    change = shooting.whiten(observed[1] - observed[0]) / 0.01
    np.testing.assert_allclose(fit.slopes[..., 2], change, rtol=0.01, atol=1e-3 * np.abs(change).max())
    assert states.shape == (2, len(shooting.segments), shooting.segments.length, 2)


def test_steps_land_where_the_run_goes_on():
    shooting, starts = _shooting()
    machine = compile_simulation(mass())
    states, _ = shooting.run(machine, starts[None], machine.defaults[None])
    landed = shooting.landed(machine, states[:, :, :-1], machine.defaults[None])
    np.testing.assert_allclose(landed, states[:, :, 1:], rtol=1e-12)


def test_what_is_measured_along_a_run_is_its_observation():
    shooting, starts = _shooting()
    gained = mass().with_observation("x", "3*x + 1")
    machine = compile_simulation(gained)
    states, observed = shooting.run(machine, starts[None], machine.defaults[None])
    np.testing.assert_allclose(observed[..., 0], 3 * states[..., 0] + 1)
    np.testing.assert_array_equal(shooting.observed(machine, states, machine.defaults[None]), observed)


def test_samples_that_are_missing_do_not_count():
    shooting, starts = _shooting()
    observed = shooting.measured.observed.copy()
    observed[0, 5:9] = np.nan
    machine = compile_simulation(mass())
    gap = replace(shooting, measured=replace(shooting.measured, observed=observed))
    whole, with_gap = (one.at(machine, ("k",), machine.defaults, starts) for one in (shooting, gap))
    assert with_gap.misfit < whole.misfit
    assert not with_gap.slopes[0, 5:9].any()


def test_a_run_that_leaves_every_bound_is_infinitely_wrong():
    shooting, starts = _shooting()
    machine = compile_simulation(mass())
    values = machine.defaults.copy()
    values[machine.parameters.index("c")] = -400.0
    assert shooting.fitted(machine, ("k",), values, starts).misfit == np.inf


def test_a_fitted_run_becomes_the_past_of_what_comes_late():
    shooting, _ = _shooting()
    states = np.ones((len(shooting.segments), shooting.segments.length, 2))
    past = shooting.with_past(states).past
    assert past is not None
    assert (shooting.segments.of(past) == 1).all()
    assert replace(shooting, past=None).with_past(states).past is None


FILTERED = Experiment(3, 10.0, 0.02, lowpass_hz=0.7)


def _filtered(stated):
    simulation = mass().with_sensor(Sensor("x", lowpass=0.7)) if stated else mass()
    case = set_up_case(simulation, record(mass().with_values({"k": 31.0, "c": 1.4}), 5, FILTERED))
    segments = case.segments((0, 1, 2))
    return case.shooting(segments), segments.starts(case.guess)


@pytest.mark.parametrize("stated", [True, False])
def test_a_filtered_record_gives_the_true_numbers_where_the_simulation_is_filtered_alike(stated):
    shooting, starts = _filtered(stated)
    machine = compile_simulation(mass())
    fit = shooting.fitted(machine, ("k", "c"), machine.defaults, starts, 30, 1e-9)
    off = np.abs(fit.values[[machine.parameters.index(name) for name in ("k", "c")]] / [31.0, 1.4] - 1).max()
    assert off < 0.03 if stated else off > 0.08


def test_slopes_of_a_filtered_record_are_those_of_finite_differences():
    shooting, starts = _filtered(True)
    machine = compile_simulation(mass())
    fit = shooting.at(machine, ("k",), machine.defaults, starts)
    values = machine.defaults.copy()
    values[machine.parameters.index("k")] += 0.01
    more = shooting.at(machine, (), values, starts)
    np.testing.assert_allclose(fit.slopes[..., -1], (fit.white - more.white) / 0.01, atol=2e-4)
    assert fit.residual.shape[1] == len(range(*shooting.segments.compared.indices(shooting.segments.length)))
