"""States from a few sensors, on arrays."""

import numpy as np
import pandas as pd
import pytest

import gaitdisc as gd
from gaitdisc.errors import ReadError, SamplingError, ShapeError, TrainingError

T = np.arange(0.0, 40.0, 0.02)
X = np.sin(2 * T)[:, None]
Y = np.column_stack([np.cos(2 * T), np.sin(2 * T + 0.7)])  # two readings of a sine tell its phase, one does not


def fitted(kind="delay ridge", **changes):
    return gd.Reconstructor(kind, rate_hz=50.0, history_s=0.4, **changes).fit(X[:1500], Y[:1500])


def test_a_history_reads_the_phase_that_the_present_does_not():
    assert fitted().score(X[1500:], Y[1500:]) > 0.999
    assert fitted("linear").score(X[1500:], Y[1500:]) < 0.7


def test_what_a_window_does_not_fill_is_missing_and_so_is_what_rests_on_a_gap():
    broken = X[1500:].copy()
    broken[100] = np.nan
    estimated = fitted().predict(broken)
    assert estimated.shape == Y[1500:].shape
    assert np.isnan(estimated[:20]).all() and np.isfinite(estimated[20:100]).all() and np.isnan(estimated[100]).all()


def test_a_forecast_is_scored_where_it_comes_true():
    ahead = fitted(ahead_s=0.2)
    early = X.copy()
    early[500:510] = np.nan  # what lies within 0.2 s before a state has no say in its forecast
    np.testing.assert_allclose(ahead.predict(early)[509], Y[509], atol=0.02)
    np.testing.assert_allclose(ahead.predict(X)[100:], Y[100:], atol=0.02)
    assert ahead.score(X[1500:], Y[1500:]) > 0.999


def test_several_trials_and_tables_go_and_their_columns_name_the_channels():
    x, y = pd.DataFrame(X, columns=["a"]), pd.DataFrame(Y, columns=["b", "c"])
    model = gd.Reconstructor(rate_hz=50.0, history_s=0.4).fit([x[:800], x[800:1600]], [y[:800], y[800:1600]])
    assert [channel.name for channel in model.model.channels] == ["a", "b", "c"]
    assert model.score(x[1600:], y[1600:]) > 0.999


def test_named_readings_are_found_by_name_and_recordings_at_their_rate():
    two = pd.DataFrame({"a": X[:, 0], "still": 0.1 * Y[:, 1]})
    model = gd.Reconstructor(rate_hz=50.0, history_s=0.4).fit(two, Y)
    turned = two.assign(more=1.0)[["still", "more", "a"]]
    np.testing.assert_array_equal(model.predict(turned), model.predict(two))
    with pytest.raises(ShapeError, match=r"still; 'still'.*not.*more"):
        model.predict(turned[["a", "more"]])
    with pytest.raises(ShapeError, match=r"'a' is a sensor and a state"):
        gd.Reconstructor(rate_hz=50.0).fit(two, two[["a"]])
    channels = tuple(gd.Channel(name, "signal", "1") for name in two)
    np.testing.assert_array_equal(model.predict(gd.Recording(T, two.to_numpy(), channels)), model.predict(two))
    with pytest.raises(SamplingError, match=r"50 samples.*25"):
        model.predict(gd.Recording(2 * T, two.to_numpy(), channels))


def test_it_is_saved_and_loaded(tmp_path):
    model = fitted(ahead_s=0.2)
    again = gd.load(model.save(tmp_path / "model"))
    assert isinstance(again, gd.Reconstructor) and repr(again) == repr(model)
    np.testing.assert_array_equal(again.predict(X), model.predict(X))
    np.testing.assert_array_equal(again.half_widths, model.half_widths)
    assert (again.history_s, again.spacing_s, again.ahead_s) == (0.4, 0.04, 0.2)


def test_what_does_not_fit_is_refused():
    with pytest.raises(TrainingError, match="fit was not called"):
        gd.Reconstructor().predict(X)
    with pytest.raises(ShapeError, match=r"x\[:, None\] for"):
        gd.Reconstructor().fit(X[:, 0], Y)
    with pytest.raises(ShapeError, match=r"\(2000, 1\).*\(1999, 2\)"):
        gd.Reconstructor(rate_hz=50.0).fit(X, Y[1:])
    with pytest.raises(ShapeError, match=r"readings and states must have the same.*2.*1"):
        gd.Reconstructor(rate_hz=50.0).fit([X, X], [Y])
    with pytest.raises(ShapeError, match=r"model \(1\);.*columns is 2"):
        fitted().predict(Y)


