"""What a leg has learnt: a whole table, and commands that allow for the spring."""

from __future__ import annotations

import numpy as np
import pytest

from gaitdisc.cohort.controller import COLUMNS, engaged_moment, learnt_table
from gaitdisc.cohort.device import Spring
from gaitdisc.cohort.leg_path import PHASES
from gaitdisc.cohort.person import drawn


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
    assert np.all(after <= before + 1e-12)


def test_the_spring_engages_where_it_fits():
    person = drawn("A", 1, "f")
    psi = np.radians([[0.0, 0.0, person.engaged_deg + 4.0], [0.0, 0.0, person.engaged_deg - 4.0]])
    assert engaged_moment(Spring(5.0), person, psi) == pytest.approx([-20.0, 0.0])
