"""Without noise the body follows its habit: commands, equations of motion and ground agree."""

from __future__ import annotations

import numpy as np
import pytest

from gaitdisc.cohort.body import leg_of
from gaitdisc.cohort.controller import COLUMNS, learnt_table
from gaitdisc.cohort.ground import Belt
from gaitdisc.cohort.motion import NOISE, NOISE_STEPS, STEP_S, Worn, moved
from gaitdisc.cohort.muscles import strength_of
from gaitdisc.cohort.walk import _loop


def quiet_walk(person, duration_s, stiffness=0.0, damping=1.0):
    table = np.stack([learnt_table(person, side) for side in (0, 1)])
    noise = np.zeros((round(duration_s / STEP_S / NOISE_STEPS) + 1, NOISE))
    worn = Worn(np.degrees(stiffness), np.radians(person.engaged_deg), person.speed_m_per_s, person.stride_s)
    loop = _loop(person)
    loop = loop._replace(damping=damping * loop.damping)
    leg = leg_of(person.height_m, person.mass_kg)
    strengths = tuple(strength_of(person.mass_kg, person.style.strength[side]) for side in (0, 1))
    return moved(leg, strengths, Belt(), loop, worn, np.stack([table, table]), noise)


def test_without_noise_the_legs_follow_their_habit(person):
    _, slow, upright = quiet_walk(person, 12.0)
    assert upright
    late = slow[600:]
    table = learnt_table(person, 0)
    for link in range(3):
        habit = np.interp(late[:, 0] % 1.0, np.linspace(0, 1, len(table)), table[:, COLUMNS.psi + link])
        assert np.degrees(np.abs(late[:, 1 + link] - habit)).max() < 0.6


def test_without_noise_strides_last_what_they_should(person):
    quick, _, _ = quiet_walk(person, 12.0)
    rate = (quick[-1, 0] - quick[6000, 0]) / (len(quick) - 1 - 6000) * 1000
    assert 1 / rate == pytest.approx(person.stride_s, rel=0.005)


def test_a_stiff_spring_leaves_its_moment_and_less_dorsiflexion(person):
    _, free, _ = quiet_walk(person, 12.0)
    _, held, _ = quiet_walk(person, 12.0, stiffness=5.0)
    ankle = [np.degrees(walk[600:, 3] - walk[600:, 2]).max() for walk in (free, held)]
    assert ankle[1] < ankle[0] - 2.0
    assert np.all(free[:, 17:19] == 0.0)
    assert held[600:, 17].min() == pytest.approx(-5.0 * (ankle[1] - person.engaged_deg), abs=0.5)


def test_a_body_that_is_driven_apart_is_reported(person):
    assert not quiet_walk(person, 4.0, damping=-6.0)[2]
