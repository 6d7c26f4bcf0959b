from dataclasses import replace

import numpy as np
import pytest
from hidden_in_a_mass import Experiment, mass, neuron, record, with_load

from gaitdisc.discovery.case import set_up_case
from gaitdisc.discovery.held_out import (
    Proof,
    gap_size,
    holding_out_others,
    is_uninformative,
    noted,
    noting_alike,
    prove,
    run_trials,
    tabulate_runs,
)
from gaitdisc.discovery.paired_test import PairedTest
from gaitdisc.discovery.scored_model import Part, fit_model, score


@pytest.fixture(scope="module")
def runs(case, as_read, cubic):
    part = Part(cubic, {"factor": -14.0})
    true = as_read.refitted(as_read.shooting, (part,))
    return tuple(run_trials(case, one, case.held_out, as_read) for one in (as_read, true))


def test_on_held_out_trials_nothing_is_found_but_the_starts(case, as_read, runs):
    before, _ = runs
    assert before.fit.free == ()
    np.testing.assert_array_equal(before.fit.values, as_read.fit.values)
    assert before.shooting.seen.shape == before.fit.residual.shape


def test_the_truth_leaves_the_noise_and_nothing_else(case, runs):
    before, after = runs
    size = gap_size(case, Proof(before, after, PairedTest(0.02, 9, 1.0)), after)
    assert size.channels["x"][2] == pytest.approx(0.02 * case.measured.observed.std(), rel=0.1)
    assert size.after < 1.1 * size.noise_floor < 0.5 * size.before
    assert size.channels["x"][1] == pytest.approx(float(np.sqrt((after.fit.residual**2).mean())))
    assert (size.p, size.pieces) == (0.02, 9)
    assert size.before == pytest.approx(size.channels["x"][0] / after.shooting.seen.std())


def test_runs_are_drawn_at_their_own_times(case, runs):
    before, after = runs
    drawn = tabulate_runs(case, before, after)
    assert set(drawn.trial) == set(case.held_out)
    np.testing.assert_allclose(np.diff(drawn.time, axis=1), 1 / case.rhythm.rate)
    np.testing.assert_allclose(drawn.measured - drawn.augmented, after.fit.residual)
    assert drawn.phase.size == 0


def test_misfits_are_those_of_the_fit(runs):
    before, _ = runs
    assert before.fit.misfits.sum() == pytest.approx(before.fit.misfit)


def test_the_truth_is_borne_out_and_what_is_worse_is_not(case, as_read, cubic):
    def with_stiffness(factor):
        shooting = as_read.shooting
        return fit_model(shooting, case.search.base, (Part(cubic, {"factor": factor}),), as_read.fit.starts, 0)

    assert prove(case, as_read, with_stiffness(-14.0), as_read).bears_out
    worse = prove(case, as_read, with_stiffness(2.0), as_read)
    assert worse.test.fall < 0
    assert not worse.bears_out
    assert not worse.bears_out


def test_an_error_that_falls_while_the_misfit_rises_bears_nothing_out(runs):
    before, after = runs
    assert Proof(before, after, PairedTest(0.01, 9, 1.0)).bears_out
    assert not Proof(after, before, PairedTest(0.01, 9, 1.0)).bears_out


def test_the_past_of_what_comes_late_is_the_runs_own():
    case = set_up_case(mass(), record(with_load("-4*delay(x, 0.21)"), 3, Experiment(seconds=12.0)))
    shooting = case.shooting(case.segments(case.learned))
    late = next(one for one in case.search.candidates if one.pieces == ("delay(x, _d)",))
    part = Part(late, {"factor": -4.0, "d": 0.21})
    starts = shooting.segments.starts(case.guess)
    true = score(fit_model(shooting, case.search.base, (part,), starts))
    assert true.noise.size[0] < 0.03 * case.measured.observed.std()
    rough = replace(case, search=replace(case.search, guess=case.guess + 0.3))
    wide = case.shooting(case.segments(case.learned, 3.0)).with_noise(true.noise)
    run = run_trials(rough, true, case.held_out, replace(true, shooting=wide))
    assert run.fit.residual.std() < 1.3 * true.noise.size[0]


def test_the_start_of_a_long_run_is_found_by_way_of_short_ones():
    truth = neuron().with_values({"b": 1.0})
    case = set_up_case(neuron(), record(truth, 2, Experiment(seconds=40.0, noise=0.05)))
    as_read = case.as_read()
    b = next(one for one in case.search.candidates if one.label == "wrong_parameter@b")
    true = as_read.refitted(as_read.shooting, (Part(b, {"value": 1.0}),))
    longer = case.lengthen(score(true))
    assert longer.shooting.segments.length > 4 * as_read.shooting.segments.length
    run = run_trials(case, longer, case.held_out, longer)
    assert run.fit.misfits.sum() < 1.2 * run.fit.white.size


def test_trials_that_can_tell_stay_held_out(case, as_read, named):
    now, _ = named
    assert not is_uninformative(case, as_read, now)
    assert not is_uninformative(case, as_read, replace(now, gained=10.0))  # nothing speaks for it
    assert not is_uninformative(case, as_read, as_read)
    other = holding_out_others(case, as_read, now)
    assert sorted((*other.learned, *other.held_out)) == sorted((*case.learned, *case.held_out))
    assert other.held_out == case.learned[-1:]


def test_what_is_held_out_in_place_of_what_is_noted(case):
    other = replace(case, learned=case.held_out, held_out=case.learned[:1])
    note = noted(case, other).measured.findings[-1]
    blind, instead = (case.measured.trials[one.held_out[0]] for one in (case, other))
    assert f"simulated motion of trial {blind};" in note.what and f"held out trial {instead}" in note.what
    assert f"not change the simulated motion of trial {blind};" in noting_alike(case).measured.findings[-1].what
