from dataclasses import replace

import numpy as np
import pytest
from chapter5.reconstruct_field import CEILING, MEAN, SEASON, FieldTask, Label, field_cells, prepare, snapshots_of
from chapter5.reconstruct_field import reconstruct_field as reconstruct
from chapter5.routes import circuit, fixed
from manufactured_field import travelling_wave

from gaitdisc.reconstruction.windows import RANDOM, Lags

WAVE = travelling_wave()
TASK = FieldTask("wave", Lags(8, 3), energy=0.9999)


def test_the_history_of_one_sensor_tells_a_travelling_wave():
    cells = {cell.model: cell for cell in reconstruct(WAVE, fixed(WAVE, [30]), TASK, ("linear", "delay ridge"))}
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
    cells = {cell.model: cell for cell in reconstruct(field, fixed(field, [30]), task, ())}
    assert cells[SEASON].r2 == pytest.approx(1, abs=1e-6)


@pytest.mark.slow
def test_a_network_tells_it_too():
    out_and_back = circuit(WAVE, [(-2.0, 4.0), (-2.0, 16.0)], 12, "out and back")
    cells = reconstruct(WAVE, out_and_back, FieldTask("wave", Lags(4, 5), energy=0.999), ("shred",), floors=False)
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
        {cell.model: cell for cell in reconstruct(field, around, each, ("delay ridge",))}
        for each in (task, replace(task, departures=True))
    )
    assert apart["delay ridge, departures"].r2 > plain["delay ridge"].r2
    assert apart[SEASON].r2 == plain[SEASON].r2
    assert apart[CEILING].r2 > 0.999


def test_the_future_of_a_travelling_wave_is_forecast_and_its_split_keeps_the_longer_gap():
    task = FieldTask("wave", Lags(8, 3, 10), energy=0.9999)
    cells = {cell.model: cell for cell in reconstruct(WAVE, fixed(WAVE, [30]), task, ("delay ridge",))}
    assert cells["delay ridge"].relative_l2 < 1e-2
    ready = prepare(WAVE, fixed(WAVE, [30]), task)
    assert snapshots_of(ready.test)[0] - snapshots_of(ready.check)[-1] > 31
