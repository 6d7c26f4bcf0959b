"""Measured trials: lengths, selections, and what is refused of their clocks."""

import numpy as np
import pytest
from texts import says

from gaitdisc.errors import ReadError, SamplingError, ShapeError
from gaitdisc.simulation.compiled_simulation import Drive
from gaitdisc.simulation.even_time import TrialColumns
from gaitdisc.simulation.measured import Measured, check_measured


def _trial(name="1", count=50, rate=100.0, time=None, observed=None):
    t = np.arange(count) / rate if time is None else np.asarray(time, float)
    x = np.sin(5 * t)[:, None] if observed is None else observed
    return TrialColumns(name, t, np.cos(t)[:, None], x)


def _measured(*trials):
    return check_measured(trials, ["u"], ["x"], "walk.csv")


def test_trials_of_different_lengths():
    measured = _measured(_trial("a"), _trial("b", 80))
    assert measured.samples.tolist() == [50, 80]
    assert measured.rate == 100.0
    assert np.isnan(measured.observed[0, 50:]).all() and np.isfinite(measured.observed[1]).all()
    assert measured.findings == ()
    np.testing.assert_allclose(measured.time(1), np.arange(80) / 100)


def test_trials_that_are_too_short_are_left_out_with_a_finding():
    whole, alone = _measured(_trial("a"), _trial("b", 80)), _measured(_trial("a", 19), _trial("b", 20))
    measured = _measured(_trial("c", 12), _trial("a"), _trial("b", 80), _trial("d", 19))
    assert measured.trials == whole.trials == ("a", "b")
    np.testing.assert_array_equal(measured.observed, whole.observed)
    (finding,) = measured.findings
    assert finding.what == "fewer than 20 samples in 2 trials: 'c' (12), 'd' (19)"
    assert [one.kind for one in alone.findings] == ["short trial", "one trial"] and alone.trials == ("b",)
    with pytest.raises(SamplingError, match=r"have 20 samples; walk\.csv, trial 'a' has 19"):
        _measured(_trial("a", 19), _trial("b", 12))


def test_some_trials():
    measured = _measured(_trial("a"), _trial("b", 80))
    assert measured.selected([0]).observed.shape == (1, 50, 1)


def test_one_trial_is_told():
    (finding,) = _measured(_trial()).findings
    assert finding.kind == "one trial" and "only a later part" in finding.spoils


def test_printed_times_are_even_enough():
    assert _measured(_trial(time=np.round(np.arange(200) / 60, 3)), _trial("b", rate=60.0)).rate == pytest.approx(
        60, rel=1e-3
    )
    assert _measured(_trial(time=np.round(7 + np.arange(500) / 100, 2)), _trial("b")).rate == 100.0


@pytest.mark.parametrize(
    ("trials", "words"),
    [
        ([_trial(count=7)], "trial '1' has 7"),
        ([_trial(time=np.arange(50) / 100 + (np.arange(50) > 30) * 0.053)], "a step of 0.063 s after t = 0.3 s"),
        ([_trial(time=np.sort(np.random.default_rng(0).uniform(0, 1, 50)))], "interval of a trial must be constant"),
        ([_trial(time=np.repeat(np.arange(25) / 100, 2))], "t = 0 s"),
        ([_trial(time=np.arange(50) % 25 / 100)], r"t = 0.24 s is followed by 0 s \(sample 26"),
        ([_trial("a"), _trial("b", rate=50.0)], "trial 'a' was sampled at 100 Hz, trial 'b' at 50 Hz"),
    ],
)  # fmt: skip
def test_clocks_that_do_not_run_are_refused(trials, words):
    with pytest.raises(SamplingError, match=words):
        _measured(*trials)


def test_a_constant_channel_is_refused_a_constant_trial_told():
    still = np.full((50, 1), 3.0)
    with pytest.raises(ShapeError, match=r"'x'.*; walk\.csv.*3"):
        _measured(_trial("a", observed=still), _trial("b", observed=still))
    (finding,) = _measured(_trial("a", observed=still), _trial("b")).findings
    assert says(finding.line(), "walk.csv", "1 of 2 trials", "'a'")


def test_shapes_are_checked():
    with pytest.raises(ShapeError, match=r"30, 2\).*30, 1\)"):
        Measured(Drive.of([np.empty((30, 0))], 100.0), np.zeros((1, 30, 2)), ("1",), ("x",))


def test_empty_cells_are_left_out_with_one_finding():
    observed = np.sin(5 * np.arange(50) / 100)[:, None]
    observed[[3, 4, 30]] = np.nan
    measured = _measured(_trial("a", observed=observed), _trial("b"))
    assert np.isnan(measured.observed[0, [3, 4, 30], 0]).all()
    (finding,) = measured.findings
    assert says(finding.line(), "walk.csv", "missing samples: 3 of 100", "'a' (3)")


def test_a_channel_that_is_as_good_as_empty_is_refused():
    observed = np.full((50, 1), np.nan)
    observed[:19, 0] = np.arange(19)
    with pytest.raises(ReadError, match=r"20 values.*walk.csv.*'a'.*'x'.*19.*50"):
        _measured(_trial("a", observed=observed), _trial("b"))


def test_trials_whose_clocks_shake_alike_have_one_finding():
    rng = np.random.default_rng(0)
    shaken = [_trial(name, time=np.arange(50) / 100 + rng.uniform(-5e-4, 5e-4, 50)) for name in "abc"]
    measured = _measured(*shaken)
    (finding,) = measured.findings
    assert measured.rate == 100.0
    assert finding.kind == "clock" and finding.what.endswith("; further trials: 2")


def test_trials_are_padded_and_their_lengths_kept():
    drive = Drive.of([np.ones((3, 2)), np.ones((5, 2))], 50.0, [0.0, 2.0])
    assert drive.inputs.shape == (2, 5, 2)
    assert drive.inputs[0, 3:].tolist() == [[0, 0], [0, 0]]
    assert drive.samples.tolist() == [3, 5]
    assert drive.time0.tolist() == [0.0, 2.0]
    assert not drive.inputs.flags.writeable


def test_what_does_not_fit_is_refused():
    with pytest.raises(ShapeError, match=r"\(1, 5, 2\).*\[7\]"):
        Drive(100.0, np.zeros(1), np.zeros((1, 5, 2)), np.array([7]))
    with pytest.raises(ShapeError, match="rate 0"):
        Drive(0, np.zeros(1), np.zeros((1, 5, 2)), np.array([5]))
