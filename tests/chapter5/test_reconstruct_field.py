"""Fields from few sensors: windows, tasks, cells, paths that were never fitted."""

from dataclasses import replace

import numpy as np
import pytest
from chapter5.modes import fit_modes
from chapter5.reconstruct_field import (
    ALONE,
    BINS,
    CEILING,
    MANY_PLACED,
    MEAN,
    OTHER,
    OWN,
    SEASON,
    FieldCell,
    FieldTask,
    Label,
    error_counts,
    field_cells,
    field_cells_table,
    field_windows,
    latent_sizes,
    load_cells,
    prepare,
    reading_names,
    reconstruct_field,
    save_cells,
    snapshots_of,
    unseen_path,
    with_coefficients,
)
from chapter5.routes import circuit, fixed, fixed_at_random, joined, random_walk
from manufactured_field import travelling_wave

from gaitdisc.errors import ChannelError, SamplingError
from gaitdisc.reconstruction.windows import RANDOM, Lags, split_within
from gaitdisc.saved.unit_folder import seal_text
from gaitdisc.whole_file import write_whole

WAVE = travelling_wave()
TASK = FieldTask("wave", Lags(8, 3), energy=0.9999)


def test_the_history_of_one_sensor_tells_a_travelling_wave():
    cells = {cell.model: cell for cell in reconstruct_field(WAVE, fixed(WAVE, [30]), TASK, ("linear", "delay ridge"))}
    assert cells["delay ridge"].relative_l2 < 1e-2  # four modes, eight readings: linear in them, exactly
    assert cells["linear"].relative_l2 > 0.5
    assert cells[MEAN].r2 == pytest.approx(0, abs=1e-9)
    assert cells[CEILING].r2 > 0.9999
    assert cells["linear"].fitted == 265  # 70 % of 379 windows
    assert np.isclose(cells["linear"].rmse ** 2, cells["linear"].bias ** 2 + cells["linear"].sd ** 2)


def test_a_field_that_is_its_season_is_reconstructed_by_it():
    year = np.sin(2 * np.pi * np.arange(400) / 12)[:, None, None] * WAVE.values[:1]
    field = type(WAVE)(WAVE.time, year, WAVE.axes, WAVE.mask, ("h",), ("m",))
    task = FieldTask("year", Lags(3, 1), season=12)
    cells = {cell.model: cell for cell in reconstruct_field(field, fixed(field, [30]), task, ())}
    assert cells[SEASON].r2 == pytest.approx(1, abs=1e-6)


@pytest.mark.slow
def test_a_network_tells_it_too():
    out_and_back = circuit(WAVE, [(-2.0, 4.0), (-2.0, 16.0)], 12, "out and back")
    cells = reconstruct_field(WAVE, out_and_back, FieldTask("wave", Lags(4, 5), energy=0.999), ("shred",), floors=False)
    assert [cell.model for cell in cells] == ["shred"]
    assert cells[0].r2 > 0.9


def test_modes_and_windows_of_the_test_part_take_no_part():
    ready = prepare(WAVE, fixed(WAVE, [30]), TASK)
    np.testing.assert_allclose(ready.targets.mean, WAVE.values[snapshots_of(ready.training)].mean(axis=0), atol=1e-5)
    assert snapshots_of(ready.test)[0] - snapshots_of(ready.check)[-1] > TASK.lags.reach
    leaky = prepare(WAVE, fixed(WAVE, [30]), FieldTask("wave", Lags(8, 3), RANDOM))
    assert np.abs(snapshots_of(leaky.test)[:, None] - snapshots_of(leaky.training)).min() == 1


def test_errors_are_of_each_quantity_in_its_unit():
    field = travelling_wave(quantities=2)
    ready = prepare(field, fixed(field, [30]), TASK)
    found = field.values[snapshots_of(ready.test)] + np.float32([0.1, 0.3])
    cells = field_cells(field, ready, Label("wave", "r", "temporal", "m", 0), found)
    np.testing.assert_allclose([(cell.rmse, cell.bias) for cell in cells], [(0.1, 0.1), (0.3, 0.3)], rtol=1e-5)
    assert [(cell.quantity, cell.unit) for cell in cells] == [("h", "m"), ("g", "m")]


