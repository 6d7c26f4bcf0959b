import pandas as pd

from gaitdisc.chapters.pages.sensor_sets_figure import sensor_sets_figure


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
