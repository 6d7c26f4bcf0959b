"""A foot that stands on the belt goes with it, and each person's curves keep their own time."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gaitdisc.cohort.body import leg_of
from gaitdisc.cohort.ground import habitual_force, pressure_centre
from gaitdisc.cohort.leg_path import (
    PHASES,
    belt_held,
    by_phase,
    contact_path,
    habit_angles,
    hip_motion,
    pressed_point,
    staged,
    thigh_shank_foot,
)
from gaitdisc.cohort.person import drawn

PHASE = np.arange(PHASES) / PHASES
STANDS = (PHASE > 0.10) & (PHASE < 0.48)


def sole_speed(person, psi):
    leg = leg_of(person.height_m, person.mass_kg)
    path = contact_path(leg, psi, pressure_centre(staged(person, PHASE), leg.sole_m)) / person.stride_s
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
    assert sole_speed(person, free)[:, 0].mean() == pytest.approx(-person.speed_m_per_s, rel=0.13)


def test_thigh_shank_foot_adds_up():
    psi = thigh_shank_foot(np.array([[20.0, 1.0, 2.0, 15.0, -5.0]]))
    assert np.degrees(psi[0]) == pytest.approx([20.0, 5.0, 0.0])


def test_a_hip_comes_back_after_a_stride():
    assert hip_motion(drawn("A", 1, "f"), PHASE).mean(axis=0) == pytest.approx([0.0, 0.0], abs=1e-9)


@given(st.integers(0, 500))
def test_each_persons_stance_ends_where_it_ends_in_them(seed):
    person = drawn("A", seed, "f")
    stage = staged(person, PHASE)
    assert stage[0] == 0.0
    assert np.all(np.diff(stage) > 0)
    up = habitual_force(stage, person.dimensionless_speed)[:, 1] * person.mass_kg * 9.81
    assert 0.58 < person.stance < 0.632
    assert PHASE[up > 20.0].max() == pytest.approx(person.stance, abs=0.008)


def test_a_pressed_point_turns_with_the_foot():
    leg = leg_of(1.7, 70.0)
    flat, upright = (pressed_point(leg, np.array([angle]), np.array([0.1]))[0] for angle in (0.0, np.pi / 2))
    assert flat == pytest.approx([0.1, -leg.ankle_m])
    assert upright == pytest.approx([leg.ankle_m, 0.1])


def test_rate_by_phase_of_a_sine_is_its_cosine():
    turn = 2 * np.pi * PHASE
    assert by_phase(np.sin(turn)[:, None])[:, 0] == pytest.approx(2 * np.pi * np.cos(turn), abs=1e-3)