def test_departures_are_reconstructed_about_the_season_and_tested_with_it():
    """A season twice as strong as the waves, another mean at each point: only departures are linear in the readings."""
    t = np.arange(400)
    year = 2 * np.sin(2 * np.pi * (t % 12) / 12)[:, None, None] + np.linspace(-9, 9, WAVE.points)[None, :, None]
    field = type(WAVE)(WAVE.time, WAVE.values + year, WAVE.axes, WAVE.mask, ("h",), ("m",))
    around = circuit(field, [(-2.0, 4.0), (-2.0, 16.0)], 12, "out and back")
    task = FieldTask("year", Lags(8, 3), energy=0.9999, season=12)
    plain, apart = (
        {cell.model: cell for cell in reconstruct_field(field, around, each, ("delay ridge",))}
        for each in (task, replace(task, departures=True))
    )
    assert apart["delay ridge, departures"].r2 > plain["delay ridge"].r2
    assert apart[SEASON].r2 == plain[SEASON].r2
    assert apart[CEILING].r2 > 0.999


def test_the_future_of_a_travelling_wave_is_forecast_and_its_split_keeps_the_longer_gap():
    task = FieldTask("wave", Lags(8, 3, 10), energy=0.9999)
    cells = {cell.model: cell for cell in reconstruct_field(WAVE, fixed(WAVE, [30]), task, ("delay ridge",))}
    assert cells["delay ridge"].relative_l2 < 1e-2
    ready = prepare(WAVE, fixed(WAVE, [30]), task)
    assert snapshots_of(ready.test)[0] - snapshots_of(ready.check)[-1] > 31


def test_a_cell_is_named_after_its_task():
    assert TASK.label("r", TASK.named("linear")) == Label("wave", "r", "temporal", "linear", 0)
    task = replace(TASK, departures=True, rule=RANDOM, seed=3)
    assert task.label("r", task.named("linear")) == Label("wave", "r", RANDOM, "linear, departures", 3)


TWO = travelling_wave(120, quantities=2)
ROUTE = joined([fixed(TWO, [3]), random_walk(TWO, 1)])


def test_a_window_holds_what_the_route_reads_oldest_first():
    windows = field_windows(TWO, ROUTE, Lags(3, 2), positions=True)
    read, places = ROUTE.readings(TWO), ROUTE.places(TWO)
    assert snapshots_of(windows)[[0, -1]].tolist() == [4, 119]
    row = np.concatenate([np.concatenate([read[t, k], places[t, k]]) for t in (6, 8, 10) for k in (0, 1)])
    np.testing.assert_array_equal(windows.x[6], row)
    assert [one.split(" of ") for one in windows.inputs[:3]] == [[x, "sensor 1 4 month ago"] for x in ("h", "g", "lat")]
    assert windows.inputs[-4:] == ("h of sensor 2", "g of sensor 2", "lat of sensor 2", "lon of sensor 2")
    assert reading_names(TWO, ROUTE) == ("h of sensor 1", "g of sensor 1", "h of sensor 2", "g of sensor 2")


def test_outputs_are_the_coefficients_of_the_snapshot_itself():
    parts = split_within([field_windows(TWO, ROUTE, Lags(3, 2))], "temporal", 4)
    modes = fit_modes(TWO.values[snapshots_of(parts.fitted())], 0.999)
    coefficients = modes.coefficients(TWO.values)
    training, check, test = (
        with_coefficients(each, coefficients, modes.names) for each in (parts.fitted(), parts.checked(), parts.tested())
    )
    rows = snapshots_of(test)
    np.testing.assert_allclose(modes.fields(test.y), TWO.values[rows], atol=0.1)
    assert training.outputs == modes.names
    assert snapshots_of(check)[0] - snapshots_of(training)[-1] > 4
    assert rows[0] - snapshots_of(check)[-1] > 4


def test_ahead_of_its_readings_a_window_tells_a_later_snapshot():
    now, later = field_windows(TWO, ROUTE, Lags(3, 2)), field_windows(TWO, ROUTE, Lags(3, 2, 5))
    assert snapshots_of(later)[[0, -1]].tolist() == [9, 119]
    np.testing.assert_array_equal(later.x, now.x[:-5])


def test_a_window_longer_than_the_field_is_refused():
    with pytest.raises(SamplingError, match=r"121 snapshots.*120"):
        field_windows(TWO, ROUTE, Lags(122, 1))
    with pytest.raises(SamplingError, match=r"99 snapshots.*21 ahead.*120"):
        field_windows(TWO, ROUTE, Lags(100, 1, 21))


