"""Studies of chapter 5's gait: one person, many, and sets of sensors."""

import ch5_gait
import numpy as np
import pandas as pd
import pytest
from chapter5.gait import MEASURES, Wanted, disturbance_figure, sensor_sets_figure, sensor_sets_table
from texts import says

from gaitdisc.reconstruction.page import search_sentences, search_table


def test_a_box_a_model_and_set_angles_and_translations_apart():
    rows = [
        (sensors, person, model, state, unit, value)
        for sensors in ("3 sagittal", "1 sagittal")
        for person in ("P01", "P02")
        for model, value in (("linear", 5.0), ("shred", 1.0), ("shred, calibrated", 0.5))
        for state, unit in (("knee_angle_l", "deg"), ("hip_flexion_l", "deg"), ("pelvis_tx", "m"))
    ]
    errors = pd.DataFrame(rows, columns=pd.Index(["sensors", "participant", "model", "state", "unit", "rmse"]))
    figure = sensor_sets_figure(errors, "two people", "boxes", "temporal")
    left, right = figure.drawn.axes
    assert [label.get_text() for label in left.get_xticklabels()] == ["3 sagittal", "1 sagittal"]
    assert (left.get_ylabel(), right.get_ylabel()) == ("RMSE of a state [deg]", "RMSE of a state [m]")
    assert set(figure.numbers["model"]) == {"linear", "shred"}
    assert "n = 2 participants" in figure.caption


@pytest.fixture
def table():
    rows = [
        {"data": "cohort", "sensors": "1 sagittal", "participant": f"P{k}", "model": model, "seed": seed,
         **dict.fromkeys(MEASURES, value + 0.1 * k + 0.02 * seed)}
        for k in range(3) for model, value in (("linear", 2.0), ("delay ridge", 1.0)) for seed in (-1, 1)
    ]  # fmt: skip
    printed = pd.DataFrame({"sensors": ["1 sagittal"], "model": ["linear"], "mean": [1.083], "sd": [0.705]})
    return sensor_sets_table(pd.DataFrame(rows), printed, "sets", "temporal")


def test_mean_interval_and_deviation_over_participants(table):
    row = dict(zip(table.columns, table.rows[0], strict=True))
    half = 4.3027 * 0.1 / np.sqrt(3)
    assert row["RMSE [deg]"] == f"2.10 [{2.1 - half:.2f}, {2.1 + half:.2f}]"
    assert (row["n"], row["its seeds"]) == ("3", "2.08 to 2.12, 2")  # n counts people, whatever the seeds
    assert [row[name] for name in row if says(name, "with sensors ± sd", "[1]")] == ["2.100 ± 0.100"]


def test_what_is_printed_stands_beside_it_and_nothing_where_nothing_is(table):
    assert [row[-2] for row in table.rows] == ["1.083 ± 0.705", "–"]


def test_the_caption_says_what_the_printed_numbers_are(table):
    assert "the norm of the error" in table.caption
    assert "no claim of better or worse" in table.caption


@pytest.fixture
def found():
    names = ["knee_angle_l", "hip_flexion_r, knee_angle_l", "ankle_angle_r, hip_flexion_r, knee_angle_l"]
    return pd.DataFrame(
        {"sensors": [1, 2, 3], "names": names, "loss": [1.0, 0.25, 0.2304], "rmse_deg": [4.0, 2.0, 1.9],
         "fits": [18, 153, 816], "seconds": 0.5}
    )  # fmt: skip


def test_the_smallest_set_that_does_is_marked(found):
    rows = search_table(found).rows
    assert [row[0] for row in rows] == ["1", "2 *", "3"]
    assert rows[1][1] == "hip flexion, right and knee angle, left"
    assert rows[1][2:5] == ("0.500", "2.00", "153")


def test_the_sentence_says_how_many_which_what_one_more_brings_and_the_cost(found):
    [said] = search_sentences(found)
    assert says(said, "2 sensors are enough", "right hip flexion", "left knee angle", "by 4 %")
    assert said.endswith("(search: 987 regressions, 1.5 s).")


def test_a_search_that_was_too_short_says_so(found):
    [said] = search_sentences(found.iloc[:2])
    assert says(said, "best set of 2 sensors", "right hip flexion", "left knee angle", "may not be enough")
    assert "no larger set was tried" in said and "are enough" not in said


def test_one_panel_a_disturbance_and_one_line_a_model():
    rows = [
        (disturbance, level, model, 1.0 + level)
        for disturbance, models in (("noise", ("shred",)), ("missing", ("shred", "masked shred")))
        for level in (0.0, 0.1)
        for model in models
    ]
    found = pd.DataFrame(rows, columns=pd.Index(["disturbance", "level", "model", "rmse_deg"]))
    figure = disturbance_figure(found, "W01, 3 sensors")
    noise, missing = figure.drawn.axes
    assert (len(noise.get_lines()), len(missing.get_lines())) == (1, 2)
    assert list(np.asarray(noise.get_lines()[0].get_xdata())) == [0.0, 10.0]
    assert says(figure.caption, "masked shred", "which are lost")


def test_the_table_of_the_dissertation_is_that_of_the_text():
    rows = ch5_gait.gait.printed("individual").set_index(["sensors", "model"])["mean"]
    assert (len(rows), rows["3 sagittal", "shred"], rows["1 random", "linear"]) == (4 * 3, 0.064, 1.096)


def test_the_runners_and_the_treadmill_walks_are_found(gait_data, tmp_path):
    assert [len(person.trials) for person in ch5_gait.gait.exotendon(gait_data).participants] == [2, 1]
    assert len(ch5_gait.gait.treadmill(gait_data, tmp_path).participants[0].trials) == 12


@pytest.mark.slow
def test_history_divides_the_error_and_windows_drawn_at_random_hide_it(tmp_path):
    result = ch5_gait.individual(Wanted(True, tmp_path))
    rmse = result.cells[result.cells["sensors"] == "3 sagittal"].set_index("model")["rmse_deg"]
    assert rmse["delay ridge"] < 0.35 * rmse["linear"]
    text = result.page.read_text(encoding="utf-8")
    assert "random (leaks)" in text and "the norm of the error" in text


def test_what_calibration_brings_is_said_in_degrees_and_percent():
    table = pd.DataFrame(
        {"sensors": "3 sagittal", "model": ["shred", "shred, calibrated"], "rmse_deg": [4.0, 1.0], "participant": "W01"}
    )
    [said] = ch5_gait.gait.calibration_sentences(table)
    assert says(said, "3 sagittal", "shred", "4.00 to 1.00 deg", "-75 %")


@pytest.mark.slow
def test_ten_strides_of_a_new_person_halve_the_error(tmp_path):
    rmse = ch5_gait.population(Wanted(True, tmp_path)).cells.groupby(["sensors", "model"])["rmse_deg"].mean()
    assert rmse["3 sagittal", "delay ridge, calibrated"] < 0.5 * rmse["3 sagittal", "delay ridge"]
