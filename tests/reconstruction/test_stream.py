"""Readings one by one as they come, calibrated first."""

from dataclasses import replace

import numpy as np
import pytest

from gaitdisc.errors import SchemaError, ShapeError, StrideError
from gaitdisc.reconstruction.calibration import PENALTIES, calibrate, first_strides, rehearse
from gaitdisc.reconstruction.model_folder import SensingModel, Stream
from gaitdisc.reconstruction.window_model import MASKED, STATIC, fit_reconstructor
from gaitdisc.reconstruction.windows import with_missing

RIDGES = ("linear", "delay ridge", "fourier ridge")


@pytest.fixture(scope="module")
def fitted(pair):
    return {kind: fit_reconstructor(kind, pair.what, pair.parts.fitted(), pair.parts.checked()) for kind in RIDGES}


@pytest.mark.parametrize("kind", [*RIDGES, "shred", "shred ensemble", "shred-text"])
def test_a_stream_tells_what_the_recording_tells(pair, fitted, untrained, kind):
    done = fitted[kind] if kind in RIDGES else untrained(kind)
    stream = Stream(done)
    states = np.array([stream.update(row) for row in pair.recording.selected(["a"]).values[:120]])
    windows = pair.what.windows(pair.recording, np.zeros(3000))
    reach = pair.what.lags.reach
    wanted = done(windows)[: 120 - reach]
    np.testing.assert_allclose(states[reach:], wanted, rtol=1e-9 if kind in RIDGES else 1e-6)
    assert np.isnan(states[:reach]).all() == (kind not in STATIC)


def test_a_network_that_is_corrected_for_a_person_streams_too(pair, untrained):
    test = pair.parts.tested()
    done = calibrate(untrained("shred"), test)
    stream = Stream(done)
    states = [stream.update(row) for row in pair.recording.selected(["a"]).values[:60]]
    windows = pair.what.windows(pair.recording, np.zeros(3000))
    np.testing.assert_allclose(states[50:], done(windows)[:10], rtol=1e-6)


def test_a_dropped_reading_is_not_made_up(pair, fitted):
    stream = Stream(fitted["delay ridge"])
    for row in pair.recording.selected(["a"]).values[:60]:
        stream.update(row)
    assert np.isnan(stream.update([np.nan])).all()
    found = [bool(np.isnan(stream.update([0.0])).all()) for _ in range(51)]
    assert found == [ago % 5 == 0 for ago in range(1, 51)] + [False]


@pytest.mark.parametrize("way", ["mean", "last"])
def test_what_stands_for_a_dropped_reading(pair, fitted, way):
    lost = with_missing(pair.recording.selected(["a"]), ["a"], 0.3, 0.05)
    kept = SensingModel(fitted["delay ridge"], pair.channels, np.ones(1))
    stream = Stream(fitted["delay ridge"], way)
    states = np.array([stream.update(row) for row in lost.values[:200]])
    np.testing.assert_allclose(states, kept(lost, way).values[:200], rtol=1e-10)
    assert np.isfinite(states[50:]).all()
    with pytest.raises(SchemaError, match="'zero'"):
        Stream(fitted["delay ridge"], "zero")


def test_a_masked_model_needs_nothing_in_place_of_a_dropped_reading(pair, untrained):
    done = untrained(MASKED)
    lost = with_missing(pair.recording, ["a"], 0.3, 0.05)
    stream = Stream(done)
    states = np.array([stream.update(row) for row in lost.selected(["a"]).values])
    np.testing.assert_allclose(states, SensingModel(done, pair.channels, np.ones(1))(lost).values, atol=1e-5)
    assert np.isfinite(states[pair.what.lags.reach :]).mean() > 0.99


@pytest.mark.slow
def test_a_masked_model_has_learnt_to_do_without(pair):
    done = fit_reconstructor(MASKED, pair.what, pair.parts.fitted(), pair.parts.checked())
    test, sd = pair.parts.tested(), pair.recording["late"].std()
    assert (done(test) - test.y).std() < 0.2 * sd
    lost = with_missing(pair.recording, ["a"], 0.3, 0.05)
    windows = pair.what.windows(lost, np.zeros(3000), missing=True)
    assert (done(windows) - windows.y).std() < 0.7 * sd  # the very reading is missing: its neighbours tell it


def test_a_reading_with_too_many_values(fitted):
    with pytest.raises(ShapeError, match=r"the array.*\(2,\)"):
        Stream(fitted["linear"]).update([1.0, 2.0])


@pytest.fixture
def delayed(pair):
    return fit_reconstructor("delay ridge", pair.what, pair.parts.fitted(), pair.parts.checked())


def changed(trials):
    """A person whose state is another mixture of what the sensor reads now and read a while ago, and higher by 4."""
    return [replace(s, y=s.y * 1.5 - 0.4 * s.x[:, -1:] + 4.0) for s in trials]


def test_the_rest_shares_no_reading_with_the_first_strides(pair):
    strides, after = first_strides(pair.parts.training, 3, pair.what.reach_s)
    windows = pair.parts.fitted()
    gap = windows.time[after][0] - strides.time[-1]
    assert gap == pytest.approx(pair.what.reach_s + 0.3, abs=0.02)
    assert len(np.unique(np.floor(strides.time))) == 3


def test_the_gap_is_left_in_the_trial_of_the_last_stride_alone(pair):
    one = pair.parts.fitted()
    _, after = first_strides([one.rows(one.time < 3.0), one], 3, pair.what.reach_s)
    before = int((one.time < 3.0).sum())
    assert after[before:].all()
    assert not after[:before].any()


def test_another_linear_mixture_is_learnt_from_a_few_strides(pair, delayed):
    windows = changed(pair.parts.training)
    strides, after = first_strides(windows, 8, pair.what.reach_s)
    rest = windows[0].rows(after)
    before = np.sqrt(np.mean((delayed(rest) - rest.y) ** 2))
    after = np.sqrt(np.mean((calibrate(delayed, strides, PENALTIES[0])(rest) - rest.y) ** 2))
    assert before > 4.0
    assert after < 0.01 * before


def test_a_large_penalty_takes_the_mean_error_off_and_nothing_else(pair, delayed):
    windows = changed(pair.parts.training)
    strides, _ = first_strides(windows, 8, pair.what.reach_s)
    found = calibrate(delayed, strides, 1e12)(windows[0])
    offset = (strides.y - delayed(strides)).mean(axis=0)
    assert np.allclose(found, delayed(windows[0]) + offset)


def test_the_penalty_is_rehearsed_on_another_person(pair, delayed):
    penalty, missed = rehearse(delayed, changed(pair.parts.training), 8)
    assert penalty == PENALTIES[0]
    assert np.sqrt(np.mean(missed**2)) < 0.05


def test_too_few_strides_are_refused_in_words(pair):
    with pytest.raises(StrideError, match=r"500 strides.*P01"):
        first_strides(pair.parts.training, 500, pair.what.reach_s)
