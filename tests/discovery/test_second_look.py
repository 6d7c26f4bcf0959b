"""What unseen data change in a verdict; the mass on a spring lacks what is said."""

from dataclasses import replace

import numpy as np
import pytest
from hidden_in_a_mass import Experiment, mass, record, with_load

from gaitdisc.discovery.case import set_up_case
from gaitdisc.discovery.decision import Verdict, prove_held_out
from gaitdisc.discovery.discover import discover
from gaitdisc.discovery.held_out import free_run_error, grows_along_runs
from gaitdisc.discovery.scored_model import Part, score
from gaitdisc.discovery.second_look import look_at_whole_runs, prefer_relatives, without_small
from gaitdisc.simulation.compiled_simulation import Drive
from gaitdisc.simulation.measured import Measured
from gaitdisc.simulation.simulation_file import parse_simulation


def _problem(truth, how=None):
    case = set_up_case(mass(), record(truth, 3, how or Experiment(seconds=12.0)))
    return case, case.as_read()


def _with(case, as_read, label, **values):
    """Return the simulation with one explanation in it, fitted from its numbers."""
    candidate = next(one for one in case.search.candidates if one.label == label)
    return score(as_read.refitted(as_read.shooting, (Part(candidate, values),)))


def test_hysteresis_that_yields_within_a_step_is_dry_friction():
    case, as_read = _problem(with_load("-1.5*sign(v)"))
    candidate = next(one for one in case.search.candidates if one.label == "hysteresis@load")
    values = dict.fromkeys(candidate.slots, 0.003) | {"factor": -500.0}
    general = _with(case, as_read, "hysteresis@load", **values)
    verdict = Verdict(general, (), proof=prove_held_out(case, as_read, general))
    assert prefer_relatives(case, as_read, verdict).found.labels == ("coulomb_friction@load",)


def test_free_runs_of_what_is_right_leave_the_noise_and_refuse_what_is_wrong():
    case, as_read = _problem(with_load("-14*x**3"))
    right = _with(case, as_read, "cubic_stiffness@load", factor=-14.0)
    wrong = replace(right, fit=replace(right.fit, values=-8 * right.fit.values))
    assert free_run_error(case, right) < 0.01 * free_run_error(case, as_read)
    verdict = Verdict(wrong, (right,), proof=prove_held_out(case, as_read, right))
    assert look_at_whole_runs(case, as_read, verdict)[1].found is right
    _, nothing = look_at_whole_runs(case, as_read, replace(verdict, rivals=()))
    assert nothing.word == "no_gap" and not nothing.found.parts


@pytest.mark.parametrize(("truth", "cutoff_hz", "grows"), [("0", 6.0, False), ("-14*x**3", 0.0, True)])
def test_what_is_missing_grows_along_a_run_and_a_sensors_noise_does_not(truth, cutoff_hz, grows):
    assert grows_along_runs(*_problem(with_load(truth), Experiment(seconds=12.0, cutoff_hz=cutoff_hz))) == grows


@pytest.mark.parametrize(("truth", "shaking", "named"), [("-14*x**3", 0.0, True), ("0", 8.0, False)])
def test_what_closes_next_to_nothing_of_the_gap_is_not_named(truth, shaking, named, monkeypatch):
    case, as_read = _problem(with_load(truth), Experiment(seconds=12.0, shaking=shaking))
    found = _with(case, as_read, "cubic_stiffness@load", factor=-1.0)
    verdict = Verdict(found, (), proof=prove_held_out(case, as_read, found))
    assert (without_small(case, as_read, verdict) is verdict) == named
    if named:  # it leaves mere noise; unseen data that err more refuse it all the same
        proof = replace(verdict.proof, before=verdict.proof.after, after=verdict.proof.before)
        assert without_small(case, as_read, replace(verdict, proof=proof)).rivals == (found,)
    else:
        assert without_small(case, as_read, verdict).rivals == (found,)
        monkeypatch.setattr("gaitdisc.discovery.second_look.is_uninformative", lambda *_: True)
        assert without_small(case, as_read, verdict) is verdict  # these data say nothing


def test_a_walk_of_which_a_simulation_describes_nothing_is_no_agreement():
    still = parse_simulation('[states.a]\nunit = "m"\n[equations]\na = "0"\n[observations]\nx = "a"', "still.toml")
    seen = np.random.default_rng(4).normal(size=(3, 30, 1)).cumsum(axis=1)
    measured = Measured(Drive.of([np.zeros((30, 0))] * 3, 1.0), seen, ("1", "2", "3"), ("x",))
    found, _ = discover(still, measured)
    assert found.verdict in ("unexplained", "process_noise")
