"""Muscles, and static optimisation of many phases at once, against a solver for one and what it promises."""

import numpy as np
import pytest
from scipy.optimize import minimize

from gaitdisc.cohort.controller import share
from gaitdisc.cohort.muscles import (
    ECCENTRIC,
    FALL_S,
    RISE_S,
    activate,
    capacities,
    cycle_activation,
    cycle_excitation,
    find_strength,
    force_at_speed,
    muscle_moments,
)
from gaitdisc.cohort.person import GROUPS

STRENGTH = find_strength(70.0)


def stepped(start, excitation, seconds, step_s=1e-5):
    level = start
    for _ in range(round(seconds / step_s)):
        level = activate(excitation, level, step_s)
    return level


def test_activation_rises_faster_than_it_falls():
    assert stepped(0.0, 1.0, RISE_S) == pytest.approx(1 - np.exp(-1), abs=1e-3)
    assert stepped(1.0, 0.0, FALL_S) == pytest.approx(np.exp(-1), abs=1e-3)


def moments_of(name, joint=(0.0, 0.0, 0.0), rate=(0.0, 0.0, 0.0)):
    activation, moments = np.zeros(len(GROUPS)), np.zeros(3)
    activation[GROUPS.index(name)] = 0.5
    muscle_moments(STRENGTH, activation, np.array(joint), np.array(rate), moments)
    return moments


@pytest.mark.parametrize(
    ("name", "signs"),
    [
        ("emg_sol", (0, 0, -1)),
        ("emg_gas", (0, 1, -1)),
        ("emg_ta", (0, 0, 1)),
        ("emg_vas", (0, -1, 0)),
        ("emg_rf", (1, -1, 0)),
        ("emg_ham", (-1, 1, 0)),
        ("iliopsoas", (1, 0, 0)),
        ("gluteus_maximus", (-1, 0, 0)),
        ("emg_gmed", (0, 0, 0)),
    ],
)
def test_muscles_pull_the_way_they_are_named(name, signs):
    assert np.sign(moments_of(name)).tolist() == list(signs)


def test_a_lengthening_muscle_gives_more_and_a_shortening_one_less():
    still = moments_of("emg_sol")[2]
    assert moments_of("emg_sol", rate=(0.0, 0.0, 2.0))[2] < 1.1 * still < 0
    assert 0.9 * still < moments_of("emg_sol", rate=(0.0, 0.0, -2.0))[2] < 0


def test_force_and_speed_are_hills():
    assert force_at_speed(0.0) == 1.0
    assert force_at_speed(-1.0) == force_at_speed(-2.0) == 0.0
    assert force_at_speed(50.0) == pytest.approx(1.0 + ECCENTRIC, abs=0.01)
    slopes = [(force_at_speed(step) - 1.0) / step for step in (1e-6, -1e-6)]
    assert slopes[0] == pytest.approx(slopes[1], rel=1e-3)


def test_plantarflexors_are_stronger_in_dorsiflexion():
    assert moments_of("emg_sol", joint=(0.0, 0.0, 0.2))[2] < moments_of("emg_sol")[2]


def test_capacity_is_the_moment_of_each_muscle_alone():
    found = capacities(STRENGTH, np.zeros((2, 3)), np.zeros((2, 3)))
    assert found.shape == (2, len(GROUPS), 3)
    assert found[1] == pytest.approx(STRENGTH.reach)


def test_a_change_of_command_is_shared_out_whole():
    for take in (STRENGTH.take_up, STRENGTH.take_down):
        assert np.all(take * STRENGTH.reach >= 0)
        assert (take * STRENGTH.reach).sum(axis=0) == pytest.approx(np.ones(3))


def test_excitation_gives_back_an_activation_that_is_slow_enough():
    step = 0.001
    phase = np.arange(1000) / 1000
    wanted = 0.3 - 0.2 * np.cos(2 * np.pi * phase)[:, None]
    rest = np.array([0.01])
    found = cycle_activation(cycle_excitation(wanted, rest, step), step, 3)
    assert found == pytest.approx(wanted, abs=0.01)
    fast = np.where(phase < 0.5, 0.5, 0.02)[:, None]
    assert cycle_activation(cycle_excitation(fast, rest, step), step, 3)[510] > 0.3  # muscles let go slowly


def test_cycle_activation_is_periodic_and_lags():
    count, step = 500, 0.002
    phase = np.arange(count) / count
    excitation = np.repeat(np.maximum(0.05, np.sin(2 * np.pi * phase))[:, None], 7, axis=1)
    activation = cycle_activation(excitation, step, 3)
    assert activation[:, 0].argmax() > excitation[:, 0].argmax()
    last = activate(excitation[-1, 0], activation[-1, 0], step)
    assert last == pytest.approx(activation[0, 0], abs=1e-6)


PHASES = 40


@pytest.fixture(scope="module")
def task():
    rng = np.random.default_rng(2)
    capacity = capacities(find_strength(70.0), 0.2 * rng.normal(size=(PHASES, 3)), rng.normal(size=(PHASES, 3)))
    wanted = rng.normal(size=(PHASES, 3)) * (25.0, 20.0, 25.0)
    return wanted, capacity, rng.uniform(0.02, 0.2, (PHASES, 9)), np.full((PHASES, 9), 0.02), rng.uniform(1, 3, 9)


def test_the_moments_are_met_within_the_bounds(task):
    wanted, capacity, habit, least, dear = task
    found = share(wanted, capacity, habit, least, dear)
    assert np.all((found >= least) & (found <= 1.0))
    given = np.einsum("pm,pmj->pj", found, capacity)
    assert np.abs(given - wanted).max() < 0.02 * np.abs(wanted).max()


def test_it_is_what_a_general_solver_finds(task):
    wanted, capacity, habit, least, dear = task
    found = share(wanted, capacity, habit, least, dear)
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
    assert share(wanted, capacity, habit, least, dear) == pytest.approx(habit, abs=1e-9)


def test_cocontraction_of_antagonists_costs_no_moment(task):
    wanted, capacity, habit, least, dear = task
    calm, tense = (share(wanted, capacity, level * habit, least, dear) for level in (0.2, 2.0))
    assert tense.sum() > 1.3 * calm.sum()
    both = [np.einsum("pm,pmj->pj", found, capacity) for found in (calm, tense)]
    assert both[0] == pytest.approx(both[1], abs=0.02 * np.abs(wanted).max())


def test_what_cannot_be_met_is_left_and_nothing_breaks(task):
    _, capacity, habit, least, dear = task
    found = share(np.full((PHASES, 3), 5000.0), capacity, habit, least, dear)
    assert np.all(np.isfinite(found))
    assert np.all((found >= least) & (found <= 1.0))
