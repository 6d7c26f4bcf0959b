from __future__ import annotations

import numpy as np
import pytest

from gaitdisc.cohort.person import Spring, drawn
from gaitdisc.recording.body_measures import LEG_OF_STATURE


def test_the_spring_acts_on_one_side_only():
    moment = Spring(5.0).moment(np.array([-10.0, -1.0, 0.0, 9.0]), engaged_deg=-1.0)
    assert moment == pytest.approx([0.0, 0.0, -5.0, -50.0])


def test_slack_moves_the_engagement():
    assert Spring(5.0, slack_deg=3.0).moment(np.array([1.0, 3.0]), engaged_deg=-1.0) == pytest.approx([0.0, -5.0])


def test_a_seed_is_a_person():
    one, same, other = drawn("A", 5, "f"), drawn("B", 5, "f"), drawn("A", 6, "f")
    assert (one.height_m, one.mass_kg, one.stride_s) == (same.height_m, same.mass_kg, same.stride_s)
    assert np.array_equal(one.style.wave_deg, same.style.wave_deg)
    assert one.height_m != other.height_m


def test_a_population_is_the_dissertations():
    people = [drawn("A", seed, "fm"[seed % 2]) for seed in range(400)]
    for name, mean, spread in [
        ("age_years", 23.9, 1.8),
        ("height_m", 1.69, 0.10),
        ("mass_kg", 66.5, 11.7),
        ("speed_m_per_s", 1.36, 0.11),
    ]:
        values = np.array([getattr(person, name) for person in people])
        assert values.mean() == pytest.approx(mean, rel=0.02), name
        assert values.std() == pytest.approx(spread, rel=0.2), name


def test_cadence_is_that_of_schwartz_at_their_speed():
    for seed in range(20):
        person = drawn("A", seed, "m")
        leg = LEG_OF_STATURE * person.height_m
        cadence = 2 / person.stride_s * np.sqrt(leg / 9.81)
        expected = 0.565 * np.sqrt(person.dimensionless_speed / 0.429)
        assert cadence == pytest.approx(expected, rel=0.045)


def test_adaptation_can_be_taken_away_or_set():
    person = drawn("A", 5, "f")
    assert person.learnt is None
    spring = Spring(5.0)
    assert person.adapted_to(spring).learnt == spring
    assert person.unadapted().adaptation.relief == 0.0
    assert not person.unadapted().adaptation.habit_deg.any()
    assert person.relieved(0.3).adaptation.relief == 0.3
    assert person.relieved(0.3).adaptation.effort is person.adaptation.effort
