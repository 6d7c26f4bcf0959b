"""A pendulum's accelerations from mechanics, a run's energy, activations, and what is refused in which words."""

import re

import numpy as np
import pytest

from gaitdisc.engines.engine import read_model
from gaitdisc.engines.motion import Motion
from gaitdisc.errors import GaitdiscError

from .conftest import DAMPING, GEAR, GRAVITY, INERTIA, LENGTH, MASS, PENDULUM

AT = Motion(np.array([[0.7], [-0.2]]), np.array([[1.5], [-3.0]]), np.array([[0.4], [0.1]]))


def by_hand(at, mass=MASS, force=0.0):
    moment = GEAR * at.u - DAMPING * at.v - mass * GRAVITY * LENGTH * np.sin(at.q) + force
    return moment / ((INERTIA + MASS * LENGTH**2) * mass / MASS)


def test_accelerations_are_those_of_mechanics(pendulum):
    model = read_model(pendulum)
    assert np.allclose(model.accelerations(AT, {}), by_hand(AT), rtol=1e-9)
    force = np.array([[2.0], [-1.0]])
    assert np.allclose(model.accelerations(AT, {}, force), by_hand(AT, force=force), rtol=1e-9)


def test_a_heavier_body_keeps_its_shape_and_is_put_back(pendulum):
    model = read_model(pendulum)
    assert np.allclose(model.accelerations(AT, {"rod_mass": 2.5}), by_hand(AT, 2.5), rtol=1e-9)
    assert np.allclose(model.accelerations(AT, {}), by_hand(AT), rtol=1e-9)


def test_names_units_and_values(pendulum):
    model = read_model(pendulum)
    (pivot,), (drive,) = model.coordinates, model.controls
    assert (pivot.speed, pivot.port, pivot.force_unit) == ("pivot_speed", "pivot_moment", "N m")
    assert drive.name == "drive"
    values = {one.name: one.value for one in model.parameters if one.name in model.offered}
    assert values == {"gravity": GRAVITY, "rod_mass": MASS, "pivot_damping": DAMPING}


@pytest.mark.parametrize("driven", [1, 0])
def test_a_small_swing_has_the_period_of_mechanics(pendulum, driven):
    free = PENDULUM.replace(f'damping="{DAMPING}"', "")
    pendulum.write_text(free if driven else re.sub("<actuator>.*</actuator>", "", free, flags=re.DOTALL))
    model = read_model(pendulum)
    start = Motion(np.array([[0.01]]), np.zeros((1, 1)), np.zeros((1, driven)))
    run = model.run(start, np.zeros((1, 400, driven)), 100.0)[0, :, 0]
    omega = np.sqrt(MASS * GRAVITY * LENGTH / (INERTIA + MASS * LENGTH**2))
    assert np.allclose(run, 0.01 * np.cos(omega * np.arange(400) / 100), atol=2e-4)


def test_a_muscle_that_has_only_a_scale_has_a_force(pendulum):
    muscle = '<muscle name="drive" joint="pivot" lengthrange="-1 1" scale="80"{}/>'
    said = PENDULUM.replace(f'<motor name="drive" joint="pivot" gear="{GEAR}"/>', muscle)
    at = Motion(np.array([[0.2]]), np.zeros((1, 1)), np.array([[0.5]]))
    pendulum.write_text(said.format(""))
    model = read_model(pendulum)
    force = next(one.value for one in model.parameters if one.name == "drive_force")
    pendulum.write_text(model.text_with_value(said.format(""), "drive_force", 0.7 * force))
    assert np.allclose(
        read_model(pendulum).accelerations(at, {}), model.accelerations(at, {"drive_force": 0.7 * force})
    )
    assert np.allclose(model.accelerations(at, {"drive_force": force * (1 + 1e-12)}), model.accelerations(at, {}))


def test_an_activation_lags_as_its_actuator_says(pendulum):
    lagging = '<general name="drive" joint="pivot" dyntype="filter" dynprm="0.05"/>'
    pendulum.write_text(PENDULUM.replace(f'<motor name="drive" joint="pivot" gear="{GEAR}"/>', lagging))
    controls = np.repeat([[0.0], [1.0]], [10, 90], axis=0)
    rest = np.zeros((100, 1))
    acting = read_model(pendulum).along(rest, rest, controls, 100.0).u[:, 0]
    assert acting[:9].max() == 0.0
    after = np.arange(5, 80) / 100
    assert np.allclose(acting[15:90], 1 - np.exp(-(after + 0.005) / 0.05), atol=0.01)  # the step is a ramp of 10 ms


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (("<worldbody>", "<worldbod>"), "must be able to read"),
        (('gear="5.0"', 'gear="5.0" unheard="1"'), "Correct the part that the message names"),
        (("</worldbody>", '</worldbody><equality><joint name="held" joint1="pivot"/></equality>'), "'held' makes"),
    ],
)
def test_what_has_no_place_is_refused_in_words(pendulum, change, words):
    assert change[0] in PENDULUM
    pendulum.write_text(PENDULUM.replace(*change))
    with pytest.raises(GaitdiscError, match=words):
        read_model(pendulum)


def test_a_run_that_leaves_every_bound_is_none_and_the_warning_goes_into_no_file(pendulum, monkeypatch):
    monkeypatch.chdir(pendulum.parent)
    stiff = PENDULUM.replace("damping=", 'stiffness="1e9" damping=').replace('timestep="0.001"', 'timestep="0.01"')
    pendulum.write_text(stiff)
    model = read_model(pendulum)
    assert model.warnings == ()
    run = model.run(Motion(np.ones((1, 1)), np.zeros((1, 1)), np.zeros((1, 1))), np.zeros((1, 60, 1)), 100.0)
    assert not np.isfinite(run[0, -1]).any()
    assert model.warnings and "The simulation is unstable." in model.warnings[0]
    assert [one.name for one in pendulum.parent.iterdir()] == ["pendulum.xml"]
