import numpy as np
import pytest

from gaitdisc.sensing.reconstruct import Fits, reconstruct
from gaitdisc.sensing.reconstructor import sensing
from gaitdisc.sensing.splits import split_within
from gaitdisc.sensing.windows import Lags

KINDS = ("linear", "delay ridge")


def test_every_kind_is_tested_on_what_it_never_saw(pair):
    done = reconstruct("P01", pair.parts, pair.what, pair.channels, Fits(KINDS))
    assert done.summary["model"].tolist() == list(KINDS)
    rmse = done.summary.set_index("model")["rmse_deg"]
    assert rmse["delay ridge"] < 0.01
    assert rmse["linear"] > 0.5
    assert (done.summary["strides"] == done.summary["strides"].iloc[0]).all()
    assert done.errors["low"].le(done.errors["rmse"]).all()
    assert done.model("delay ridge").reconstructor.kind == "delay ridge"
    assert set(done.curves["model"]) == set(KINDS)


def test_the_interval_of_the_checked_windows_is_given_with_its_coverage(pair):
    done = reconstruct("P01", pair.parts, pair.what, pair.channels, Fits(("linear",)))
    assert done.summary["coverage"].iloc[0] == pytest.approx(0.9, abs=0.08)


def test_calibration_takes_an_offset_away_and_is_not_tested_on_its_own_strides(pair):
    parts = pair.parts
    moved = type(parts)(parts.training, parts.check, tuple(s.with_outputs(s.y + 5.0) for s in parts.test), parts.rule)
    done = reconstruct("P01", moved, pair.what, pair.channels, Fits(("delay ridge",), calibration=2))
    rmse = done.summary.set_index("model")["rmse_deg"]
    assert rmse["delay ridge"] == pytest.approx(5.0, abs=0.01)
    assert rmse["delay ridge, calibrated"] < 0.01
    whole = len(np.unique(np.floor(parts.tested().time)))
    assert done.summary["strides"].tolist() == [whole - 2, whole - 2]


def test_a_forecast_stands_beside_persistence_and_the_mean_stride(pair):
    what = sensing(("a", "late"), ("a",), Lags(11, 5, 10), 100.0)
    windows = what.windows(pair.recording, 100 * (pair.recording.time % 1.0))
    parts = split_within([windows], "temporal", what.reach_s)
    a, late = pair.channels
    done = reconstruct("P01", parts, what, (a, a, late), Fits(("delay ridge",)))
    assert done.summary["model"].tolist() == ["delay ridge", "persistence", "phase average"]
    rmse = done.errors.set_index(["model", "state"])["rmse"]
    assert rmse["delay ridge", "late"] < 0.05  # 0.15 s ago it was read
    assert rmse["delay ridge", "a"] > 0.5  # noise has no future
    assert rmse["persistence", "late"] > 0.5 and rmse["phase average", "late"] > 0.5
    assert len(done.fitted) == 1
    assert done.summary["relative_l2_whole"].tolist() == done.summary["relative_l2"].tolist()
