from __future__ import annotations

import os
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hidden_in_a_mass import Experiment, mass, record, with_load
from texts import says

from gaitdisc.discovery.discover import discover
from gaitdisc.discovery.spiked_samples import mark_spikes, without_spikes
from gaitdisc.simulation.measured_table import read_measured
from gaitdisc.simulation.simulation_file import read_simulation

DATA = Path(os.environ.get("GAITDISC_DATA", Path(__file__).parents[2].parent / "shared" / "data"))
HARDWARE = DATA / "hidden_effect" / "real" / "cases"

T = np.arange(3000) / 100
NOISE = np.random.default_rng(1).standard_normal(3000)


def with_spikes(measured, trial, seed=0):
    """The trials with one in a hundred samples of one of them 20 standard deviations off, and which."""
    seen, rng = measured.observed.copy(), np.random.default_rng(seed)
    here = rng.choice(seen.shape[1], seen.shape[1] // 100, replace=False)
    seen[trial, here, 0] += 20 * seen[trial].std() * rng.choice([-1, 1], len(here))
    return replace(measured, observed=seen), np.sort(here)


def falling_and_bouncing(kept, step):
    """Height and rate of a ball that keeps a share of its speed in each bounce, from the parabolas of its flights."""
    times, rate = np.arange(0, 8, step), np.sqrt(2 * 9.81)
    height, speed = 1 - 9.81 * times**2 / 2, -9.81 * times
    begin = rate / 9.81
    while rate > 0.1:
        rate *= kept
        since = times - begin
        height = np.where(since >= 0, np.maximum(rate * since - 9.81 * since**2 / 2, 0), height)
        speed = np.where(since >= 0, rate - 9.81 * since, speed)
        begin += 2 * rate / 9.81
    return height, np.where(times >= begin, 0.0, speed)


@pytest.mark.parametrize("size", [20.0, 5.0, 2.0])
def test_single_samples_far_from_their_neighbours_are_marked_and_no_other(size):
    x, rng = np.sin(5 * T) + 0.05 * NOISE, np.random.default_rng(2)
    here = rng.choice(np.arange(3, 2997, 4), 30, replace=False)
    x[here] += size * rng.choice([-1, 1], 30)
    assert np.flatnonzero(mark_spikes(x)).tolist() == sorted(here)


def test_up_to_three_in_a_row_are_marked_and_four_are_not():
    x = np.sin(5 * T)
    x[100:103] += 3.0
    x[200:202] -= [2.0, 4.0]
    x[300:304] += 3.0
    assert np.flatnonzero(mark_spikes(x)).tolist() == [100, 101, 102, 200, 201]


def test_the_first_and_the_last_sample_may_be_spikes_and_empty_cells_stay():
    x = np.sin(5 * T)
    x[[0, -1]] += 5.0
    x[1000:1040] = np.nan
    assert np.flatnonzero(mark_spikes(x)).tolist() == [0, 2999]


@pytest.mark.parametrize(
    "motion",
    [
        *(np.sign(np.sin(2 * np.pi * T * 100 / period + 0.3)) for period in (4, 6, 20)),
        *(np.round(np.sin(3 * T) / least) * least for least in (0.5, 0.1, 0.02)),
        *(np.diff(np.round(np.cumsum(np.sin(3 * T)) / least)) for least in (0.5, 0.02)),
        *(one for kept in (0.6, 0.85) for step in (0.005, 0.01, 0.03) for one in falling_and_bouncing(kept, step)),
        np.clip(np.sin(3 * T), 0, 1) ** 4 * np.abs(NOISE),
        np.cumsum(NOISE),
        NOISE,
        (0.13 * np.arange(3000) + np.pi) % (2 * np.pi),
    ],
)
def test_what_moves_fast_has_no_spikes(motion):
    assert not mark_spikes(motion).any()
    assert not mark_spikes(motion + 0.01 * NOISE[: len(motion)]).any()


def test_spikes_are_emptied_with_channel_trial_number_and_time():
    clean = record(mass(), 3, Experiment(3, 6.0))
    measured, here = with_spikes(clean, 1)
    found = without_spikes(measured)
    assert np.flatnonzero(np.isnan(found.observed[1, :, 0])).tolist() == here.tolist()
    assert np.isfinite(found.observed[[0, 2]]).all()
    (finding,) = found.findings
    assert (finding.severity, finding.kind, finding.channel) == ("warning", "spike", "x")
    assert says(finding.what, f"'2': {len(here)} of 300 samples", f"{here[0] / 50:.4g} s")
    assert [span[0] for span in finding.spans] == pytest.approx(here / 50)


def test_a_record_without_spikes_is_the_same_object():
    clean = record(with_load("-3*sign(v)"), 3, Experiment(3, 6.0))
    assert without_spikes(clean) is clean


def test_of_many_trials_the_first_are_named():
    measured = record(mass(), 3, Experiment(5, 6.0))
    for trial in range(5):
        measured, _ = with_spikes(measured, trial, trial)
    (finding,) = without_spikes(measured).findings
    assert "trial '3'" in finding.what and "trial '4'" not in finding.what
    assert finding.what.endswith("; further trials with spikes: 2")


def test_a_wrong_number_is_found_as_well_with_spikes_in_one_trial_as_without():
    measured, _ = with_spikes(record(with_load("-0.8*v"), 3, Experiment(3, 6.0)), 1)
    found, _ = discover(mass(), measured)
    assert [(one.name, one.place) for one in found.effects] == [("wrong_parameter", "c")]
    estimate = found.effects[0].estimates["value"]
    assert estimate.value == pytest.approx(1.6, rel=0.02)  # 0.8 in the file, 0.8 hidden
    assert estimate.high - estimate.low < 0.05
    assert [one.kind for one in found.findings] == ["spike"]


@pytest.mark.skipif(not HARDWARE.exists(), reason="records of hardware are not here")
def test_records_of_hardware_lose_no_sample():
    cases = sorted(HARDWARE.iterdir())
    assert len(cases) >= 12  # with impacts, encoders, friction that sticks, square waves
    for case in cases:
        measured = read_measured(case / "measured.csv", read_simulation(case / "simulation.toml"))
        assert without_spikes(measured) is measured, case.name
