from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from made_joint import made_joint

from gaitdisc.discovery.changed_moment import find_change, foot_mass
from gaitdisc.discovery.joint_and_trials import as_walk, changes, nominal_moment


@pytest.fixture(scope="module")
def nominal():
    return made_joint(seed=1)


@pytest.fixture(scope="module")
def model(nominal):
    return nominal_moment(nominal)


def changed(model, nominal, device) -> Any:
    return find_change(model, as_walk(nominal), as_walk(device), changes(device))


def test_the_same_muscles_changed_nothing(model, nominal):
    assert changed(model, nominal, made_joint(seed=2)) is None


@pytest.mark.parametrize(
    ("hidden", "name", "place", "value"),
    [
        ({"spring": 150.0}, "one_sided_spring", "ankle_moment", 150.0),
        ({"late_s": 0.05}, "wrong_parameter", "emg_delay", -0.05),
        ({"strength": 0.7}, "wrong_parameter", "plantarflexors_strength", 0.7),
    ],
)
@pytest.mark.slow
def test_what_changed_is_found_with_its_number(model, nominal, hidden, name, place, value):
    found = changed(model, nominal, made_joint(seed=3, **hidden))
    assert (found.change.name, found.change.place) == (name, place)
    assert found.value == pytest.approx(value, rel=0.1)
    assert abs(found.value - value) < 3 * found.spread
    assert (found.rival.name, found.rival.place) != (name, place)
    assert found.rival_leaves > 1


def test_gains_that_the_nominal_walk_mistakes_are_mended_by_both_walks(nominal, model):
    """An envelope that holds a muscle of constant tone hides its gain from one walk; the other, relieved, shows it."""
    device = made_joint(seed=3, spring=150.0)
    relieved = replace(device, envelopes=0.6 * device.envelopes, moment=device.moment)
    driven = as_walk(device).driven
    moment = device.moment - 0.4 * model.by_muscle(driven).sum(axis=1)
    wrong = replace(model, gains=0.8 * model.gains)
    found = changed(wrong, nominal, replace(relieved, moment=moment))
    assert found.value == pytest.approx(150.0, rel=0.1)
    np.testing.assert_allclose(found.model.gains.mean(axis=1), model.gains.mean(axis=1), rtol=0.1)


def test_a_mass_at_the_foot_is_weighed_where_its_moment_is_known(model, nominal):
    device = made_joint(seed=3)
    per_kg = 6.0 * np.cos(2 * np.pi * device.phase)
    heavier = replace(device, per_kg=per_kg, moment=device.moment - 0.8 * per_kg)
    found = changed(model, nominal, heavier)
    assert found.change.place == "added_foot_mass"
    assert found.value == pytest.approx(0.8, rel=0.1)


@pytest.mark.slow
def test_a_spring_whose_interval_holds_none_is_not_named(model, nominal, monkeypatch):
    """Without what nobody measured, 50 N m/rad are found to 5; with the lag of activation in doubt, 40 are nothing."""
    device = made_joint(seed=3, spring=50.0)
    spring = [one for one in changes(device) if one.name == "one_sided_spring"]
    walks = as_walk(nominal), as_walk(device)
    assert find_change(model, *walks, spring) is None
    monkeypatch.setattr("gaitdisc.discovery.changed_moment.LAGS", (1.0, 1.0))
    found = find_change(model, *walks, spring)
    assert found is not None and found.value == pytest.approx(50.0, rel=0.1)


def weighed(nominal, model, kg, resisted=0.0):
    """A walk whose inverse dynamics lacks a mass, whose path departs and is resisted [N m/rad]."""
    device = made_joint(seed=3)
    per_kg = 6.0 * np.cos(2 * np.pi * device.phase)
    departure = 0.03 * np.cos(2 * np.pi * device.phase + 0.5) * (resisted > 0)
    moment = device.moment + resisted * departure - kg * per_kg
    changed = replace(device, angle=device.angle - departure, moment=moment)
    return foot_mass(model, as_walk(nominal), as_walk(changed), per_kg)


@pytest.mark.parametrize("kg", [0.8, 0.0])
def test_a_mass_is_weighed_and_none_is_none(nominal, model, kg):
    value, spread = weighed(nominal, model, kg)
    assert value == pytest.approx(kg, abs=0.1)
    assert abs(value - kg) < 3 * spread


def test_what_resists_the_departure_does_not_hide_the_mass(nominal, model):
    """60 N m/rad against 0.03 rad answer 1.8 of the 4.8 N m of the mass: a fit that knows none would find 0.5 kg."""
    value, spread = weighed(nominal, model, 0.8, resisted=60.0)
    assert value == pytest.approx(0.8, abs=0.12)
    assert abs(value - 0.8) < 3 * spread
