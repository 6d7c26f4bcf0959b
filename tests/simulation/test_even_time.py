"""A clock that shakes, rows that are missing, empty cells: put on even times, or refused with the place."""

import numpy as np
import pytest
from texts import says

from gaitdisc.errors import ReadError, SamplingError
from gaitdisc.simulation.even_time import JITTER, TrialColumns, clock_findings, on_even_time

RATE, COUNT = 100.0, 400


def _x(t):
    return np.sin(2 * np.pi * 3 * t)


def _trial(time, x=None, inputs=None):
    return TrialColumns(
        "a", time, np.cos(time)[:, None] if inputs is None else inputs, (_x(time) if x is None else x)[:, None]
    )


def _shaken(share, seed=0):
    return np.arange(COUNT) / RATE + share / RATE * np.random.default_rng(seed).uniform(-1, 1, COUNT)


def test_an_even_clock_is_left_alone():
    trial = _trial(np.arange(COUNT) / RATE)
    even, rate, findings = on_even_time(trial, ("u",), "walk.csv")
    assert even is trial or np.array_equal(even.observed, trial.observed)
    assert (rate, findings) == (RATE, [])


def test_samples_taken_by_a_shaken_clock_are_moved_to_even_times():
    even, rate, (finding,) = on_even_time(_trial(_shaken(0.09)), ("u",), "walk.csv")
    assert rate == RATE
    truth = _x(even.time[0] + np.arange(COUNT) / RATE)
    before = np.abs(_x(_shaken(0.09)) - truth)[5:-5].max()
    assert np.abs(even.observed[:, 0] - truth)[5:-5].max() < 0.2 * before
    assert np.ptp(np.diff(even.time)) < 1e-9
    assert "resampled to even spacing" in finding.what and finding.kind == "clock"


def test_a_phase_that_a_shaken_clock_took_is_moved_and_stays_below_one():
    shaken = _shaken(0.09)
    even, _, _ = on_even_time(_trial(shaken, inputs=((shaken * 0.9 + 0.02) % 1)[:, None]), ("phase",), "walk.csv")
    truth = (even.time * 0.9 + 0.02) % 1
    apart = (even.inputs[:, 0] - truth + 0.5) % 1 - 0.5
    assert np.abs(apart).max() < 1e-6 and even.inputs.max() < 1


def test_samples_taken_evenly_and_stamped_late_are_left_as_they_are():
    x = _x(np.arange(COUNT) / RATE)
    even, rate, (finding,) = on_even_time(_trial(_shaken(0.09), x), ("u",), "walk.csv")
    np.testing.assert_array_equal(even.observed[:, 0], x)
    assert rate == RATE and "the samples are evenly spaced" in finding.what


def test_a_clock_that_shakes_more_is_refused():
    with pytest.raises(SamplingError, match=rf"{JITTER:g}.*walk.csv.*'a'"):
        on_even_time(_trial(_shaken(0.25)), ("u",), "walk.csv")


def test_missing_rows_are_empty_in_the_channels_and_bridged_in_the_inputs():
    time = np.delete(np.arange(COUNT) / RATE, [100, 101, 102, 250])
    even, rate, findings = on_even_time(_trial(time), ("u",), "walk.csv")
    assert rate == RATE and len(even.time) == COUNT
    assert np.flatnonzero(np.isnan(even.observed[:, 0])).tolist() == [100, 101, 102, 250]
    np.testing.assert_allclose(even.inputs[:, 0], np.cos(np.arange(COUNT) / RATE), atol=1e-3)
    assert [one.kind for one in findings] == ["gap in time", "bridged"]
    assert says(findings[0].what, "4 of 400 rows") and "at most 0.03 s in a row" in findings[1].what


def test_a_gap_of_percent_stride_is_bridged_through_its_turn():
    time = np.arange(COUNT) / RATE
    phase = (time * 0.9 + 0.02) % 1
    turn = int(np.flatnonzero(np.diff(phase) < 0)[0])
    empty = phase.copy()
    empty[turn - 4 : turn + 6] = np.nan
    even, _, _ = on_even_time(_trial(time, inputs=empty[:, None]), ("phase",), "walk.csv")
    np.testing.assert_allclose(even.inputs[:, 0], phase, atol=1e-12)


@pytest.mark.parametrize(
    ("first", "rows", "words"),
    [(50, 21, r"21 rows \(0.21 s\) without a value from t = 0.5 s on. Split the trial"), (0, 3, r"3 rows \(0.03 s\)")],
)
def test_a_gap_of_an_input_that_is_too_long_or_at_an_end_is_refused(first, rows, words):
    inputs = np.ones((COUNT, 1))
    inputs[first : first + rows] = np.nan
    with pytest.raises(ReadError, match=rf"0.2 s.*walk.csv.*'a'.*'u': {words}"):
        on_even_time(_trial(np.arange(COUNT) / RATE, inputs=inputs), ("u",), "walk.csv")


def test_whole_numbers_far_apart_are_said_to_look_like_milliseconds():
    trial = _trial(np.arange(COUNT) * 10.0)
    (finding,) = clock_findings([trial], 0.1, "walk.csv")
    assert "divide 'time' by 1000" in finding.spoils and says(finding.what, "10 s", "4000 s")
    assert clock_findings([_trial(np.arange(COUNT) / RATE)], RATE, "walk.csv") == []
    assert clock_findings([_trial(np.arange(COUNT) * 2.5)], 0.4, "walk.csv") == []
