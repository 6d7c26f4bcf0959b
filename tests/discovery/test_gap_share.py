from dataclasses import replace

import numpy as np
import pytest

from gaitdisc.discovery.criteria import CRITERIA
from gaitdisc.discovery.fitted import Fitted, Prior
from gaitdisc.discovery.gap_share import FOLDS, GapScale, cross_validated, errors_left_out
from gaitdisc.discovery.scored_model import Part


@pytest.fixture(scope="module")
def scale(case):
    return case.scale


def test_the_scale_is_noise_and_a_hundredth_of_the_spread():
    scale = GapScale(np.array([0.03, 0.0]), np.array([4.0, 1.0]))
    assert scale.size == pytest.approx([0.05, CRITERIA.model_error])
    assert scale.floor == pytest.approx((0.36 + 0.0) / 2)
    assert scale.least == pytest.approx((0.64 + 1.0) / 2)


def test_the_true_explanation_closes_the_gap_and_a_wrong_one_does_not(as_read, cubic, labelled, scale):
    before = cross_validated(scale, as_read, ())
    begun = replace(before, shooting=as_read.shooting)
    after = cross_validated(scale, begun, (Part(cubic, {"factor": -10.0}),))
    assert after.parts[0].values["factor"] == pytest.approx(-14.0, rel=0.05)
    assert after.gap < 0.15 * before.gap
    wrong = cross_validated(scale, begun, (Part(labelled["constant_load@load"], {"factor": 0.0}),))
    assert wrong.gap > 0.8 * before.gap


def test_what_was_not_fitted_leaves_the_sensors_noise(as_read, cubic, scale):
    found = cross_validated(scale, as_read, (Part(cubic, {"factor": -14.0}),))
    assert found.errors.mean() == pytest.approx(scale.floor, rel=0.15)
    assert found.explanations == {("cubic_stiffness@load", ("x**3",))}
    assert found.penalty == pytest.approx(0.03)


RUNS, ROWS, STATES, FREE = 7, 40, 2, 3


def linear_fit(runs=RUNS, seed=0, prior=None):
    """A least-squares fit of runs with start states of their own and constants in common, at its minimum."""
    rng = np.random.default_rng(seed)
    slopes = rng.normal(size=(runs, ROWS, STATES + FREE))
    white = rng.normal(size=(runs, ROWS))
    free = tuple(f"c{number}" for number in range(FREE))
    return Fitted(
        free, np.zeros(FREE), np.zeros((runs, STATES)), np.zeros((runs, ROWS, STATES)), white[..., None], white, slopes,
        prior or Prior(),
    )  # fmt: skip


def stacked(fit, runs):
    """Design and right side of chosen runs: start states of each, then the constants."""
    design = np.zeros((len(runs) * ROWS, len(runs) * STATES + FREE))
    for place, run in enumerate(runs):
        rows = slice(place * ROWS, (place + 1) * ROWS)
        design[rows, place * STATES : (place + 1) * STATES] = fit.slopes[run, :, :STATES]
        design[rows, -FREE:] = fit.slopes[run, :, STATES:]
    return design, fit.white[list(runs)].ravel()


def test_runs_are_left_out_and_their_own_starts_found():
    fit = linear_fit()
    fold = np.arange(RUNS) * FOLDS // RUNS
    wanted = []
    for run in range(RUNS):
        others = [one for one in range(RUNS) if fold[one] != fold[run]]
        constants = np.linalg.lstsq(*stacked(fit, others), rcond=None)[0][-FREE:]
        left = fit.white[run] - fit.slopes[run, :, STATES:] @ constants
        start = np.linalg.lstsq(fit.slopes[run, :, :STATES], left, rcond=None)[0]
        wanted.append(np.mean((left - fit.slopes[run, :, :STATES] @ start) ** 2))
    pieces = errors_left_out(fit)
    assert pieces.reshape(RUNS, -1).mean(axis=1) == pytest.approx(wanted)


def test_of_one_run_pieces_are_left_out():
    fit = linear_fit(runs=1)
    design, right = stacked(fit, [0])
    pieces = np.array_split(np.arange(ROWS), len(errors_left_out(fit)) + 1)[1:]
    wanted = []
    for piece in pieces:
        kept = np.setdiff1d(np.arange(ROWS), piece)
        found = np.linalg.lstsq(design[kept], right[kept], rcond=None)[0]
        wanted.append(np.mean((right[piece] - design[piece] @ found) ** 2))
    assert errors_left_out(fit) == pytest.approx(wanted)


def test_left_out_errors_are_greater_than_what_the_fit_leaves():
    fit = linear_fit()
    design, right = stacked(fit, range(RUNS))
    left = right - design @ np.linalg.lstsq(design, right, rcond=None)[0]
    assert errors_left_out(fit).mean() > np.mean(left**2)


def test_a_prior_that_is_certain_holds_a_number_where_it_is():
    certain = Prior(("c2",), np.array([2]), np.zeros(1), np.full(1, -1e-9), np.full(1, 1e-9))
    held, without = linear_fit(prior=certain), linear_fit()
    slopes = without.slopes.copy()
    slopes[..., -1] = 0.0
    assert errors_left_out(held) == pytest.approx(errors_left_out(replace(without, slopes=slopes)))
