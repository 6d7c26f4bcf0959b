import json
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from gaitdisc.channel import Channel
from gaitdisc.reconstruction.reconstruction import (
    MEASURES,
    RECONSTRUCTION,
    Reconstruction,
    enough_sensors,
    mean_over_people,
)
from gaitdisc.saved.provenance import Provenance


@pytest.fixture
def done():
    rows = [
        {"participant": p, "model": m, "strides": 9, "n_fitted": 100, **dict.fromkeys(MEASURES, value + k)}
        for k, p in enumerate(("P01", "P02", "P03"))
        for m, value in (("linear", 8.0), ("fourier ridge", 1.01), ("shred", 1.0))
    ]
    errors = pd.DataFrame(
        {"participant": "P01", "model": ["linear", "shred"], "state": "knee", "unit": "deg", "rmse": [2.0, 1.0],
         "low": 0.5, "high": 3.0, "relative_l2": 0.1, "r2": 0.9}
    )  # fmt: skip
    knee, hip = (Channel(f"{name}_r", "angle", "deg", "r") for name in ("knee_angle", "hip_flexion"))
    provenance = Provenance({}, 0, {}, {}, "5.3.3", "2026-01-01T00:00:00+00:00")
    models = {"linear": "a line", "fourier ridge": "cosines", "shred": "a network"}
    return Reconstruction(
        "two",
        (hip,),
        (knee,),
        "temporal",
        "25 readings",
        models,
        errors,
        pd.DataFrame(rows),
        errors,
        (),
        (),
        provenance,
    )


def test_the_mean_over_participants_has_students_interval(done):
    over = done.over_participants().loc["shred"]
    assert over["rmse_deg"] == 2.0
    assert over["rmse_deg_high"] - over["rmse_deg"] == pytest.approx(4.302653 / np.sqrt(3), rel=1e-6)


def test_the_cheaper_model_is_recommended_where_it_errs_no_more_than_two_percent_more(done):
    assert done.recommended == "fourier ridge"
    worse = done.summary.assign(
        check_loss=done.summary["check_loss"] * np.where(done.summary["model"] == "shred", 0.5, 1)
    )
    assert type(done)(**{**vars(done), "summary": worse}).recommended == "shred"


def test_it_is_saved_with_its_tables(done, tmp_path):
    done.save(tmp_path)
    kept = json.loads((tmp_path / "reconstruction.json").read_text())
    assert kept["recommended"] == "fourier ridge"
    assert set(kept["sha256"]) == {"errors.csv", "summary.csv", "curves.csv"}
    assert len(pd.read_csv(tmp_path / "summary.csv")) == 9


@pytest.mark.parametrize(("losses", "row"), [([1.0, 0.5, 0.49], 1), ([1.0, 0.95], 0), ([1.0, 0.5, 0.2], 2), ([1.0], 0)])
def test_enough_is_where_one_more_takes_less_than_a_tenth_off(losses, row):
    assert enough_sensors(pd.DataFrame({"loss": losses})) == row


def test_a_calibrated_model_does_not_decide_which_is_recommended(done):
    better = done.summary[done.summary["model"] == "linear"].assign(model="linear, calibrated", check_loss=0.001)
    both = replace(done, summary=pd.concat([done.summary, better]))
    assert both.recommended == done.recommended


def test_a_search_is_saved_with_the_rest(done, tmp_path):
    replace(done, search=pd.DataFrame({"sensors": [1], "names": ["a"]})).save(tmp_path)
    assert (tmp_path / "search.csv").read_text().splitlines() == ["sensors,names", "1,a"]


def test_a_floor_of_forecasts_is_not_recommended_and_what_was_asked_for_may_be(done):
    floor, asked = (
        done.summary[done.summary["model"] == "linear"].assign(model=model, check_loss=loss)
        for model, loss in (("phase average", 1e-4), ("masked shred", 1e-3))
    )
    assert replace(done, summary=pd.concat([done.summary, floor])).recommended == done.recommended
    assert replace(done, summary=pd.concat([done.summary, floor, asked])).recommended == "masked shred"


def test_two_people_have_a_mean_and_no_interval():
    mean, sd, half = mean_over_people(np.array([1.0, 3.0]))
    assert mean == 2.0
    assert np.isnan([sd, half]).all()


def test_it_comes_back_with_names_that_look_like_numbers(done, tmp_path):
    named = replace(
        done,
        summary=done.summary.assign(participant=done.summary["participant"].str.replace("P01", "007")),
        curves=done.errors.assign(percent=0.0, measured=1.0, measured_sd=0.1, unit="1"),
    )
    named.save(tmp_path)
    again = RECONSTRUCTION.load(tmp_path)
    assert again.participants == named.participants == ("007", "P02", "P03")
    for table in ("errors", "summary", "curves"):
        pd.testing.assert_frame_equal(getattr(again, table), getattr(named, table))
    assert (again.sensors, again.models, again.recommended) == (done.sensors, done.models, "fourier ridge")
    assert again.to_frame() is again.errors
    assert "from 1 sensors" in repr(again) and "<th>recommended model</th>" in again._repr_html_()
