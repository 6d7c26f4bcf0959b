"""Insertions into a pendulum's own text: each read again, its accelerations those of mechanics; comments stay."""

import numpy as np
import pytest

from gaitdisc.engines.engine import read_model
from gaitdisc.engines.mapping import draft
from gaitdisc.engines.motion import ByHand, Motion
from gaitdisc.engines.mujoco_text import with_effect, with_value
from gaitdisc.engines.written import write_model
from gaitdisc.simulation.parts import Term

from .conftest import DAMPING, INERTIA, LENGTH, MASS, PENDULUM
from .test_mujoco_model import by_hand

AT = Motion(np.array([[0.7], [-0.2], [0.05]]), np.array([[1.5], [-3.0], [0.8]]), np.zeros((3, 1)))
EFFECTS = {
    "linear_stiffness": lambda x, v: -4.0 * x,
    "cubic_stiffness": lambda x, v: -4.0 * x**3,
    "viscous_damping": lambda x, v: -0.7 * v,
    "quadratic_drag": lambda x, v: -0.7 * v * abs(v),
    "one_sided_spring": lambda x, v: -4.0 * max(0.0, x - 0.1),
    "coulomb_friction": lambda x, v: -0.6 * float(np.tanh(v / 0.02)),
}
OWN = {"stiffness": 0.0, "damping": DAMPING, "frictionloss": 0.0}


def effect(name):
    text = "-4*max(0, pivot - 0.1)" if name == "one_sided_spring" else ""
    return ByHand(Term("pivot_moment", "port", name, text), 0, EFFECTS[name])


@pytest.mark.parametrize("name", EFFECTS)
def test_an_effect_in_the_models_own_form_is_the_expression(pendulum, name):
    text = with_effect(PENDULUM, effect(name), "pivot", OWN)
    assert "the user's own words stay" in text
    pendulum.write_text(text)
    force = np.array([[EFFECTS[name](x, v)] for x, v in zip(AT.q[:, 0], AT.v[:, 0], strict=True)])
    found = read_model(pendulum).accelerations(AT, {})
    assert np.allclose(found, by_hand(AT, force=force), rtol=1e-8)


def test_a_spring_below_its_engagement_is_slack_above(pendulum):
    below = ByHand(
        Term("pivot_moment", "port", "one_sided_spring", "4*max(0, -0.1 - pivot)"),
        0,
        lambda x, v: 4.0 * max(0.0, -0.1 - x),
    )
    pendulum.write_text(with_effect(PENDULUM, below, "pivot", OWN))
    force = np.array([[0.0], [0.4], [0.0]])
    assert np.allclose(read_model(pendulum).accelerations(AT, {}), by_hand(AT, force=force), rtol=1e-9)


def test_a_second_spring_joins_the_one_that_is_there(pendulum):
    own = PENDULUM.replace("damping=", 'stiffness="2" springref="30" damping=')
    pendulum.write_text(with_effect(own, effect("linear_stiffness"), "pivot", OWN | {"stiffness": 2.0}))
    force = -4.0 * AT.q - 2.0 * (AT.q - np.deg2rad(30))
    assert np.allclose(read_model(pendulum).accelerations(AT, {}), by_hand(AT, force=force), rtol=1e-9)


def test_a_damper_of_a_default_class_is_kept(pendulum):
    own = PENDULUM.replace(f' damping="{DAMPING}"', "")
    own = own.replace("<worldbody>", f'<default><joint damping="{DAMPING}"/></default><worldbody>')
    pendulum.write_text(own)
    text = read_model(pendulum).text_with_effect(own, effect("viscous_damping"))
    pendulum.write_text(text)
    assert np.allclose(read_model(pendulum).accelerations(AT, {}), by_hand(AT, force=-0.7 * AT.v), rtol=1e-9)


def test_numbers_of_the_model(pendulum):
    pendulum.write_text(with_value(PENDULUM, "rod_mass", 2.5, "body", "rod"))
    assert np.allclose(read_model(pendulum).accelerations(AT, {}), by_hand(AT, 2.5), rtol=1e-9)
    pendulum.write_text(with_value(PENDULUM, "gravity", 8.0, "joint", ""))
    still = Motion(np.array([[np.pi / 2]]), np.zeros((1, 1)), np.zeros((1, 1)))
    wanted = -MASS * 8.0 * LENGTH / (INERTIA + MASS * LENGTH**2)
    assert read_model(pendulum).accelerations(still, {})[0, 0] == pytest.approx(wanted)
    assert 'gear="6.5"' in with_value(PENDULUM, "drive_gear", 6.5, "actuator", "drive")


def test_what_has_no_form_or_no_name_is_not_written():
    odd = ByHand(Term("pivot_moment", "port", "gravity_moment", ""), 0, lambda x, v: np.sin(x))
    assert with_effect(PENDULUM, odd, "pivot", OWN) is None
    assert with_effect(PENDULUM, effect("viscous_damping"), "elsewhere", OWN) is None
    assert with_value(PENDULUM, "foot_mass", 1.0, "body", "foot") is None


BAND = """<tendon><spatial name="band" stiffness="0" springlength="0.2"><site site="above"/><site site="on"/></spatial>
<fixed name="pivot" damping="0.2"><joint joint="pivot" coef="2"/></fixed></tendon></mujoco>"""


def test_a_tendon_is_a_place_also_where_its_spring_is_missing(pendulum):
    sited = PENDULUM.replace("<body name", '<site name="above" pos="0.3 0 0"/><body name')
    sited = sited.replace("</body>", '<site name="on" pos="0 0 -0.3"/></body>').replace("</mujoco>", BAND)
    pendulum.write_text(sited)
    model = read_model(pendulum)
    units = {one.name: one.unit for one in model.parameters}
    assert (units["band_stiffness"], units["pivot_tendon_damping"]) == ("N/m", "N m s/rad")
    assert {"band_stiffness", "band_damping", "pivot_tendon_damping"} <= set(model.offered)
    force = model.accelerations(AT, {"pivot_tendon_damping": 0.5}) - model.accelerations(AT, {})
    assert np.allclose(force, -0.3 * 4 * AT.v / (INERTIA + MASS * LENGTH**2), rtol=1e-9)
    pulled = model.accelerations(AT, {"band_stiffness": 40.0})
    assert np.abs(pulled - model.accelerations(AT, {})).min() > 0.1
    found = write_model(model, draft(model).with_values({"band_stiffness": 40.0}))
    assert 'stiffness="40.0"' in found.text and np.allclose(found.engine.accelerations(AT, {}), pulled, rtol=1e-12)
