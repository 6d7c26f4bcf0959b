"""Conventions of scientific Python: logging, built-in errors, units of tables, scikit-learn's checks."""

import logging

import pytest

import gaitdisc as gd
from gaitdisc.response.fit_response import _log_tenths

# Messages of checks whose data cannot be a series in time, each with the reason.
NOT_A_SERIES = {
    "states must be an array (time, column)": "y of one dimension: a state is a column, as a sensor is",
    "a recording must be longer than a window": "fewer samples than one window of history",
}
OTHERS = {  # checks that fail for another reason
    "check_estimators_nan_inf": "NaN is a missing reading, which a window may contain",
    "check_positive_only_tag_during_fit": "its data are one-dimensional states as well",
    "check_complex_data": "refused as any array, in this package's words",
    **{f"check_estimator_sparse_{part}": "refused as any array" for part in ("tag", "array", "matrix")},
}


@pytest.mark.parametrize("name", ["nowhere.mot", "nowhere.c3d", "nowhere.csv", "nowhere"])
def test_a_missing_file_or_folder_is_a_file_not_found_error_with_its_code(name):
    read, code = (gd.read, "gd-read") if "." in name else (gd.load, "gd-schema")
    with pytest.raises(FileNotFoundError, match=name) as refusal:
        read(name)
    assert isinstance(refusal.value, gd.GaitdiscError) and refusal.value.code == code
    assert "C3D" not in refusal.value.found  # what is needed, and not what there is


def test_a_table_carries_its_units():
    table = gd.example_walks(10.0)["nominal"].stream("kinematics").to_pandas(units=True)
    knee, rate = "knee_angle_r [deg]", gd.differentiate(table, 2)
    assert table.attrs["units"][knee] == "deg" and table.attrs["units"]["time"] == rate.attrs["units"]["time"] == "s"
    assert rate.attrs["units"]["knee_angle_r [deg/s2]"] == "deg/s2" and set(rate) < set(rate.attrs["units"])
    assert gd.differentiate(table[knee]).name == "knee_angle_r [deg/s]"


def test_progress_goes_to_the_logger_at_each_tenth(caplog):
    with caplog.at_level(logging.INFO, "gaitdisc"):
        _ = [*map(_log_tenths(), (0.0, 0.05, 0.11, 1.0))]
    assert [record.args for record in caplog.records] == [(0,), (10,), (100,)]


@pytest.mark.filterwarnings("ignore::UserWarning")
def test_scikit_learn_finds_nothing_but_what_a_series_in_time_cannot_be():
    from sklearn.utils.estimator_checks import check_estimator

    results = check_estimator(gd.Reconstructor(), on_fail=None, on_skip=None)
    failed = [one for one in results if one["status"] == "failed"]
    other = [one["check_name"] for one in failed if not any(part in str(one["exception"]) for part in NOT_A_SERIES)]
    assert set(other) == set(OTHERS)