def cell(errors, **changed):
    return FieldCell(**{
        "field": "sea", "quantity": "sst", "unit": "degC", "route": "1 fixed", "split": "temporal", "model": "shred",
        "relative_l2": 0.5, "rmse": 1.0, "bias": 0.0, "sd": 1.0, "r2": 0.7, "fitted": 100, "tested": 20, "seconds": 1.0,
        "run": 0, "errors": error_counts(errors, 1.0),
    } | changed)  # fmt: skip


def test_every_error_is_counted_once_also_those_beyond():
    errors = np.random.default_rng(0).normal(size=(50, 40)) * 3
    counts = error_counts(errors, 1.0)
    assert counts.counts.sum() == 2000
    assert counts.counts[-1] >= (errors > 4).sum()
    assert (len(counts.counts), counts.edges[0], counts.edges[-1]) == (BINS, -4, 4)


def test_what_is_kept_is_found_again_unless_other_settings_made_it(tmp_path):
    kept = cell(np.array([0.1, -9.0, 0.1]))
    save_cells([kept], {"lags": (13, 8), "seed": 1}, tmp_path / "a.json")
    found = load_cells({"lags": (13, 8), "seed": 1}, tmp_path / "a.json")
    assert found is not None
    assert found[0].relative_l2 == kept.relative_l2
    np.testing.assert_array_equal(found[0].errors.counts, kept.errors.counts)
    np.testing.assert_array_equal(found[0].errors.edges, kept.errors.edges)
    assert load_cells({"lags": (25, 4), "seed": 1}, tmp_path / "a.json") is None
    assert load_cells({}, tmp_path / "b.json") is None


def test_cells_that_were_saved_under_an_earlier_name_of_their_test_snapshots_are_found_again(tmp_path):
    cells = {**vars(cell(np.zeros(3))), "errors": {"edges": [0.0, 1.0], "counts": [3]}}
    cells["judged"] = cells.pop("tested")
    write_whole(tmp_path / "a.json", seal_text({"made_by": {}, "cells": [cells]}))
    assert [one.tested for one in load_cells({}, tmp_path / "a.json") or []] == [20]


def test_the_table_has_a_row_a_cell():
    table = field_cells_table([cell(np.zeros(3)), cell(np.zeros(3), model="linear")])
    assert table["model"].tolist() == ["shred", "linear"]
    assert "errors" not in table


SHORT = travelling_wave(240)


def test_the_error_on_a_path_never_fitted_is_stated():
    routes = [fixed(SHORT, [k]) for k in (5, 20, 40, 60)]
    task = FieldTask("wave", Lags(6, 3), energy=0.999)
    cells = {cell.route: cell for cell in unseen_path(SHORT, routes, fixed(SHORT, [33]), task, ("fourier ridge",))}
    own, other = cells[f"{OWN}; {ALONE}"], cells[f"{OTHER}; {ALONE}"]
    placed = cells[f"{OTHER}; {MANY_PLACED.format(4)}"]
    assert own.r2 > 0.9
    assert other.r2 < 0  # a reading means another phase at another place
    assert other.r2 < placed.r2
    assert placed.fitted == 4 * own.fitted


def test_one_path_is_not_many():
    with pytest.raises(ChannelError, match=r"2 paths.*1, 2 sensors"):
        unseen_path(SHORT, [fixed(SHORT, [1]), fixed_at_random(SHORT, 2, 0)], fixed(SHORT, [3]),
                    FieldTask("wave", Lags(6, 3)), ())  # fmt: skip


@pytest.mark.slow
def test_four_modes_need_more_than_one_node(monkeypatch):
    monkeypatch.setattr("gaitdisc.models.training_settings.count_epochs", lambda *_: 100)  # of two steps each
    wave = travelling_wave(200)
    found = latent_sizes(wave, fixed(wave, [30]), FieldTask("wave", Lags(3, 6), energy=0.999), (1, 8), epochs=5)
    assert found["nodes"].tolist() == [1, 8]
    assert found["r2"].iloc[1] > found["r2"].iloc[0]
    assert found["energy_left"].iloc[0] > 0.05
    assert found["energy_left"].iloc[1] < 1e-6
