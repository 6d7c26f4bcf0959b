import numpy as np
import pytest

from gaitdisc.reconstruction.reconstruct import Fits, cross_errors, cross_widths, group_people, reconstruct
from gaitdisc.reconstruction.state_errors import coverage, half_widths
from gaitdisc.reconstruction.window_model import Sensing, fit_reconstructor, sensing
from gaitdisc.reconstruction.windows import Lags, split_by_subject, split_within
from gaitdisc.recording import Samples

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


WHAT = Sensing(("a",), ("b",), Lags(1, 1), 100.0)


def people(count, seed):
    """b is 3 a, plus an offset that differs from person to person, plus noise."""
    rng = np.random.default_rng(seed)
    found = []
    for k in range(count):
        a = rng.normal(size=(120, 1))
        y = 3 * a + rng.normal(0.0, 2.0) + 0.3 * rng.normal(size=a.shape)
        time = np.arange(120) / 100
        found.append([Samples(a, y, ("a",), ("b",), time, time, f"P{k}")])
    return found


def test_everybody_but_the_test_person_is_reconstructed_by_models_of_others():
    everybody = people(6, 0)
    errors = cross_errors("linear", WHAT, split_by_subject(everybody, 0))
    assert errors.shape == (5 * 120, 1)
    assert set(group_people([trial for trials in everybody for trial in trials])) == {f"P{k}" for k in range(6)}
    moved = [[s.with_outputs(s.y + 100.0 * (k == 0)) for s in trials] for k, trials in enumerate(everybody)]
    np.testing.assert_array_equal(cross_errors("linear", WHAT, split_by_subject(moved, 0)), errors)


def test_one_checked_person_covers_too_little_and_crossing_does_not():
    plain, crossed, by_another = [], [], []
    for seed in range(25):
        parts = split_by_subject(people(9, seed), 0)
        done = fit_reconstructor("linear", WHAT, parts.fitted(), parts.checked())
        missed, errors = (done(part) - part.y for part in (parts.checked(), parts.tested()))
        plain.append(coverage(errors, half_widths(missed))[0])
        crossed.append(coverage(errors, cross_widths("linear", WHAT, parts, missed))[0])
        scaled = cross_widths("another kind", WHAT, parts, missed)
        by_another.append(coverage(errors, scaled)[0])
    assert np.mean(plain) < 0.75
    assert np.mean(crossed) == pytest.approx(0.9, abs=0.07)
    np.testing.assert_allclose(by_another, crossed)  # the standard is the same model here


def test_with_three_people_there_is_nothing_to_cross():
    parts = split_by_subject(people(3, 0), 0)
    missed = np.arange(-9.0, 10.0)[:, None]
    np.testing.assert_array_equal(cross_widths("linear", WHAT, parts, missed), half_widths(missed))
