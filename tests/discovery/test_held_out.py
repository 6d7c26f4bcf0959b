from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from hidden_in_a_mass import Experiment, neuron, record
from hypothesis import given, settings
from hypothesis import strategies as st

from gaitdisc.discovery.account import Part, account_for
from gaitdisc.discovery.evidence import Judged, judged
from gaitdisc.discovery.held_out import chance, drawn_runs, gap_size, holding_out_others, noted, runs_of, tells_nothing
from gaitdisc.discovery.inquiry import begin_inquiry


@settings(max_examples=30, deadline=None)
@given(st.lists(st.integers(-9, 9), min_size=1, max_size=8))
def test_the_chance_is_the_share_of_signs_that_do_as_well(gains):
    as_well = [
        sum(s * g for s, g in zip(signs, gains, strict=True)) >= sum(gains)
        for signs in product((1, -1), repeat=len(gains))
    ]
    assert chance(np.array(gains, float)) == pytest.approx(np.mean(as_well))


def test_many_runs_are_flipped_at_random_and_never_have_no_chance():
    assert chance(np.ones(40)) == pytest.approx(1 / 10000)
    balanced = np.tile([1.0, -1.0], 20)
    assert chance(balanced) == pytest.approx(0.55, abs=0.1)


def test_a_run_that_failed_leaves_no_chance_to_say():
    assert np.isnan(chance(np.array([1.0, np.inf])))


@pytest.fixture(scope="module")
def runs(inquiry, as_read, cubic):
    part = Part(cubic, {"factor": -14.0})
    true = account_for(as_read.shooting, inquiry.search.base, (part,), as_read.account.fit.starts)
    true = Judged(true, as_read.shooting)
    return tuple(runs_of(inquiry, one, inquiry.held_out, as_read) for one in (as_read, true))


def test_on_held_out_trials_nothing_is_found_but_the_starts(inquiry, as_read, runs):
    before, _ = runs
    assert before.fit.free == ()
    np.testing.assert_array_equal(before.fit.values, as_read.account.fit.values)
    assert before.measured.shape == before.fit.residual.shape


def test_the_truth_leaves_the_noise_and_nothing_else(inquiry, runs):
    before, after = runs
    floor = np.array([0.02 * inquiry.measured.observed.std()])
    size = gap_size(before, after, floor, ("x",), 50)
    assert size.after < 1.1 * size.noise_floor < 0.5 * size.before
    assert size.channels["x"][1] == pytest.approx(float(np.sqrt((after.fit.residual**2).mean())))
    assert size.p == chance(((before.fit.residual**2 - after.fit.residual**2) / floor**2).sum(axis=(1, 2)))
    assert size.before == pytest.approx(size.channels["x"][0] / after.measured.std())


def test_runs_are_drawn_at_their_own_times(inquiry, runs):
    before, after = runs
    drawn = drawn_runs(inquiry, before, after, inquiry.held_out)
    assert set(drawn.trial) == set(inquiry.held_out)
    np.testing.assert_allclose(np.diff(drawn.time, axis=1), 1 / inquiry.rhythm.rate)
    np.testing.assert_allclose(drawn.measured - drawn.augmented, after.fit.residual)
    assert drawn.phase.size == 0


def test_misfits_are_those_of_the_fit(runs):
    before, _ = runs
    assert replace(before).misfits.sum() == pytest.approx(before.fit.misfit)


def test_a_long_run_counts_as_many_blocks(runs):
    before, after = runs
    whole, in_two = (gap_size(before, after, np.array([0.01]), ("x",), before.measured.shape[1] // n) for n in (1, 2))
    assert in_two.p < whole.p


def test_the_start_of_a_long_run_is_found_by_way_of_short_ones():
    truth = neuron().with_values({"b": 1.0})
    inquiry = begin_inquiry(neuron(), record(truth, 2, Experiment(seconds=40.0, noise=0.05)))
    as_read = inquiry.as_read()
    b = next(one for one in inquiry.search.candidates if one.label == "wrong_parameter@b")
    true = account_for(as_read.shooting, inquiry.search.base, (Part(b, {"value": 1.0}),), as_read.account.fit.starts)
    longer = inquiry.lengthened(judged(as_read.shooting, inquiry.search.base, true))
    assert longer.shooting.segments.length > 4 * as_read.shooting.segments.length
    run = runs_of(inquiry, longer, inquiry.held_out, longer)
    assert run.misfits.sum() < 1.2 * run.fit.white.size


def test_trials_that_can_tell_stay_held_out(inquiry, as_read, named):
    now, _ = named
    assert not tells_nothing(inquiry, as_read, now)
    other = holding_out_others(inquiry, as_read, now)
    assert sorted((*other.learned, *other.held_out)) == sorted((*inquiry.learned, *inquiry.held_out))
    assert other.held_out == inquiry.learned[-1:]


def test_nothing_is_asked_where_nothing_speaks_for_it(inquiry, as_read, named):
    now, _ = named
    assert not tells_nothing(inquiry, as_read, replace(now, gained=10.0))
    assert not tells_nothing(inquiry, as_read, as_read)


def test_what_is_held_out_in_place_of_what_is_noted(inquiry):
    other = replace(inquiry, learned=inquiry.held_out, held_out=inquiry.learned[:1])
    note = noted(inquiry, other).measured.findings[-1]
    blind, instead = (inquiry.measured.trials[one.held_out[0]] for one in (inquiry, other))
    assert f"trial {blind} runs alike; trial {instead} is held out" in note.what
