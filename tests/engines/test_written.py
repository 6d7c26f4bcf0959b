"""What was found goes into the model's own text where the accelerations agree, and is told where it does not."""

import re
from dataclasses import replace

import numpy as np
import pytest
from texts import says

from gaitdisc.discovery.candidate import saturations
from gaitdisc.engines.engine import read_model
from gaitdisc.engines.mapping import draft, with_input_changed, with_strength
from gaitdisc.engines.motion import Motion
from gaitdisc.engines.written import forces_at, load_beside, write_model
from gaitdisc.simulation.evaluating import Points
from gaitdisc.simulation.parts import Term

from .conftest import PENDULUM
from .test_mujoco_model import by_hand


def term(name, text):
    return Term("pivot_moment", "port", name, text)


def test_what_has_a_form_is_written_and_what_has_none_is_told(pendulum):
    model = read_model(pendulum)
    mapping = draft(model).with_values({"rod_mass": 2.2})
    mapping = mapping.with_effect(term("one_sided_spring", "-4.5*max(0, pivot - 0.1)"))
    mapping = mapping.with_effect(term("gravity_moment", "-0.5*sin(pivot)"))
    mapping = mapping.with_effect(term("coulomb_friction", "-0.4*sign(pivot_speed)"))
    mapping = with_strength(mapping, model, "drive", 0.8)
    found = write_model(model, with_input_changed(mapping, "drive", "delay(drive, 0.02)"))
    assert "the user's own words stay" in found.text
    assert 'mass="2.2"' in found.text and "frictionloss" in found.text
    assert float(re.search(r'stiffness="([^"]*)"', found.text)[1]) == pytest.approx(4.5)
    said = "\n".join(found.notes)
    assert said.count("is written into the model") == 4 and 'gear="4.0"' in found.text
    assert says(said, "gravity_moment", "pivot_moment", "no")
    assert says(said, "drive", "delay(drive, 0.02)", "no")
    assert found.engine.parameters != model.parameters


def test_a_form_that_is_not_the_expression_is_not_written(pendulum):
    """The term is a spring on the speed: what the name says is written would move the pendulum otherwise."""
    model = read_model(pendulum)
    wrong = term("linear_stiffness", "-4*pivot*pivot_speed**2 - pivot")
    found = write_model(model, draft(model).with_effect(wrong))
    assert found.text == PENDULUM
    assert "would change the accelerations by a fraction of" in found.notes[0]


def test_a_force_that_remembers_acts_as_along_the_motion(pendulum):
    """Along a run of the same model with another force at each step, it is that force."""
    model, spring = read_model(pendulum), term("gravity_moment", "-3*sin(pivot) - 0.4*pivot_speed")
    late = write_model(model, draft(model).with_effect(term("delayed_feedback", "-2*delay(pivot, 0.05)")))
    assert [one.name for one in late.along] == ["delayed_feedback"] and late.absent == ()
    mapping, t = draft(model).with_effect(spring), np.arange(80) / 100
    beside, u = write_model(model, mapping), 0.2 * np.sin(7 * t)[:, None]
    start = Motion(np.array([[0.3]]), np.zeros((1, 1)), u[:1])
    run = beside.engine.run(start, u[None], 100.0)
    forces = forces_at(model, mapping, (spring,), Points(t, run[0], u, rate=100.0))
    assert beside.along == () and np.abs(model.run(start, u[None], 100.0) - run).max() > 0.1
    assert np.abs(model.run(start, u[None], 100.0, forces[None]) - run).max() < 1e-3


@pytest.mark.parametrize(("low", "high"), [(-0.7, 0.7), (-0.2, 0.5), (-1000.0, 0.5)])
def test_limits_of_a_control_are_written_as_its_range_and_act_at_each_step(pendulum, low, high):
    """A motor far beyond its limit gives gear times the limit, whatever a wider range of the file allows."""
    pendulum.write_text(PENDULUM.replace("gear=", 'ctrlrange="-2000 0.9" gear='))
    model = read_model(pendulum)
    above = with_input_changed(draft(model), "drive", f"min(drive, {high})")
    found = write_model(model, with_input_changed(above, "drive", f"max(drive, {low})"))
    assert f'ctrlrange="{low} {high}"' in found.text and found.definitions == ()
    soft = with_input_changed(draft(model), "drive", "min(drive, 0.5 + 0.1*drive)")
    assert write_model(model, soft).definitions == soft.definitions  # that is more than a limit
    start = Motion(np.array([[0.3]]), np.zeros((1, 1)), np.zeros((1, 1)))
    for control, acts in ((5.0, high), (-5.0, max(low, -5.0)), (0.1, 0.1)):
        run, wanted = (
            one.run(start, np.full((1, 9, 1), u), 100.0) for one, u in ((found.engine, control), (model, acts))
        )
        assert np.array_equal(run, wanted)
        clipped = found.engine.along(start.q, start.v, np.array([[control]]), 100.0)
        assert np.allclose(
            found.engine.accelerations(clipped, {}), by_hand(replace(start, u=np.array([[acts]]))), rtol=1e-9
        )


def test_a_servo_whose_control_is_no_force_keeps_its_numbers(pendulum):
    pendulum.write_text(PENDULUM.replace('<motor name="drive"', '<position kp="3" name="drive"'))
    mapping = with_strength(draft(read_model(pendulum)), read_model(pendulum), "drive", 0.8)
    assert mapping.definitions == (("replaced_drive", "0.8*drive"),)


def test_a_servo_whose_force_is_limited_gets_the_range_of_its_force(pendulum):
    text = PENDULUM.replace('<motor name="drive"', '<position kp="3" kv="0.2" name="drive"')
    pendulum.write_text(text)
    model = read_model(pendulum)
    mapping, ((gain, constant, moved),) = draft(model), model.servos.values()
    (one,) = (each for each in saturations(mapping, model.servos) if each.name == "force_saturation")
    mapping = with_input_changed(mapping, "drive", one.form.format(s="drive", limit="0.4"))
    found, beside = write_model(model, mapping), write_model(model, mapping, native=False)
    assert 'forcelimited="true" forcerange="-0.4 0.4"' in found.text and not found.absent and not found.definitions
    assert says(found.notes[0], "written", "range", "force") and beside.absent == ("drive",)
    assert (gain, constant) == (3.0, 0.0) and "pivot_speed" in moved


def test_files_that_lie_beside_the_model_are_found(pendulum):
    (pendulum.parent / "joint.xml").write_text('<mujoco><option timestep="0.003"/></mujoco>')
    text = PENDULUM.replace("<worldbody>", '<include file="joint.xml"/><worldbody>')
    assert load_beside(pendulum, text).coordinates[0].name == "pivot"


@pytest.fixture(autouse=True)
def _nothing_is_written_beside_the_model(pendulum):
    yield
    assert {one.name for one in pendulum.parent.iterdir()} <= {"pendulum.xml", "joint.xml"}
