import numpy as np
import pandas as pd
import pytest

from gaitdisc.channel import Channel
from gaitdisc.comparison.mismatch import CHANNEL_COLUMNS, CURVES, REGION_COLUMNS, Exchange, Mismatch, Smallest
from gaitdisc.errors import SchemaError, ShapeError
from gaitdisc.saved.provenance import Provenance

MADE = Provenance({}, 0, {}, {}, "", "2026-01-01T00:00:00+00:00")


def mismatch(**changes):
    names = ("ankle_angle_r", "knee_angle_r")
    curves = {name: np.zeros((101, 2)) for name in CURVES}
    summary = pd.DataFrame(
        [
            (name, "deg", True, largest, 50.0, 1.0, 3.0, sd, 0.01, 2.0, 1.0, 0.0, 1.0, 2.0, 0.0, 1.0, False)
            for name, largest, sd in zip(names, (6.0, -27.0), (0.1, 5.0), strict=True)
        ],
        columns=pd.Index(CHANNEL_COLUMNS),
    )
    fields = {
        "first": "sim",
        "second": "measured",
        "channels": tuple(Channel(name, "angle", "deg", "r") for name in names),
        "curves": curves,
        "regions": pd.DataFrame(columns=pd.Index(REGION_COLUMNS)),
        "summary": summary,
        "exchange": Exchange("stride", 20, 30, 20, 30, 2000, False, 4.0, 0.05),
        "findings": (),
        "provenance": MADE,
    }
    return Mismatch(**{**fields, **changes})


def test_curves_are_read_only_and_the_largest_gap_against_the_smallest_named_comes_first():
    """Six degrees that hardly vary were ranked above 27 that vary."""
    found = mismatch()
    assert not found.curves["gap"].flags.writeable
    assert found.ordered() == ["knee_angle_r", "ankle_angle_r"]
    assert found.rmse == {"ankle_angle_r": 3.0, "knee_angle_r": 3.0}
    assert list(found.curve_table("knee_angle_r")["percent"]) == list(range(101))


def test_where_everything_is_named_the_usual_limits_rank():
    summary = mismatch().summary.assign(limit=0.0, unit=["N", "deg"])
    curves = {name: np.zeros((101, 2)) for name in CURVES}
    curves["second"][:, 0] = 3.0 * np.arange(101)  # 6 N are less than a 20th of 300 N
    assert mismatch(summary=summary, curves=curves).ordered() == ["knee_angle_r", "ankle_angle_r"]


def test_a_folder_that_was_saved_as_first_minus_second_is_turned():
    curves = {name: np.zeros((101, 2)) for name in CURVES}
    curves |= {"first": np.full((101, 2), 4.0), "gap": np.full((101, 2), 4.0), "low": np.full((101, 2), 3.0)}
    curves |= {"high": np.full((101, 2), 6.0), "t": np.full((101, 2), 2.0)}
    rows = [("knee_angle_r", "deg", 0.0, 9.0, 4.0, 1.0, 2.0, 4.0, 0.01)]
    found = mismatch(curves=curves, regions=pd.DataFrame(rows, columns=pd.Index(REGION_COLUMNS)))
    assert {name: values[0, 0] for name, values in found.curves.items() if values.any()} == {
        "first": 4.0, "gap": -4.0, "low": -6.0, "high": -3.0, "t": -2.0,
    }  # fmt: skip
    assert found.regions_of("knee_angle_r")[0]["gap"] == -4.0
    assert found.summary_of("knee_angle_r")["largest_gap"] == 27.0
    again = mismatch(curves=found.curves, regions=found.regions, summary=found.summary)
    assert again.regions_of("knee_angle_r")[0]["gap"] == -4.0


def test_the_smallest_difference_that_is_named():
    usual = Smallest()
    assert [usual.of(unit, 40.0) for unit in ("deg", "N m/kg", "N", "V")] == [2.0, 0.1, 2.0, 2.0]
    assert Smallest(3.0, 0.2, 0.1, body_weight_n=700.0).of("N", 40.0) == pytest.approx(70.0)


def test_wrong_shapes_and_columns_are_refused_in_words():
    with pytest.raises(ShapeError, match=r"'first'.*\(101, 2\).*\(50, 2\)"):
        mismatch(curves={name: np.zeros((50, 2)) for name in CURVES})
    with pytest.raises(SchemaError, match="regions lacks p"):
        mismatch(regions=pd.DataFrame(columns=pd.Index(REGION_COLUMNS[:-1])))
