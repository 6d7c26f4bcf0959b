"""What a leg has learnt: a foot that stands goes with the belt, a whole table, commands that allow for the spring."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gaitdisc.cohort.body import cycle_rate, make_leg
from gaitdisc.cohort.cohort import the_twelve
from gaitdisc.cohort.controller import COLUMNS, learnt_table, spring_moment
from gaitdisc.cohort.leg_path import (
    PHASES,
    belt_held,
    by_phase,
    contact_path,
    habit_angles,
    habitual_force,
    hip_motion,
    map_phase,
    pressure_centre,
    pressure_point,
    thigh_shank_foot,
)
from gaitdisc.cohort.muscles import capacities, cycle_activation, find_strength
from gaitdisc.cohort.person import Spring, draw_one


def test_the_table_is_whole_and_closes():
    table = learnt_table(draw_one("A", 1, "f"), 0)
    assert table.shape == (PHASES + 1, COLUMNS.width)
    assert np.isfinite(table).all()
    assert np.array_equal(table[0], table[-1])


def test_a_slack_spring_teaches_nothing():
    person = draw_one("A", 1, "f")
    assert np.array_equal(learnt_table(person, 0), learnt_table(person.adapt_to(Spring(0.0)), 0))


def test_relief_lets_soleus_rest():
    person = draw_one("A", 1, "f").unadapted()
    person = replace(person, adaptation=replace(person.adaptation, relief=0.6))
    soleus = COLUMNS.excitation + 4
    before = learnt_table(person, 0)[:, soleus]
    after = learnt_table(person.adapt_to(Spring(5.0)), 0)[:, soleus]
    assert after.max() < 0.95 * before.max()
    assert after.mean() < 0.9 * before.mean()
    assert np.all(after[:500] <= before[:500] + 0.005)  # while the spring pulls


def test_the_spring_engages_where_it_fits():
    person = draw_one("A", 1, "f")
    psi = np.radians([[0.0, 0.0, person.engaged_deg + 4.0], [0.0, 0.0, person.engaged_deg - 4.0]])
    assert spring_moment(Spring(5.0), person, psi) == pytest.approx([-20.0, 0.0])


def test_muscles_cause_the_moments():
    """What they leave is at most 10 % of the ankle's moment, 15 % of the knee's (root mean square over the stride)."""
    for person in the_twelve(calibration=True)[:3]:
        table = learnt_table(person, 0)[:-1]
        psi, others = table[:, :3], table[:, COLUMNS.others : COLUMNS.others + 3]
        step_s = person.stride_s / PHASES
        strength = find_strength(person.mass_kg, person.style.strength[0])
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


PHASE = np.arange(PHASES) / PHASES
STANDS = (PHASE > 0.10) & (PHASE < 0.48)


def sole_speed(person, psi):
    leg = make_leg(person.height_m, person.mass_kg)
    path = contact_path(leg, psi, pressure_centre(map_phase(person, PHASE), leg.sole_m)) / person.stride_s
    return (path + hip_motion(person, PHASE))[STANDS]


@pytest.mark.parametrize("seed", range(6))
def test_a_standing_foot_goes_with_the_belt(seed):
    person = draw_one("A", seed, "fm"[seed % 2])
    leg = make_leg(person.height_m, person.mass_kg)
    free = thigh_shank_foot(habit_angles(person, 0, PHASE))
    held = belt_held(person, leg, free, hip_motion(person, PHASE))
    assert sole_speed(person, held)[:, 0] == pytest.approx(-person.speed_m_per_s, rel=0.03)
    assert np.abs(np.degrees(held - free)).max() < 9.0


def test_the_published_curves_nearly_hold_the_belt_themselves():
    person = draw_one("A", 2, "f")
    free = thigh_shank_foot(habit_angles(person, 0, PHASE))
    assert sole_speed(person, free)[:, 0].mean() == pytest.approx(-person.speed_m_per_s, rel=0.13)


def test_thigh_shank_foot_adds_up():
    psi = thigh_shank_foot(np.array([[20.0, 1.0, 2.0, 15.0, -5.0]]))
    assert np.degrees(psi[0]) == pytest.approx([20.0, 5.0, 0.0])


def test_a_hip_comes_back_after_a_stride():
    assert hip_motion(draw_one("A", 1, "f"), PHASE).mean(axis=0) == pytest.approx([0.0, 0.0], abs=1e-9)


@given(st.integers(0, 500))
def test_each_persons_stance_ends_where_it_ends_in_them(seed):
    person = draw_one("A", seed, "f")
    stage = map_phase(person, PHASE)
    assert stage[0] == 0.0
    assert np.all(np.diff(stage) > 0)
    up = habitual_force(stage, person.dimensionless_speed)[:, 1] * person.mass_kg * 9.81
    assert 0.58 < person.stance < 0.632
    assert PHASE[up > 20.0].max() == pytest.approx(person.stance, abs=0.008)


def test_a_pressed_point_turns_with_the_foot():
    leg = make_leg(1.7, 70.0)
    flat, upright = (pressure_point(leg, np.array([angle]), np.array([0.1]))[0] for angle in (0.0, np.pi / 2))
    assert flat == pytest.approx([0.1, -leg.ankle_m])
    assert upright == pytest.approx([leg.ankle_m, 0.1])


def test_rate_by_phase_of_a_sine_is_its_cosine():
    turn = 2 * np.pi * PHASE
    assert by_phase(np.sin(turn)[:, None])[:, 0] == pytest.approx(2 * np.pi * np.cos(turn), abs=1e-3)
