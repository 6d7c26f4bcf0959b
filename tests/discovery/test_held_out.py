from dataclasses import replace

import numpy as np
import pytest
from hidden_in_a_mass import Experiment, mass, neuron, record, with_load

from gaitdisc.discovery.candidate_model import Part, fit_model
from gaitdisc.discovery.first_states import StateGuess
from gaitdisc.discovery.held_out import (
    Proof,
    drawn_runs,
    gap_size,
    holding_out_others,
    is_uninformative,
    noted,
    proof_of,
    runs_of,
)
from gaitdisc.discovery.paired_test import PairedTest
from gaitdisc.discovery.problem import set_up_problem
from gaitdisc.discovery.scored_model import ScoredModel, scored


@pytest.fixture(scope="module")
def runs(problem, as_read, cubic):
    part = Part(cubic, {"factor": -14.0})
    true = fit_model(as_read.shooting, problem.search.base, (part,), as_read.model.fit.starts)
    true = ScoredModel(true, as_read.shooting)
    return tuple(runs_of(problem, one, problem.held_out, as_read) for one in (as_read, true))


def test_on_held_out_trials_nothing_is_found_but_the_starts(problem, as_read, runs):
    before, _ = runs
    assert before.fit.free == ()
    np.testing.assert_array_equal(before.fit.values, as_read.model.fit.values)
    assert before.measured.shape == before.fit.residual.shape


def test_the_truth_leaves_the_noise_and_nothing_else(problem, runs):
    before, after = runs
    floor = np.array([0.02 * problem.measured.observed.std()])
    size = gap_size(before, after, floor, ("x",), PairedTest(0.02, 9, 1.0))
    assert size.after < 1.1 * size.noise_floor < 0.5 * size.before
    assert size.channels["x"][1] == pytest.approx(float(np.sqrt((after.fit.residual**2).mean())))
    assert (size.p, size.pieces) == (0.02, 9)
    assert size.before == pytest.approx(size.channels["x"][0] / after.measured.std())


def test_runs_are_drawn_at_their_own_times(problem, runs):
    before, after = runs
    drawn = drawn_runs(problem, before, after)
    assert set(drawn.trial) == set(problem.held_out)
    np.testing.assert_allclose(np.diff(drawn.time, axis=1), 1 / problem.rhythm.rate)
    np.testing.assert_allclose(drawn.measured - drawn.augmented, after.fit.residual)
    assert drawn.phase.size == 0


def test_misfits_are_those_of_the_fit(runs):
    before, _ = runs
    assert replace(before).misfits.sum() == pytest.approx(before.fit.misfit)


def test_the_truth_is_borne_out_and_what_is_worse_is_not(problem, as_read, cubic):
    def with_stiffness(factor):
        shooting = as_read.shooting
        model = fit_model(
            shooting, problem.search.base, (Part(cubic, {"factor": factor}),), as_read.model.fit.starts, 0
        )
        return ScoredModel(model, shooting)

    assert proof_of(problem, as_read, with_stiffness(-14.0), as_read).bears_out
    worse = proof_of(problem, as_read, with_stiffness(2.0), as_read)
    assert worse.test.fall < 0
    assert not worse.bears_out
    assert not worse.bears_out


def test_an_error_that_falls_while_the_misfit_rises_bears_nothing_out(runs):
    before, after = runs
    assert Proof(before, after, PairedTest(0.01, 9, 1.0)).bears_out
    assert not Proof(after, before, PairedTest(0.01, 9, 1.0)).bears_out


def test_the_past_of_what_comes_late_is_the_runs_own():
    problem = set_up_problem(mass(), record(with_load("-4*delay(x, 0.21)"), 3, Experiment(seconds=12.0)))
    shooting = problem.shooting(problem.segments(problem.learned))
    late = next(one for one in problem.search.candidates if one.pieces == ("delay(x, _d)",))
    part = Part(late, {"factor": -4.0, "d": 0.21})
    starts = problem.guess.starts(shooting.segments)
    true = scored(shooting, problem.search.base, fit_model(shooting, problem.search.base, (part,), starts))
    assert true.noise.size[0] < 0.03 * problem.measured.observed.std()
    rough = replace(problem, guess=StateGuess(problem.guess.states + 0.3))
    wide = problem.shooting(problem.segments(problem.learned, 3.0)).with_noise(true.noise)
    run = runs_of(rough, true, problem.held_out, replace(true, shooting=wide))
    assert run.fit.residual.std() < 1.3 * true.noise.size[0]


def test_the_start_of_a_long_run_is_found_by_way_of_short_ones():
    truth = neuron().with_values({"b": 1.0})
    problem = set_up_problem(neuron(), record(truth, 2, Experiment(seconds=40.0, noise=0.05)))
    as_read = problem.as_read()
    b = next(one for one in problem.search.candidates if one.label == "wrong_parameter@b")
    true = fit_model(as_read.shooting, problem.search.base, (Part(b, {"value": 1.0}),), as_read.model.fit.starts)
    longer = problem.lengthened(scored(as_read.shooting, problem.search.base, true))
    assert longer.shooting.segments.length > 4 * as_read.shooting.segments.length
    run = runs_of(problem, longer, problem.held_out, longer)
    assert run.misfits.sum() < 1.2 * run.fit.white.size


def test_trials_that_can_tell_stay_held_out(problem, as_read, named):
    now, _ = named
    assert not is_uninformative(problem, as_read, now)
    other = holding_out_others(problem, as_read, now)
    assert sorted((*other.learned, *other.held_out)) == sorted((*problem.learned, *problem.held_out))
    assert other.held_out == problem.learned[-1:]


def test_nothing_is_asked_where_nothing_speaks_for_it(problem, as_read, named):
    now, _ = named
    assert not is_uninformative(problem, as_read, replace(now, gained=10.0))
    assert not is_uninformative(problem, as_read, as_read)


def test_what_is_held_out_in_place_of_what_is_noted(problem):
    other = replace(problem, learned=problem.held_out, held_out=problem.learned[:1])
    note = noted(problem, other).measured.findings[-1]
    blind, instead = (problem.measured.trials[one.held_out[0]] for one in (problem, other))
    assert f"trial {blind} runs alike; trial {instead} is held out" in note.what
