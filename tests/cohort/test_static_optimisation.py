"""Static optimisation of many phases at once, against a solver for one and against what it promises."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import minimize

from gaitdisc.cohort.controller import shared
from gaitdisc.cohort.muscles import capacities, strength_of

PHASES = 40


@pytest.fixture(scope="module")
def task():
    rng = np.random.default_rng(2)
    capacity = capacities(strength_of(70.0), 0.2 * rng.normal(size=(PHASES, 3)), rng.normal(size=(PHASES, 3)))
    wanted = rng.normal(size=(PHASES, 3)) * (25.0, 20.0, 25.0)
    return wanted, capacity, rng.uniform(0.02, 0.2, (PHASES, 9)), np.full((PHASES, 9), 0.02), rng.uniform(1, 3, 9)


def test_the_moments_are_met_within_the_bounds(task):
    wanted, capacity, habit, least, dear = task
    found = shared(wanted, capacity, habit, least, dear)
    assert np.all((found >= least) & (found <= 1.0))
    given = np.einsum("pm,pmj->pj", found, capacity)
    assert np.abs(given - wanted).max() < 0.02 * np.abs(wanted).max()


def test_it_is_what_a_general_solver_finds(task):
    wanted, capacity, habit, least, dear = task
    found = shared(wanted, capacity, habit, least, dear)
    for phase in (0, 7, 23):
        by = minimize(
            lambda a, p: float(dear @ (a - habit[p]) ** 2),
            habit[phase],
            args=(phase,),
            method="SLSQP",
            bounds=[(0.02, 1.0)] * 9,
            constraints={"type": "eq", "fun": lambda a, p=phase: a @ capacity[p] - found[p] @ capacity[p]},
            options={"ftol": 1e-12, "maxiter": 500},
        )
        assert found[phase] == pytest.approx(by.x, abs=2e-3)


def test_a_habit_that_meets_the_moments_is_kept(task):
    _, capacity, habit, least, dear = task
    wanted = np.einsum("pm,pmj->pj", habit, capacity)
    assert shared(wanted, capacity, habit, least, dear) == pytest.approx(habit, abs=1e-9)


def test_cocontraction_of_antagonists_costs_no_moment(task):
    wanted, capacity, habit, least, dear = task
    calm, tense = (shared(wanted, capacity, level * habit, least, dear) for level in (0.2, 2.0))
    assert tense.sum() > 1.3 * calm.sum()
    both = [np.einsum("pm,pmj->pj", found, capacity) for found in (calm, tense)]
    assert both[0] == pytest.approx(both[1], abs=0.02 * np.abs(wanted).max())


def test_what_cannot_be_met_is_left_and_nothing_breaks(task):
    _, capacity, habit, least, dear = task
    found = shared(np.full((PHASES, 3), 5000.0), capacity, habit, least, dear)
    assert np.all(np.isfinite(found))
    assert np.all((found >= least) & (found <= 1.0))
