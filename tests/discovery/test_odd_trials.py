"""A trial that was turned or shifted is named and left out; trials that differ otherwise are not."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hidden_in_a_mass import Experiment, mass, neuron, record, two_rods, with_load
from texts import says

from gaitdisc.discovery.case import set_up_case
from gaitdisc.discovery.decision import Verdict
from gaitdisc.discovery.discover import discover
from gaitdisc.discovery.folder import save_discovery
from gaitdisc.discovery.odd_trials import agreeing_trials, odd_trials, shift_channels, without_trial_apart
from gaitdisc.discovery.page import write_discovery_report
from gaitdisc.discovery.search import Search
from gaitdisc.simulation.compiled_simulation import Drive, Rows
from gaitdisc.simulation.measured import Measured
from gaitdisc.simulation.running import compile_simulation


@pytest.fixture(scope="module")
def cubic():
    return record(with_load("-14*x**3"), 3, Experiment(seconds=12.0))


def turned(measured, trial, channel=0):
    observed = np.array(measured.observed)
    observed[trial, :, channel] *= -1
    return replace(measured, observed=observed)


def moved_in_time(measured, trial, samples):
    """Return trials of one length, the channels of one of them so many samples early (late where negative)."""
    every, length = shift_channels(measured, samples), measured.observed.shape[1] - abs(samples)
    observed, inputs = np.array(measured.observed[:, :length]), np.array(measured.drive.inputs[:, :length])
    observed[trial], inputs[trial] = every.observed[trial], every.drive.inputs[trial]
    return replace(measured, drive=replace(every.drive, inputs=inputs, time0=measured.drive.time0), observed=observed)


def found_in(simulation, measured):
    return [(one.trial, one.change, one.channel) for one in odd_trials(set_up_case(simulation, measured))]


@pytest.mark.parametrize("trial", [0, 2])
def test_a_turned_sign_is_found_whichever_trial_has_it(cubic, trial):
    [(found, said, channel)] = found_in(mass(), turned(cubic, trial))
    assert (found, channel) == (trial, "x") and says(said, "sign", "x", "push")


def test_channels_that_may_each_be_turned_are_both_named():
    measured = record(two_rods(), 3, Experiment(seconds=8.0))  # a motion with both signs turned is a motion as well
    [(found, said, channel)] = found_in(two_rods(), turned(measured, 2, 1))
    assert (found, channel) == (2, "upper") and says(said, "sign", "upper", "lower")


@pytest.mark.parametrize(("samples", "said"), [(25, "early"), (-25, "late")])
def test_a_shift_is_found_with_its_seconds(cubic, samples, said):
    ((trial, change, _),) = found_in(mass(), moved_in_time(cubic, 1, samples))
    assert trial == 1 and change.endswith(f"s too {said} for its inputs")
    assert float(change.split()[3]) == pytest.approx(0.5, abs=0.05)


CLEAN = {
    "nothing hidden": (mass(), mass(), Experiment()),
    "a spring": (mass(), with_load("-14*x**3"), Experiment()),
    "a stop that engages in few": (mass(), with_load("-200*max(0, x - 1.1)"), Experiment()),
    "late inputs in all": (mass(), mass(), Experiment(late=-8)),
    "much noise": (mass(), with_load("-6*x"), Experiment(noise=0.3)),
    "shaken": (mass(), mass(), Experiment(shaking=6.0)),
    "rods left to themselves": (two_rods(), two_rods(), Experiment(seconds=8.0)),
    "a neuron": (neuron(), neuron(), Experiment(seconds=8.0)),
}


@pytest.mark.parametrize("seed", [0, pytest.param(1, marks=pytest.mark.slow)])
@pytest.mark.parametrize("name", CLEAN)
def test_trials_that_were_recorded_alike_draw_no_finding(name, seed):
    given, truth, how = CLEAN[name]
    assert found_in(given, record(truth, seed, how)) == []


def test_an_effect_that_shows_in_one_trial_alone_is_no_shift_of_it():
    """A mass that creeps through a thick fluid meets a spring in one trial."""
    thick, rng, time = {"m": 0.3, "k": 0.0, "c": 1.0}, np.random.default_rng(5), np.arange(200) / 50
    waves = [[(rng.uniform(0.015, 0.05), rng.uniform(0, 6), f) for f in rng.uniform(0.3, 2, 3)] for _ in range(4)]
    pushes = [sum(a * np.sin(2 * np.pi * f * time + b) for a, b, f in each)[:, None] for each in waves]
    drive = Drive.of(pushes, 50.0, np.zeros(4))
    rows = Rows(np.arange(4), np.zeros(4, int), np.column_stack([rng.uniform(-0.3, 0.3, 4), np.zeros(4)]))
    truth = compile_simulation(with_load("-max(0, x - 0.1)").with_values(thick))
    x = truth.run(drive, rows, 199)[0][..., :1] + 0.001 * rng.normal(size=(4, 200, 1))
    assert (x.max(axis=(1, 2)) > 0.1).sum() < 3
    assert found_in(mass().with_values(thick), Measured(drive, x, ("1", "2", "3", "4"), ("x",))) == []


@pytest.mark.slow
def test_it_is_left_out_and_said_in_the_answer_and_the_report(cubic, tmp_path):
    found, augmented = discover(mass(), turned(cubic, 1))
    assert [one.name for one in augmented.effects] == ["cubic_stiffness"]
    assert found.effects[0].estimates["stiffness"].value == pytest.approx(14, rel=0.1)
    (odd,) = [one for one in found.findings if one.kind == "odd trial"]
    assert (odd.severity, odd.channel) == ("warning", "x")
    assert says(odd.what, "'2'", "With this correction")
    assert says(found.sentence, "'2'", "push were reversed")
    assert found.sentence.endswith("This trial was left out.")
    assert found.runs.names == ("1", "3", "4")
    assert "odd trial" in save_discovery(found, tmp_path).read_text()
    assert says(write_discovery_report(found, tmp_path).read_text(), "push were reversed")


def test_of_two_trials_none_is_the_odd_one(cubic):
    two = turned(cubic.selected([0, 1]), 1)
    assert agreeing_trials(set_up_case(mass(), two), two) is two


def test_two_against_two_are_left_as_they_are(cubic):
    both = turned(turned(cubic, 0), 1)
    assert agreeing_trials(set_up_case(mass(), both), both) is both


def test_trials_are_shifted_against_their_inputs(cubic):
    for shift in (3, -3):
        moved = shift_channels(cubic, shift)
        assert moved.samples.tolist() == [597] * 4
        np.testing.assert_array_equal(moved.observed[2], cubic.observed[2, max(shift, 0) :][:597])
        np.testing.assert_array_equal(moved.drive.inputs[2], cubic.drive.inputs[2, max(-shift, 0) :][:597])


@pytest.mark.slow
def test_a_trial_that_what_was_found_explains_is_searched_after_all(cubic, monkeypatch):
    """As read, one trial seems turned, as a missing effect may make it; with the spring it does not."""
    begun = []

    def suspected(case, measured):
        begun.append(case.search.base.effects)
        return measured.selected([0, 1, 3]) if len(begun) == 1 else agreeing_trials(case, measured)

    monkeypatch.setattr("gaitdisc.discovery.discover.agreeing_trials", suspected)
    found, _ = discover(mass(), cubic)
    assert [one.name for one in found.effects] == ["cubic_stiffness"] == [begun[1][0].name] and not begun[0]
    assert len(found.runs.names) == 4 and not [one for one in found.findings if one.kind == "odd trial"]


def spoiled(measured, how):
    """The trials with one thing wrong in the second."""
    seen = measured.observed.copy()
    one = seen[1, :, 0]
    if how == "gain":
        one *= 1.5
    elif how == "offset":
        one += 2 * one.std()
    elif how == "drift":
        one += np.linspace(0, 3 * one.std(), len(one))
    elif how == "still":
        one[len(one) // 3 :] = one[len(one) // 3]
    return replace(measured, observed=seen)


@pytest.mark.parametrize(
    ("how", "named"),
    [
        ("gain", False),
        *(pytest.param(how, True, marks=pytest.mark.slow) for how in ("gain", "offset", "drift", "still")),
    ],
)
def test_a_trial_that_goes_with_no_explanation_of_the_others_is_left_out_and_the_name_is_right(how, named, monkeypatch):
    if not named:
        monkeypatch.setattr("gaitdisc.discovery.discover.decide", lambda _, as_read: Verdict(as_read, ()))
    measured = spoiled(record(with_load("-14*x**3"), 3, Experiment(seconds=6.0)), how)
    found, _ = discover(mass(), measured)
    assert [(one.name, one.place) for one in found.effects] == [("cubic_stiffness", "load")] * named
    assert found.runs.names == ("1", "3", "4")
    assert says(found.sentence, "rial '2'", "no single model fits it", "left out")
    assert "This trial was left out" in found.sentence


def test_trials_that_were_recorded_alike_are_all_kept_after_one_search_at_most(monkeypatch):
    searched = []
    search = Search.extended
    monkeypatch.setattr(Search, "extended", lambda *a, **k: searched.append(1) or search(*a, **k))
    bump = with_load("-6*exp(-((x - 0.3)/0.2)**2)")  # of which no single explanation leaves mere noise
    case = set_up_case(mass(), record(bump, 3, Experiment(seconds=10.0)))
    assert without_trial_apart(case) is case.measured
    assert len(searched) <= 1


def test_of_three_trials_none_is_said_to_stand_apart():
    case = set_up_case(mass(), record(mass(), 3, Experiment(trials=3, seconds=10.0)))
    assert without_trial_apart(case) is case.measured
