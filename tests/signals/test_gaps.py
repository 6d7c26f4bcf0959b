from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from texts import says

from gaitdisc.channel import Channel
from gaitdisc.recording import Recording, Strides
from gaitdisc.signals.gaps import filled, gap_findings, gap_spans

KNEE = Channel("knee_angle_r", "angle", "deg", "r")
TIME = np.arange(1000) / 100


def recording(x):
    return Recording(TIME, np.asarray(x, float)[:, None], (KNEE,))


def broken(x, start, length):
    x = x.copy()
    x[start : start + length] = np.nan
    return recording(x)


def test_gap_spans_are_in_seconds():
    assert gap_spans(broken(TIME, 100, 5), "knee_angle_r") == ((1.0, 1.05),)


@settings(deadline=None, max_examples=30)
@given(st.integers(25, 900), st.integers(1, 10))
def test_a_cubic_is_filled_exactly_and_marked(start, length):
    x = TIME**3 - 4 * TIME**2 + TIME
    done = filled(broken(x, start, length))
    assert np.allclose(done.values[:, 0], x, atol=1e-8)
    assert np.flatnonzero(done.suspect[:, 0]).tolist() == list(range(start, start + length))


def test_what_is_measured_is_not_touched():
    done = filled(broken(np.sin(TIME), 300, 8))
    kept = np.r_[0:300, 308:1000]
    assert np.array_equal(done.values[kept, 0], np.sin(TIME)[kept])


def test_a_long_gap_stays_open_and_spoils_150_ms_beside_it():
    done = filled(broken(np.sin(TIME), 300, 11))
    assert np.isnan(done.values[300:311, 0]).all()
    assert np.flatnonzero(done.suspect[:, 0]).tolist() == list(range(285, 326))


def test_a_gap_at_an_end_stays_open():
    assert np.isnan(filled(broken(np.sin(TIME), 0, 3)).values[:3, 0]).all()
    assert np.isnan(filled(broken(np.sin(TIME), 997, 3)).values[997:, 0]).all()


def test_strides_bring_200_ms_back():
    x = 20 * np.sin(2 * np.pi * TIME) + 5 * np.cos(6 * np.pi * TIME) + 0.5 * TIME
    strides = Strides(np.arange(9.0), np.arange(1.0, 10.0), "r", "force")
    done = filled(broken(x, 430, 20), strides)
    assert np.abs(done.values[:, 0] - x).max() < 0.3
    assert np.isnan(filled(broken(x, 430, 21), strides).values[430:451, 0]).all()


def test_too_few_whole_strides_make_no_template():
    strides = Strides(np.arange(4.0), np.arange(1.0, 5.0), "r", "force")
    assert np.isnan(filled(broken(np.sin(TIME), 130, 15), strides).values[130:145, 0]).all()


def test_findings_tell_short_from_long():
    short, long = gap_findings(broken(np.sin(TIME), 300, 8))[0], gap_findings(broken(np.sin(TIME), 300, 30))[0]
    assert (short.severity, long.severity) == ("note", "warning")
    assert says(short.what, "1 gap, 0.080 s", "10.00 s", "0.080 s")
    assert long.spans == ((3.0, 3.3),)
    assert gap_findings(recording(np.sin(TIME))) == []


@pytest.mark.parametrize(("samples", "severity"), [(5, "note"), (30, "warning")])
def test_a_short_gap_at_an_end_is_a_note_and_stays_open(samples, severity):
    """A recording that begins 50 ms later would be said to lack nothing."""
    late = broken(np.sin(TIME), 0, samples)
    assert [one.severity for one in gap_findings(late)] == [severity]
    assert np.isnan(filled(late).values[:samples]).all()


def test_an_empty_channel_is_one_gap():
    finding = gap_findings(recording(np.full(1000, np.nan)))[0]
    assert finding.severity == "warning"
    assert finding.spans == ((0.0, pytest.approx(10.0)),)
