import numpy as np
import pytest

from gaitdisc.errors import ShapeError
from gaitdisc.sensing.reconstructor import fit_reconstructor
from gaitdisc.sensing.stream import Stream


@pytest.fixture(scope="module")
def fitted(pair):
    return {
        kind: fit_reconstructor(kind, pair.what, pair.parts.fitted(), pair.parts.checked())
        for kind in ("linear", "delay ridge")
    }


@pytest.mark.parametrize("kind", ["linear", "delay ridge"])
def test_a_stream_tells_what_the_recording_tells(pair, fitted, kind):
    stream = Stream(fitted[kind])
    told = np.array([stream.update(row) for row in pair.recording.selected(["a"]).values[:120]])
    windows = pair.what.windows(pair.recording, np.zeros(3000))
    reach = pair.what.lags.reach
    np.testing.assert_allclose(told[reach:], fitted[kind](windows)[: 120 - reach], rtol=1e-9)
    assert np.isnan(told[:reach]).all() == (kind == "delay ridge")


def test_a_dropped_reading_is_not_made_up(pair, fitted):
    stream = Stream(fitted["delay ridge"])
    for row in pair.recording.selected(["a"]).values[:60]:
        stream.update(row)
    assert np.isnan(stream.update([np.nan])).all()
    found = [bool(np.isnan(stream.update([0.0])).all()) for _ in range(51)]
    assert found == [ago % 5 == 0 for ago in range(1, 51)] + [False]


def test_a_reading_with_too_many_values(fitted):
    with pytest.raises(ShapeError, match=r"one value for each of a; found an array of shape \(2,\)"):
        Stream(fitted["linear"]).update([1.0, 2.0])
