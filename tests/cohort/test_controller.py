"""What a leg has learnt: a whole table, and commands that allow for the spring."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from gaitdisc.cohort.body import cycle_rate
from gaitdisc.cohort.cohort import the_twelve
from gaitdisc.cohort.controller import COLUMNS, engaged_moment, learnt_table
from gaitdisc.cohort.leg_path import PHASES
from gaitdisc.cohort.muscles import capacities, cycle_activation, strength_of
from gaitdisc.cohort.person import Spring, drawn


def test_the_table_is_whole_and_closes():
    table = learnt_table(drawn("A", 1, "f"), 0)
    assert table.shape == (PHASES + 1, COLUMNS.width)
    assert np.isfinite(table).all()
    assert np.array_equal(table[0], table[-1])


def test_a_slack_spring_teaches_nothing():
    person = drawn("A", 1, "f")
    assert np.array_equal(learnt_table(person, 0), learnt_table(person.adapted_to(Spring(0.0)), 0))


def test_relief_lets_soleus_rest():
    person = drawn("A", 1, "f").relieved(0.6)
    person = type(person)(**{**vars(person), "adaptation": person.unadapted().relieved(0.6).adaptation})
    soleus = COLUMNS.excitation + 4
    before = learnt_table(person, 0)[:, soleus]
    after = learnt_table(person.adapted_to(Spring(5.0)), 0)[:, soleus]
    assert after.max() < 0.95 * before.max()
    assert after.mean() < 0.9 * before.mean()
    assert np.all(after[:500] <= before[:500] + 0.005)  # while the spring pulls


def test_the_spring_engages_where_it_fits():
    person = drawn("A", 1, "f")
    psi = np.radians([[0.0, 0.0, person.engaged_deg + 4.0], [0.0, 0.0, person.engaged_deg - 4.0]])
    assert engaged_moment(Spring(5.0), person, psi) == pytest.approx([-20.0, 0.0])


def test_muscles_cause_the_moments():
    """What they leave is at most 10 % of the ankle's moment, 15 % of the knee's (root mean square over the stride)."""
    for person in the_twelve(calibration=True)[:3]:
        table = learnt_table(person, 0)[:-1]
        psi, others = table[:, :3], table[:, COLUMNS.others : COLUMNS.others + 3]
        step_s = person.stride_s / PHASES
        strength = strength_of(person.mass_kg, person.style.strength[0])
        rate = cycle_rate(psi, step_s)
        joint = [np.column_stack([a[:, 0], a[:, 0] - a[:, 1], a[:, 2] - a[:, 1]]) for a in (psi, rate)]
        activation = cycle_activation(table[:, COLUMNS.excitation : COLUMNS.others], step_s, 3)
        by_muscles = np.einsum("pm,pmj->pj", activation, capacities(strength, *joint))
        share = np.sqrt(np.mean(others**2, axis=0) / np.mean((by_muscles + others) ** 2, axis=0))
        assert share[1] < 0.15
        assert share[2] < 0.10


def test_commands_do_not_rest_on_rounding(person):
    """A muscle that lets go is at rest to within rounding: which side of it must not decide who acts in its place."""
    table, other = (learnt_table(replace(person, mass_kg=m), 0) for m in (person.mass_kg, person.mass_kg * (1 + 1e-12)))
    assert other == pytest.approx(table, rel=1e-6, abs=1e-6)
