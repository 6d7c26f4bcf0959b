"""What a record went through: as the file says, or found and told."""

from dataclasses import replace

import numpy as np
import pytest
from hidden_in_a_mass import RATE, Experiment, mass, record, with_load
from scipy.signal import butter, sosfiltfilt
from texts import says

from gaitdisc.discovery import estimated_filter
from gaitdisc.discovery.case import set_up_case
from gaitdisc.discovery.estimated_filter import _as_the_surer
from gaitdisc.discovery.record_filter import CUTOFF_ERRORS
from gaitdisc.signals.recorded_filter import RecordedFilter
from gaitdisc.simulation.compiled_simulation import Drive, Rows
from gaitdisc.simulation.parts import Sensor
from gaitdisc.simulation.running import compile_simulation

LONG = Experiment(seconds=30.0, lowpass_hz=3.0)


@pytest.fixture(scope="module")
def filtered():
    return record(with_load("-14*x**3"), 3, LONG)


def test_a_filter_that_the_file_does_not_tell_of_is_found_and_told(filtered):
    case = set_up_case(mass(), filtered)
    assert case.record_filter.cutoffs_hz[0] == pytest.approx(3.0, rel=0.15)
    (finding,) = (one for one in case.measured.findings if one.kind == "low-pass")
    assert finding.channel == "x" and says(finding.what, "without lag (order 2") and "state lowpass" in finding.spoils
    tried = [one.record_filter.cutoffs_hz[0] / case.record_filter.cutoffs_hz[0] for one in case.at_other_cutoffs]
    assert tried == pytest.approx(CUTOFF_ERRORS)


def test_an_error_of_the_cut_off_is_no_missing_effect():
    case = set_up_case(mass(), record(mass(), 3, LONG))
    wrong = replace(case, record_filter=replace(case.record_filter, cutoffs_hz=(3.4,)))
    assert any(other.leaves_noise(other.as_read()) for other in wrong.at_other_cutoffs)


def test_what_the_file_says_stands(filtered):
    case = set_up_case(mass().with_sensor(Sensor("x", lowpass=5.0)), filtered)
    assert case.record_filter.cutoffs_hz == (5.0,) and case.at_other_cutoffs == []
    assert not [one for one in case.measured.findings if one.kind == "low-pass"]


@pytest.mark.parametrize("noise", [0.0, 0.02])
def test_a_raw_record_went_through_none(noise):
    case = set_up_case(mass(), record(with_load("-14*x**3"), 3, Experiment(seconds=30.0, noise=noise)))
    assert case.record_filter.cutoffs_hz == (None,) and case.at_other_cutoffs == [] and not case.measured.findings


def test_harmonics_of_a_stride_are_not_taken_for_the_fall_of_a_filter():
    # the power of a pulse once a stride falls like that of filtered noise, but lower down
    model, rng = mass(), np.random.default_rng(4)
    raw = record(model, 3, Experiment(seconds=40.0, noise=0.0))
    pushes = []
    for _ in raw.trials:
        strides = np.cumsum(1.07 + 0.02 * rng.standard_normal(60))
        t = np.arange(raw.drive.inputs.shape[1])[:, None] / RATE
        pushes.append(8 * np.exp(-(((t - strides) / 0.06) ** 2) / 2).sum(axis=1, keepdims=True))
    drive = Drive.of(pushes, RATE)
    machine = compile_simulation(model)
    rows = Rows(np.arange(len(pushes)), np.zeros(len(pushes), int), np.zeros((len(pushes), 2)))
    seen = machine.observe(drive, rows, machine.run(drive, rows, raw.observed.shape[1] - 1)[0])
    noisy = seen + 0.002 * rng.standard_normal(seen.shape)
    passed = sosfiltfilt(butter(2, 3.0, fs=RATE, output="sos"), noisy, axis=1)
    found = set_up_case(model, replace(raw, drive=drive, observed=passed)).record_filter.cutoffs_hz[0]
    assert found == pytest.approx(3.0, rel=0.1)


def test_of_a_linear_system_whose_inputs_were_filtered_alike_nothing_is_filtered_again():
    raw = record(mass(), 3, Experiment(seconds=30.0))
    rng = np.random.default_rng(1)
    sections = butter(2, 3.0, fs=RATE, output="sos")
    pushes = [one + rng.normal(0, 0.3, one.shape) for one in raw.drive.inputs]
    both = [sosfiltfilt(sections, one, axis=1) for one in (np.array(pushes), raw.observed)]
    passed = replace(raw, drive=Drive.of(list(both[0]), RATE), observed=both[1])
    assert set_up_case(mass(), passed).record_filter.cutoffs_hz == (None,)
    alone = replace(raw, observed=both[1])
    assert set_up_case(mass(), alone).record_filter.cutoffs_hz[0] == pytest.approx(3.0, rel=0.15)


@pytest.mark.slow
def test_a_filtered_record_of_a_stop_gives_the_strength_of_the_raw_one():
    truth = with_load("-60*max(0, x - 0.25)", "one_sided_spring")
    found = {}
    for lowpass in (0.0, 3.0):
        case = set_up_case(mass(), record(truth, 5, Experiment(seconds=15.0, lowpass_hz=lowpass)))
        now = case.search.extended(case.as_read())[1]
        found[lowpass] = abs(next(iter(now.parts[0].values.values())))
    assert now.labels == ("one_sided_spring@load",)
    assert found[3.0] == pytest.approx(found[0.0], rel=0.05) and found[0.0] == pytest.approx(60, rel=0.05)


def test_a_cut_off_that_the_signal_hides_is_that_of_the_surer_channels_of_the_same_unit():
    found = {
        number: RecordedFilter(cutoff, 0.0, signal)
        for number, (cutoff, signal) in enumerate([(5.0, 0.1), (7.2, 0.9), (3.9, 6.0), (20.0, 6.0)])
    }
    cutoffs = _as_the_surer(found, ["deg", "deg", "deg", "N"])
    assert cutoffs == {0: 5.0, 1: 7.2, 2: pytest.approx(6.0), 3: 20.0}


@pytest.mark.parametrize(("unit", "second"), [("m", 3.1), ("deg", 3.1), ("N", None)])
def test_what_a_spectrum_hides_is_sought_at_that_of_channels_of_its_unit(monkeypatch, filtered, unit, second):
    def find_filter(trials, rate_hz, like=None, at_hz=None):
        first = np.array_equal(trials[0], filtered.observed[0, :, 0])
        return RecordedFilter(3.1, 0.0, 0.0) if first or at_hz else None

    monkeypatch.setattr(estimated_filter, "find_filter", find_filter)
    observations = (("x", "x"), ("again", "2*x"))
    both = replace(mass(), observations=observations, sensors=(Sensor("x", "m"), Sensor("again", unit)))
    twice = replace(filtered, observed=filtered.observed * [1.0, 2.0], channels=("x", "again"))
    assert set_up_case(both, twice).record_filter.cutoffs_hz == (pytest.approx(3.1), second and pytest.approx(second))