TABLE = pd.DataFrame(np.column_stack([X, np.cos(T)]), columns=["hip", "knee"])
STATES = pd.DataFrame(Y, columns=["ankle", "toe"])


def test_times_of_a_table_are_no_sensor_and_have_the_rate_of_the_model():
    model = gd.Reconstructor("linear", rate_hz=50.0, history_s=0.4).fit(TABLE.assign(time=T), STATES.assign(time=T))
    plain = gd.Reconstructor("linear", rate_hz=50.0, history_s=0.4).fit(TABLE, STATES)
    assert model.model.reconstructor.sensing.sensors == ("hip", "knee")
    for given in (TABLE, TABLE.assign(time=T)[["time", "knee", "hip"]], TABLE.set_index(pd.Index(T, name="time"))):
        np.testing.assert_array_equal(model.predict(given), plain.predict(TABLE))
    assert model.score(TABLE, STATES[["toe", "ankle"]]) == plain.score(TABLE.assign(time=T), STATES)
    with pytest.raises(SamplingError, match=r"50 samples.*25"):
        model.predict(TABLE.assign(time=2 * T))


def test_a_column_of_a_table_is_one_sensor():
    model = gd.Reconstructor("linear", rate_hz=50.0, history_s=0.4).fit(TABLE["hip"], STATES["ankle"])
    assert model.model.reconstructor.sensing.sensors == ("hip",) and model.predict(TABLE["hip"]).shape == (len(T), 1)


def test_scikit_learn_clones_chains_and_searches_it():
    from sklearn.base import clone
    from sklearn.model_selection import GridSearchCV, TimeSeriesSplit
    from sklearn.pipeline import make_pipeline
    from sklearn.preprocessing import StandardScaler

    model = gd.Reconstructor("linear", rate_hz=50, history_s=0.4)
    assert clone(model).get_params() == model.get_params() and repr(clone(model)) == repr(model)
    whole = make_pipeline(StandardScaler(), clone(model)).fit(TABLE, Y)
    assert whole.score(TABLE, Y) == pytest.approx(clone(model).fit(TABLE, Y).score(TABLE, Y), abs=1e-3)
    search = GridSearchCV(model, {"kind": ["linear", "delay ridge"]}, cv=TimeSeriesSplit(2)).fit(X, Y)
    assert search.best_params_ == {"kind": "delay ridge"}  # its history reads the phase
    with pytest.raises(TrainingError, match=r"kind, rate_hz.*found 'alpha'"):
        model.set_params(alpha=1.0)


def test_times_of_a_pair_that_differ_are_refused():
    """A pair is taken row by row: states of 0.3 s later would be learned as those of now."""
    early = pd.DataFrame({"angle": X[:1500, 0]}, index=pd.Index(T[:1500], name="time"))
    late = pd.DataFrame(Y[:1500], columns=["a", "b"], index=pd.Index(T[:1500] + 0.3, name="time"))
    said = r"row \d+.*readings.*[0-9.]+ s.*states.*[0-9.]+ s"
    model = gd.Reconstructor(rate_hz=50.0, history_s=0.4)
    for x, y in ((early, late), (early.rename_axis(None), late.rename_axis(None)), ([early], [late])):
        with pytest.raises(SamplingError, match=said):
            model.fit(x, y)
    model.fit(early, late.set_axis(early.index))
    with pytest.raises(SamplingError, match=said):
        model.score(early, late)
    model.fit(early.reset_index(drop=True), late.reset_index(drop=True))  # rows that are counted are no times


def test_complex_readings_are_refused_everywhere():

    for work in (
        lambda: gd.Reconstructor(rate_hz=50.0).fit(X * 1j, Y),
        lambda: gd.Reconstructor(rate_hz=50.0).fit(X, Y + 0j),
        lambda: gd.lowpass(X[:, 0] * 1j, rate_hz=50.0),
        lambda: gd.Recording(T, X * 1j, ()),
    ):
        with pytest.raises(ShapeError, match="complex"):
            work()
    with pytest.raises(ReadError, match=r"'knee_angle_r'.*complex128"):
        gd.read(pd.DataFrame({"time": T, "knee_angle_r": X[:, 0] * 1j}))
