from dataclasses import replace

import numpy as np
import pytest
from made_joint import made_joint

from gaitdisc.batch.joint_and_trials import nominal_moment, walk_of
from gaitdisc.regression.foot_mass import foot_mass


@pytest.fixture(scope="module")
def nominal():
    return made_joint(seed=1)


@pytest.fixture(scope="module")
def model(nominal):
    return nominal_moment(nominal)


def weighed(nominal, model, kg, resisted=0.0):
    """A walk whose inverse dynamics lacks a mass, whose path departs and is resisted [N m/rad]."""
    device = made_joint(seed=3)
    per_kg = 6.0 * np.cos(2 * np.pi * device.phase)
    departure = 0.03 * np.cos(2 * np.pi * device.phase + 0.5) * (resisted > 0)
    moment = device.moment + resisted * departure - kg * per_kg
    changed = replace(device, angle=device.angle - departure, moment=moment)
    return foot_mass(model, walk_of(nominal), walk_of(changed), per_kg)


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
