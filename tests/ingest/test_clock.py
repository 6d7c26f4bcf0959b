"""Printed digits are evened out, missing samples are not."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gaitdisc.errors import SamplingError
from gaitdisc.ingest.cells import even_time, printed_digit


def test_printed_digit_is_the_finest_one():
    assert printed_digit(["0", "0.45", "0.451"]) == 1e-3
    assert printed_digit(["  1.501e-03"]) == pytest.approx(1e-6)
    assert printed_digit(["3", "words", "nan"]) == 1.0
    assert printed_digit(["0,25"]) == 0.01


def test_zeros_that_fill_up_a_number_are_no_digits():
    """Times rounded to ms and printed with six digits, as OpenSim's own marker files have them."""
    assert printed_digit(["0.000000", "0.017000", "0.033000"]) == 1e-3
    assert printed_digit(["100", "200"]) == 1.0


@given(
    st.sampled_from([50.0, 59.94, 60.0, 100.0, 120.0, 148.148, 200.0, 250.0, 1000.0]),
    st.integers(3, 3000),
    st.floats(0, 500),
)
def test_rounded_times_come_back_even_and_near(rate, count, start):
    true = start + np.arange(count) / rate
    digit = 10.0 ** -np.ceil(np.log10(rate / 0.3))
    printed = np.round(true / digit) * digit
    even = even_time(printed, digit, "a.mot")
    assert np.ptp(np.diff(even)) < 1e-9
    assert np.abs(even - true).max() < 2.1 * digit


def test_an_even_base_is_left_as_it_is():
    time = 0.1 + np.arange(100) / 60
    assert even_time(time, 1e-16, "a.mot") is time


def test_a_whole_rate_is_found_behind_the_digits():
    time = np.round(np.arange(601) / 60, 3)
    assert 1 / np.diff(even_time(time, 1e-3, "a.mot")).mean() == pytest.approx(60, abs=1e-9)


@pytest.mark.parametrize("digits", [2, 3, 8])
def test_one_missing_sample_is_not_taken_for_rounding(digits):
    time = np.delete(np.round(np.arange(1000) / 100, digits), 500)
    with pytest.raises(SamplingError, match=r"line 511.*line 512.*0\.02 s.*4\.99 s"):
        even_time(time, 10.0**-digits, "a.mot", np.arange(12, 12 + 999))


def test_too_few_digits_are_refused():
    with pytest.raises(SamplingError, match=r"times are printed.*1e-02 s"):
        even_time(np.round(np.arange(100) / 60, 2), 1e-2, "a.mot")


@pytest.mark.parametrize(
    ("time", "words"),
    [
        ([0.0], "at least two samples; it has 1"),
        ([0.0, np.nan, 2.0], "every sample needs a time; row 2 has nan"),
        ([0.0, 1.0, 1.0], "time must increase; row 3 has t = 1 s after 1 s"),
        ([0.0, 1.0, 0.5], "time must increase"),
    ],
)
def test_times_that_are_none_are_refused(time, words):
    with pytest.raises(SamplingError, match=words):
        even_time(np.array(time), 0.1, "a.mot")
