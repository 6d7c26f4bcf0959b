import numpy as np
import pandas as pd
import pytest

from gaitdisc.channel import Channel
from gaitdisc.errors import SchemaError, ShapeError
from gaitdisc.results.mismatch import CHANNEL_COLUMNS, CURVES, REGION_COLUMNS, Exchange, Mismatch, Smallest
from gaitdisc.results.provenance import Provenance

MADE = Provenance({}, 0, {}, {}, "", "2026-01-01T00:00:00+00:00")


def mismatch(**changes):
    names = ("ankle_angle_r", "knee_angle_r")
    curves = {name: np.zeros((101, 2)) for name in CURVES}
    summary = pd.DataFrame(
        [
            (name, "deg", True, 1.0, 50.0, 1.0, rms, 1.0, 0.01, 2.0, 1.0, 0.0, 1.0, 2.0, 0.0, 1.0, False)
            for name, rms in zip(names, (1.0, 3.0), strict=True)
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


def test_curves_are_read_only_and_the_largest_against_its_spread_comes_first():
    found = mismatch()
    assert not found.curves["gap"].flags.writeable
    assert found.ordered() == ["knee_angle_r", "ankle_angle_r"]
    assert found.rmse == {"ankle_angle_r": 1.0, "knee_angle_r": 3.0}
    assert list(found.curve_table("knee_angle_r")["percent"]) == list(range(101))


def test_the_smallest_difference_that_is_named():
    usual = Smallest()
    assert [usual.of(unit, 40.0) for unit in ("deg", "N m/kg", "N", "V")] == [2.0, 0.1, 2.0, 2.0]
    assert Smallest(3.0, 0.2, 0.1, body_weight_n=700.0).of("N", 40.0) == pytest.approx(70.0)


def test_wrong_shapes_and_columns_are_refused_in_words():
    with pytest.raises(ShapeError, match=r"needs 'first' of shape \(101, 2\); found \(50, 2\)"):
        mismatch(curves={name: np.zeros((50, 2)) for name in CURVES})
    with pytest.raises(SchemaError, match="regions lacks p"):
        mismatch(regions=pd.DataFrame(columns=pd.Index(REGION_COLUMNS[:-1])))
