from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from texts import says

from gaitdisc.errors import StrideError
from gaitdisc.signals.contacts import Contacts, order_findings


def contacts(times, side="r", detector="force"):
    return Contacts(np.array(times, float), side, detector)


@given(st.lists(st.floats(0.6, 1.4), min_size=2, max_size=20), st.floats(-0.1, 0.1))
def test_a_shift_is_found_and_nothing_is_missed(durations, shift):
    times = np.cumsum(durations)
    found = contacts(times).compared(contacts(times + shift, detector="markers"))
    assert len(found.difference_s) == len(times)
    assert found.median_ms == pytest.approx(1e3 * shift, abs=1e-6)
    assert (len(found.missed), len(found.extra)) == (0, 0)


def test_missed_and_extra_are_counted_within_the_span_of_both():
    found = contacts([0, 1, 2, 3, 4, 5]).compared(contacts([1.01, 2.5, 3.01, 4.03]))
    assert found.missed.tolist() == [2.0]
    assert found.extra.tolist() == [2.5]
    assert says(found.line(), "3 pairs", "+10 ms", "10 ms", "1 missed, 1 extra")


def test_the_interquartile_range_of_0_to_100_ms_is_50_ms():
    times = np.arange(101.0)
    found = contacts(times).compared(contacts(times + np.arange(101) / 1000))
    assert (found.median_ms, found.iqr_ms) == pytest.approx((50.0, 50.0))


def test_without_contacts_there_are_no_pairs():
    assert np.isnan(contacts([]).compared(contacts([1.0])).median_ms)


def test_two_feet_are_not_compared():
    with pytest.raises(StrideError, match=r"force of side 'r'.*'l'"):
        contacts([1.0]).compared(contacts([1.0], "l"))


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (([2.0, 1.0],), "out of order or missing"),
        (([1.0, np.nan],), "out of order or missing"),
        (([1.0], "x"), "found side 'x', detector 'force'"),
        (([1.0], "r", "eye"), "Detectors are force, markers, angles, events, oscillator"),
    ],
)
def test_contacts_that_are_none_are_refused(arguments, words):
    with pytest.raises(StrideError, match=words):
        contacts(*arguments)


def test_alternating_feet_have_no_findings():
    assert order_findings(contacts(np.arange(5)), contacts(np.arange(5) + 0.5, "l")) == []


def test_a_crossover_is_named_on_both_sides():
    right, left = contacts(np.arange(6)), contacts(np.delete(np.arange(6) + 0.5, 2), "l")
    first, second = order_findings(right, left, "walk.c3d")
    assert first.spans == ((2.0, 3.0),)
    assert says(first.what, "1 of 5 strides", "2.00 s")
    assert second.spans == ((1.5, 3.5),)
    assert says(first.spoils, "plate or belt")
