"""The record's filter: that of scipy, forgotten after a period of its cut-off, and linear."""

import numpy as np
import pytest
from scipy.signal import butter, sosfiltfilt

from gaitdisc.discovery.record_filter import RecordFilter

RUNS = np.random.default_rng(0).normal(size=(3, 5, 150, 2, 4)).cumsum(axis=2)


@pytest.mark.parametrize("cutoff", [2.0, 6.0, 30.0])
def test_it_is_two_passes_of_a_butterworth_filter(cutoff):
    passed = RecordFilter((cutoff, None), 100.0)
    found = passed.filtered(RUNS, 2)
    sections = butter(2, cutoff, fs=100.0, output="sos")
    wanted = sosfiltfilt(sections, RUNS[..., 0, :], 2, "odd", min(2 * passed.margin, 149))
    np.testing.assert_allclose(found[..., 0, :], wanted, atol=1e-9)
    np.testing.assert_array_equal(found[..., 1, :], RUNS[..., 1, :])


def test_what_it_is_given_is_left_as_it_was():
    before = RUNS.copy()
    RecordFilter((6.0, 6.0), 100.0).filtered(RUNS, 2)
    np.testing.assert_array_equal(RUNS, before)


def test_beyond_the_margins_the_ends_of_a_run_do_not_count():
    passed = RecordFilter((6.0,), 100.0)
    t = np.arange(600) / 100
    whole = np.sin(2 * np.pi * 2 * t) + t**2
    part = slice(200, 330)
    long, short = (passed.filtered(one[None, :, None], 1)[0, :, 0] for one in (whole, whole[part]))
    apart = np.abs(short - long[part])
    assert apart[passed.margin : -passed.margin].max() < 0.002
    assert apart.max() > 0.01


def test_a_straight_line_passes():
    line = np.linspace(3.0, 8.0, 90)[None, :, None]
    np.testing.assert_allclose(RecordFilter((4.0,), 100.0).filtered(line, 1), line, atol=1e-4)


def test_it_leaves_of_white_noise_what_its_gain_says():
    passed = RecordFilter((6.0, None), 100.0)
    noise = np.random.default_rng(1).normal(size=(1, 40000, 2))
    np.testing.assert_allclose(passed.filtered(noise, 1).std(axis=(0, 1)), passed.gains, rtol=0.03)


def test_without_a_cut_off_nothing_is_done():
    none = RecordFilter((None, None), 100.0)
    assert (none.margin, none.every, none.gains.tolist()) == (0, 1, [1.0, 1.0])
    assert none.filtered(RUNS, 2) is RUNS


@pytest.mark.parametrize(("cutoffs", "every"), [((6.0,), 4), ((6.0, 3.0), 4), ((6.0, None), 1), ((40.0,), 1)])
def test_only_as_many_samples_are_compared_as_hold_what_passes(cutoffs, every):
    assert RecordFilter(cutoffs, 100.0).every == every


def test_the_memory_of_filtered_noise_is_that_of_its_samples():
    passed = RecordFilter((6.0,), 100.0)
    noise = passed.filtered(np.random.default_rng(2).normal(size=(1, 200000, 1)), 1)[0, :: passed.every, 0]
    measured = [np.mean(noise[: len(noise) - lag] * noise[lag:]) / noise.var() for lag in range(5)]
    np.testing.assert_allclose(passed.autocorrelation(4)[:, 0], measured, atol=0.03)
    assert RecordFilter((None,), 100.0).autocorrelation(2)[:, 0].tolist() == [1.0, 0.0, 0.0]


def test_what_is_twice_the_noise_that_the_spectrum_shows_is_more_than_noise():
    """Of channels whose noise no spectrum shows, any size may be noise."""
    passed = RecordFilter((6.0, 6.0, None), 100.0, noise={0: 0.1})
    np.testing.assert_array_equal(passed.at_most_noise(np.array([0.19, 9.0, 9.0])), [0.19, 9.0, 9.0])
    np.testing.assert_array_equal(passed.at_most_noise(np.array([0.21, 9.0, 9.0])), [0.1, 9.0, 9.0])
