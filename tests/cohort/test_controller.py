"""What a leg has learnt holds the belt's speed, and its commands are the inverse dynamics of its habit."""

from __future__ import annotations

import numpy as np
import pytest

from gaitdisc.cohort.body import leg_of
from gaitdisc.cohort.controller import (
    COLUMNS,
    PHASES,
    belt_held,
    contact_path,
    engaged_moment,
    habit_angles,
    hip_motion,
    learnt_table,
    thigh_shank_foot,
)
from gaitdisc.cohort.device import Spring
from gaitdisc.cohort.ground import pressure_centre
from gaitdisc.cohort.person import drawn

PHASE = np.arange(PHASES) / PHASES
STANDS = (PHASE > 0.10) & (PHASE < 0.48)


def sole_speed(person, psi):
    leg = leg_of(person.height_m, person.mass_kg)
    path = contact_path(leg, psi, pressure_centre(PHASE, leg.sole_m)) / person.stride_s
    return (path + hip_motion(person, PHASE))[STANDS]


@pytest.mark.parametrize("seed", range(6))
def test_a_standing_foot_goes_with_the_belt(seed):
    person = drawn("A", seed, "fm"[seed % 2])
    leg = leg_of(person.height_m, person.mass_kg)
    free = thigh_shank_foot(habit_angles(person, 0, PHASE))
    held = belt_held(person, leg, free, hip_motion(person, PHASE))
    assert sole_speed(person, held)[:, 0] == pytest.approx(-person.speed_m_per_s, rel=0.03)
    assert np.abs(np.degrees(held - free)).max() < 9.0


def test_the_published_curves_nearly_hold_the_belt_themselves():
    person = drawn("A", 2, "f")
    free = thigh_shank_foot(habit_angles(person, 0, PHASE))
    assert sole_speed(person, free)[:, 0].mean() == pytest.approx(-person.speed_m_per_s, rel=0.08)


def test_thigh_shank_foot_adds_up():
    psi = thigh_shank_foot(np.array([[20.0, 1.0, 2.0, 15.0, -5.0]]))
    assert np.degrees(psi[0]) == pytest.approx([20.0, 5.0, 0.0])


def test_a_hip_comes_back_after_a_stride():
    assert hip_motion(drawn("A", 1, "f"), PHASE).mean(axis=0) == pytest.approx([0.0, 0.0], abs=1e-9)


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
