from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from hidden_in_a_mass import Experiment, mass, record, with_load
from scipy.signal import butter, sosfiltfilt

from gaitdisc.discovery.case import SHORT, hangs_on_step, set_up_case, split_in_time
from gaitdisc.discovery.catalogue import Request, Shape
from gaitdisc.discovery.discover import discover
from gaitdisc.discovery.folder import save_discovery
from gaitdisc.discovery.noise import sensor_noise, white_noise
from gaitdisc.discovery.page import write_discovery_report
from gaitdisc.discovery.record_filter import RecordFilter
from gaitdisc.discovery.scored_model import Part, score
from gaitdisc.simulation.compiled_simulation import Drive, Rows
from gaitdisc.simulation.measured import Measured
from gaitdisc.simulation.parts import Sensor
from gaitdisc.simulation.running import compile_simulation
from gaitdisc.simulation.simulation_file import parse_simulation


@pytest.mark.parametrize(("trials", "held"), [(2, (1,)), (4, (3,)), (8, (6, 7))])
def test_of_four_trials_one_is_held_out(trials, held):
    case = set_up_case(mass(), record(mass(), 0, Experiment(trials, 4.0)))
    assert case.held_out == held
    assert case.learned == tuple(range(held[0]))


def test_one_trial_is_split_in_time_and_what_is_learned_and_held_out_share_no_sample():
    measured = record(mass(), 0, Experiment(1, 8.0))
    two = split_in_time(measured)
    assert two.trials == ("1", "1, last quarter")
    assert two.samples.tolist() == [300, 100]
    np.testing.assert_array_equal(two.observed[1, :100], measured.observed[0, 300:])
    np.testing.assert_array_equal(two.drive.inputs[1, :100], measured.drive.inputs[0, 300:])
    assert two.time(1)[0] == pytest.approx(measured.time(0)[300])
    assert np.isnan(two.observed[1, 100:]).all()
    case = set_up_case(mass(), measured)
    assert set(case.segments(case.learned).trial).isdisjoint(case.segments(case.held_out).trial)


def ringing(lengths: tuple[int, ...], rate: float = 10.0) -> Measured:
    """Return trials of any lengths of a mass that is let go, about 18 samples a period."""
    rng, count = np.random.default_rng(0), len(lengths)
    drive, machine = Drive.of([np.zeros((length, 1)) for length in lengths], rate), compile_simulation(mass())
    rows = Rows(np.arange(count), np.zeros(count, int), rng.normal(0, 1, (count, 2)))
    states, _ = machine.run(drive, rows, max(lengths) - 1)
    seen = np.where(np.isfinite(states[..., :1]), machine.observe(drive, rows, states), np.nan)
    return Measured(drive, seen + rng.normal(0, 0.01, seen.shape), tuple("abcd"[:count]), machine.observed)


def test_runs_are_cut_again_as_they_were():
    case = set_up_case(mass(), ringing((240, 200, 220, 268)))
    for trials in (case.learned, case.held_out, (0, 1, 2, 3)):
        for periods in np.linspace(0.5, 12, 60):
            once = case.segments(trials, periods)
            again = case.segments(trials, once.length / (case.rhythm.period * case.rhythm.rate))
            assert (again.length, again.begin.tolist()) == (once.length, once.begin.tolist())


def test_trials_of_unequal_length_are_answered_written_and_drawn(tmp_path):
    found, _ = discover(mass(), ringing((240, 200, 220, 268)))
    assert found.verdict == "no_gap"
    assert found.runs.time.shape == found.runs.measured.shape[:2]
    assert save_discovery(found, tmp_path).exists()
    assert "no gap" in write_discovery_report(found, tmp_path).read_text()


def test_runs_are_about_a_period_long(case):
    period = case.rhythm.period * case.rhythm.rate
    assert case.segments(case.learned).length == pytest.approx(period, rel=0.25)


def test_runs_are_shorter_where_a_change_of_the_start_grows_fast():
    unstable = mass().with_equation("v", "60*x + push + load")
    calm = set_up_case(mass(), record(mass(), 0, Experiment(4, 6.0)))
    wild = set_up_case(unstable, record(mass(), 0, Experiment(4, 6.0)))
    assert calm.predictable_periods() == 1.0
    growing = wild.predictable_periods() * wild.rhythm.period
    assert np.cosh(np.sqrt(60) * growing) == pytest.approx(3.0, abs=2.0)


def test_as_read_only_the_starts_are_fitted(as_read):
    assert as_read.parts == ()
    np.testing.assert_array_equal(as_read.fit.values, as_read.machine.defaults)


