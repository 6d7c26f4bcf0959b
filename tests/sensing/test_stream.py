import numpy as np
import pytest

from gaitdisc.errors import SchemaError, ShapeError
from gaitdisc.sensing.calibration import calibrated
from gaitdisc.sensing.missing import with_missing
from gaitdisc.sensing.model_folder import SensingModel, Stream
from gaitdisc.sensing.reconstructor import MASKED, STATIC, fit_reconstructor

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
    done = calibrated(untrained("shred"), test)
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
    with pytest.raises(SchemaError, match="'zero' is none"):
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
    with pytest.raises(ShapeError, match=r"found an array.*\(2,\)"):
        Stream(fitted["linear"]).update([1.0, 2.0])
