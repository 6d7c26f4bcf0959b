import numpy as np
import pytest

from gaitdisc.sensing.reconstruct import best_of, reconstruct

KINDS = ("linear", "delay ridge")


def test_every_kind_is_judged_on_what_it_never_saw(pair):
    done = reconstruct("P01", pair.parts, pair.what, pair.channels, KINDS)
    assert done.summary["model"].tolist() == list(KINDS)
    rmse = done.summary.set_index("model")["rmse_deg"]
    assert rmse["delay ridge"] < 0.01
    assert rmse["linear"] > 0.5
    assert (done.summary["strides"] == done.summary["strides"].iloc[0]).all()
    assert done.errors["low"].le(done.errors["rmse"]).all()
    assert best_of(done).reconstructor.kind == "delay ridge"
    assert set(done.curves["model"]) == set(KINDS)


def test_the_interval_of_the_checked_windows_is_told_with_its_coverage(pair):
    done = reconstruct("P01", pair.parts, pair.what, pair.channels, ("linear",))
    assert done.summary["coverage"].iloc[0] == pytest.approx(0.9, abs=0.08)


def test_calibration_takes_an_offset_away_and_is_not_judged_on_its_own_strides(pair):
    parts = pair.parts
    moved = type(parts)(parts.training, parts.check, tuple(s.with_outputs(s.y + 5.0) for s in parts.test), parts.rule)
    done = reconstruct("P01", moved, pair.what, pair.channels, ("delay ridge",), calibration=2)
    rmse = done.summary.set_index("model")["rmse_deg"]
    assert rmse["delay ridge"] == pytest.approx(5.0, abs=0.01)
    assert rmse["delay ridge, calibrated"] < 0.01
    whole = len(np.unique(np.floor(parts.judged().time)))
    assert done.summary["strides"].tolist() == [whole - 2, whole - 2]