def test_a_right_account_is_followed_over_half_a_trial_or_more_and_no_run_is_longer_than_wanted(case, as_read, cubic):
    part = Part(cubic, {"factor": -14.0})
    true = as_read.refitted(as_read.shooting, (part,))
    longer = case.lengthen(score(true))
    assert longer.shooting.segments.length >= case.measured.samples.min() / 2
    assert longer.parts[0].values["factor"] == pytest.approx(-14.0, rel=0.005)
    length = as_read.shooting.segments.length
    assert case.lengthen(as_read, 2 * length).shooting.segments.length <= 2 * length


def test_shapes_of_the_users_own_are_searched():
    case = set_up_case(mass(), record(with_load("0"), 0, Experiment(2, 4.0)), Request((Shape("quintic", ("x**5",)),)))
    assert "quintic@load" in {one.label for one in case.search.candidates}


def test_the_noise_of_the_sensors_is_what_the_file_says_behind_the_filter():
    measured = record(mass(), 3, Experiment(trials=2, seconds=6.0))
    progress = mass().with_sensor(Sensor("x", "m", 0.03, 3.0))
    case = set_up_case(progress, measured)
    assert case.record_filter == RecordFilter((3.0,), measured.rate)
    assert case.sensor_noise == pytest.approx(0.03 * case.record_filter.gains)
    assert case.noise_floor(np.array([0.5])) == case.sensor_noise
    plain = set_up_case(mass(), measured)
    assert plain.sensor_noise == pytest.approx(sensor_noise(measured.observed))
    silent = replace(plain, record_filter=RecordFilter((3.0,), measured.rate))
    assert np.isnan(silent.sensor_noise).all() and silent.noise_floor(np.array([0.5])) == 0.5
    shown = replace(silent, record_filter=RecordFilter((3.0,), measured.rate, noise={0: 0.2}))
    assert shown.noise_floor(np.array([0.3])) == 0.3 and shown.noise_floor(np.array([0.5])) == 0.2


def test_white_residuals_larger_than_the_spectrums_noise_are_not_noise():
    case = set_up_case(mass(), record(mass(), 3, Experiment(trials=2, seconds=6.0)))
    passed = RecordFilter((3.0,), case.measured.rate)
    raw = np.random.default_rng(0).normal(size=(4, 200, 1))
    residual = sosfiltfilt(butter(2, 3.0, fs=case.measured.rate, output="sos"), raw, axis=1)
    now = SimpleNamespace(noise=white_noise(np.ones(1)), fit=SimpleNamespace(residual=residual))
    for size, noise in ((0.9 * np.std(residual), True), (0.4 * np.std(residual), False)):
        shown = replace(case, record_filter=replace(passed, noise={0: float(size)}))
        assert shown.leaves_noise(now) == noise


def test_a_trial_too_short_for_whole_margins_is_cut_all_the_same():
    measured = record(mass(), 3, Experiment(trials=3, seconds=1.6))
    case = set_up_case(mass().with_sensor(Sensor("x", lowpass=1.0)), measured)
    segments = case.segments((0, 1))
    assert segments.margin == 80 // SHORT and segments.span >= 8
    assert np.isfinite(case.as_read().fit.misfit)


def lagging(lag):
    """A first-order lag [s] recorded every 30 ms."""
    text = f"""
title = "Lag"
[states.m]
unit = "N"
[inputs.u]
unit = "N"
[parameters.lag]
value = {lag}
unit = "s"
[equations]
m = "(u - m)/lag"
"""
    t = np.arange(200) * 0.03
    u = np.sin(t)
    seen = np.stack([u + np.random.default_rng(seed).normal(0, 0.01, len(t)) for seed in range(4)])[..., None]
    measured = Measured(Drive.of([u[:, None]] * 4, 1 / 0.03), seen, ("1", "2", "3", "4"), ("m",))
    return set_up_case(parse_simulation(text, "lag.toml"), measured)


@pytest.mark.parametrize(("lag", "steps"), [(0.1, 2), (0.004, 4)])  # two steps of 15 ms run away below 5.4 ms
def test_a_fast_state_is_integrated_in_steps_that_do_not_run_away(lag, steps):
    assert lagging(lag).substeps == steps


@pytest.mark.parametrize(("lag", "hangs"), [(0.1, False), (0.0055, True)])  # two steps are stable above 15 ms / 2.785
def test_what_is_found_at_the_edge_of_stability_hangs_on_the_integration_step(lag, hangs):
    as_read = lagging(0.1).as_read()
    values, starts = np.array([lag]), as_read.fit.starts + 0.5
    fit = as_read.shooting.at(as_read.machine, (), values, starts)
    now = replace(as_read, fit=fit)
    assert hangs_on_step(lagging(0.1), now) == hangs
