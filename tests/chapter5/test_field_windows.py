import numpy as np
import pytest
from chapter5.modes import fit_modes
from chapter5.reconstruct_field import field_windows, reading_names, snapshots_of, with_coefficients
from chapter5.routes import fixed, joined, random_walk
from manufactured_field import travelling_wave

from gaitdisc.errors import SamplingError
from gaitdisc.reconstruction.windows import Lags, split_within

WAVE = travelling_wave(120, quantities=2)
ROUTE = joined([fixed(WAVE, [3]), random_walk(WAVE, 1)])


def test_a_window_holds_what_the_route_reads_oldest_first():
    windows = field_windows(WAVE, ROUTE, Lags(3, 2), positions=True)
    read, places = ROUTE.readings(WAVE), ROUTE.places(WAVE)
    assert snapshots_of(windows)[[0, -1]].tolist() == [4, 119]
    row = np.concatenate([np.concatenate([read[t, k], places[t, k]]) for t in (6, 8, 10) for k in (0, 1)])
    np.testing.assert_array_equal(windows.x[6], row)
    assert [name.split(" of ") for name in windows.inputs[:3]] == [
        [x, "sensor 1 4 month ago"] for x in ("h", "g", "lat")
    ]
    assert windows.inputs[-4:] == ("h of sensor 2", "g of sensor 2", "lat of sensor 2", "lon of sensor 2")
    assert reading_names(WAVE, ROUTE) == ("h of sensor 1", "g of sensor 1", "h of sensor 2", "g of sensor 2")


def test_outputs_are_the_coefficients_of_the_snapshot_itself():
    parts = split_within([field_windows(WAVE, ROUTE, Lags(3, 2))], "temporal", 4)
    modes = fit_modes(WAVE.values[snapshots_of(parts.fitted())], 0.999)
    coefficients = modes.coefficients(WAVE.values)
    training, check, test = (
        with_coefficients(each, coefficients, modes.names) for each in (parts.fitted(), parts.checked(), parts.tested())
    )
    rows = snapshots_of(test)
    np.testing.assert_allclose(modes.fields(test.y), WAVE.values[rows], atol=0.1)
    assert training.outputs == modes.names
    assert snapshots_of(check)[0] - snapshots_of(training)[-1] > 4
    assert rows[0] - snapshots_of(check)[-1] > 4


def test_ahead_of_its_readings_a_window_tells_a_later_snapshot():
    now, later = field_windows(WAVE, ROUTE, Lags(3, 2)), field_windows(WAVE, ROUTE, Lags(3, 2, 5))
    assert snapshots_of(later)[[0, -1]].tolist() == [9, 119]
    np.testing.assert_array_equal(later.x, now.x[:-5])


def test_a_window_longer_than_the_field_is_refused():
    with pytest.raises(SamplingError, match=r"121 snapshots.*120"):
        field_windows(WAVE, ROUTE, Lags(122, 1))
    with pytest.raises(SamplingError, match=r"99 snapshots.*21 ahead.*120"):
        field_windows(WAVE, ROUTE, Lags(100, 1, 21))
