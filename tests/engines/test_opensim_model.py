"""A double pendulum of OpenSim: forces, masses, its own runs, its text, refusals, and a process that dies."""

import io
import os
import pickle
import signal
import sys
from pathlib import Path

import numpy as np
import pytest

from gaitdisc.engines.engine import read_model
from gaitdisc.engines.mapping import draft, with_strength
from gaitdisc.engines.motion import ByHand, Coordinate, Motion
from gaitdisc.engines.opensim_model import with_effect, with_value
from gaitdisc.engines.opensim_worker import serve
from gaitdisc.engines.written import forces_at, write_model
from gaitdisc.errors import GaitdiscError
from gaitdisc.simulation.evaluating import Points
from gaitdisc.simulation.parts import Term

from .conftest import ELBOW, WHEEL

FILE = Path(__file__).parents[2] / "studies" / "systems" / "double_pendulum.osim"
AT = Motion(
    np.array([[0.3, -0.2], [0.1, 0.4]]), np.array([[1.0, -2.0], [0.5, 0.7]]), np.array([[0.1, 0.2], [0.0, -0.1]])
)


@pytest.fixture(scope="module")
def model(needs_opensim):
    return read_model(FILE)


def test_names_and_numbers(model):
    assert [one.name for one in model.coordinates] == ["hip", "knee"]
    assert [one.name for one in model.controls] == ["hip_motor", "knee_motor"]
    values = {one.name: one.value for one in model.parameters}
    assert values["shank_mass"] == pytest.approx(4.6) and values["gravity"] == pytest.approx(9.81)


def test_a_control_is_its_optimal_force_times_a_moment(model):
    """The knee's motor of 15 N m at 0.2 is 3 N m on the knee, and forces add."""
    without = Motion(AT.q, AT.v, AT.u * [1.0, 0.0])
    moments = np.column_stack([np.zeros(2), 15.0 * AT.u[:, 1]])
    assert np.allclose(model.accelerations(AT, {}), model.accelerations(without, {}, moments), rtol=1e-10)


def test_a_heavier_shank_of_the_same_shape_hangs_as_before(model):
    """Of a pendulum alone, mass divides out: only what the thigh and the motors do changes."""
    still = Motion(np.zeros((1, 2)), np.zeros((1, 2)), np.zeros((1, 2)))
    assert np.allclose(model.accelerations(still, {"shank_mass": 6.0}), 0.0, atol=1e-12)
    changed = model.accelerations(AT, {"shank_mass": 6.0})
    assert np.abs(changed - model.accelerations(AT, {})).max() > 0.1
    assert np.allclose(model.accelerations(AT, {"shank_mass": 4.6}), model.accelerations(AT, {}), rtol=1e-9)


def test_its_own_run_starts_with_its_own_acceleration(model):
    start = Motion(AT.q[:1], AT.v[:1], AT.u[:1])
    run = model.run(start, np.repeat(AT.u[None, :1], 3, axis=1), 1000.0)[0]
    assert np.allclose((run[2, 2:] - run[0, 2:]) / 0.002, model.accelerations(start, {}), rtol=0.02)


def test_a_force_in_the_file_is_the_force_by_hand(model, tmp_path):
    path = tmp_path / "augmented.osim"
    path.write_text(with_spring(FILE.read_text(), "-30*max(0, knee - 0.1) - 0.4*sign(knee_speed)"))
    force = -30 * np.maximum(0, AT.q[:, 1] - 0.1) - 0.4 * np.tanh(AT.v[:, 1] / 0.02)
    by_hand = model.accelerations(AT, {}, np.column_stack([np.zeros(2), force]))
    assert np.allclose(read_model(path).accelerations(AT, {}), by_hand, rtol=1e-10)


@pytest.mark.parametrize(
    ("name", "term", "element"),
    [
        ("linear_stiffness", "-8*knee", "<SpringGeneralizedForce"),
        ("viscous_damping", "-0.7*knee_speed", "<viscosity>0.7<"),
        ("one_sided_spring", "-25*max(0, knee - 0.1)", "<CoordinateLimitForce"),
        ("one_sided_spring", "25*max(0, -0.2 - knee)", "<lower_limit>-11.459"),
        ("wrong_parameter", "0.8", "<optimal_force>12.0<"),
    ],
)
def test_opensims_own_forces_run_as_the_expression_does(model, monkeypatch, name, term, element):
    plain, u = draft(model), 0.2 * np.sin(np.arange(80)[None, :, None] * np.array([0.03, 0.05]))
    mapping = plain.with_effect(Term("knee_moment", "port", name, term))
    native = write_model(model, with_strength(plain, model, "knee_motor", 0.8) if term == "0.8" else mapping)
    assert element in native.text and "is written into the model" in native.notes[0]
    start = Motion(np.array([[0.2, -0.3]]), np.zeros((1, 2)), u[:, 0])
    monkeypatch.setattr("gaitdisc.engines.opensim_model.NATIVE", {})
    other = model if term == "0.8" else write_model(model, mapping).engine
    run = other.run(start, u * ([1.0, 0.8] if term == "0.8" else 1.0), 100.0)
    assert np.allclose(native.engine.run(start, u, 100.0), run, atol=1e-6)


def test_a_process_that_dies_is_told_and_replaced(model):
    dead = model._process
    os.kill(dead.pid, signal.SIGKILL)
    dead.wait()
    assert np.isfinite(model.accelerations(AT, {})).all()  # it was started anew
    model._process.stdin.close()
    model._process.poll = lambda: None  # it died between two questions, and nobody knows yet
    with pytest.raises((GaitdiscError, ValueError)):
        model._query("described")
    del model._process.poll
    model._process.kill()
    model._process.wait()  # the next test begins with a process of its own


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (("<Body name", "<Boddy name"), "OpenSim must be able to read"),
        (('<Coordinate name="knee">', '<Coordinate name="knee"><locked>true</locked>'), None),
        (("</OpenSimDocument>", ""), "OpenSim must be able to read"),
    ],
)
def test_what_opensim_cannot_read_is_refused(needs_opensim, tmp_path, change, words):
    text = FILE.read_text()
    assert change[0] in text
    path = tmp_path / "pendulum.osim"
    path.write_text(text.replace(*change))
    if words is None:
        assert [one.name for one in read_model(path).coordinates] == ["hip"]  # a locked one is left out
        return
    with pytest.raises(GaitdiscError, match=words):
        read_model(path)


@pytest.fixture(scope="module")
def arm(elbow):
    return read_model(elbow)


def test_muscles_are_controls_and_a_coordinate_that_follows_is_no_state(arm):
    assert [one.name for one in arm.coordinates] == ["elbow"]
    assert [one.name for one in arm.controls] == ["flexor", "extensor"]
    assert arm.offered == (
        "gravity", "forearm_mass", "wheel_mass", "flexor_max_isometric_force", "extensor_max_isometric_force"
    )  # fmt: skip


def test_what_follows_by_a_belt_turns_with_it(arm):
    """A moment on the elbow turns its inertia about the hinge and, twice as far, the wheel."""
    at = Motion(np.array([[0.2]]), np.array([[1.0]]), np.full((1, 2), 0.1), np.full((1, 2), 0.13))
    push = arm.accelerations(at, {}, np.ones((1, 1))) - arm.accelerations(at, {})
    assert push[0, 0] == pytest.approx(1 / (0.02 + 1.5 * 0.15**2 + 4 * WHEEL), rel=1e-6)


def test_a_muscles_force_is_in_proportion_to_its_largest_and_its_fibres_do_not_know_it(arm):
    at = Motion(np.array([[0.2]]), np.array([[1.0]]), np.full((1, 2), 0.3), np.full((1, 2), 0.115))
    one, two, three = (arm.rates(at, {"flexor_max_isometric_force": each})[0] for each in (300.0, 600.0, 900.0))
    assert three[0] - two[0] == pytest.approx(two[0] - one[0], rel=1e-9)
    assert abs(two[0] - one[0]) > 1.0 and np.allclose(one[1:], three[1:], rtol=1e-9)


def test_muscles_along_a_prescribed_motion_are_those_of_the_run_that_made_it(arm):
    t = np.arange(60) / 100
    u = np.column_stack([0.2 + 0.15 * np.sin(9 * t), 0.2 + 0.1 * np.cos(7 * t)])
    run = arm.run(Motion(np.array([[0.2]]), np.zeros((1, 1)), u[:1]), u[None], 100.0)[0]
    along = arm.along(run[:, :1], run[:, 1:], u, 100.0)
    wanted = np.gradient(run[:, 1], t)[9:-1]  # by then the run has forgotten that it began with fibres at rest
    assert np.abs(arm.accelerations(along, {})[9:-1, 0] - wanted).max() < 0.05 * np.abs(wanted).max()
    assert np.abs(along.u[10:] - u[10:]).max() > 0.005  # an activation is not its excitation


def test_a_force_beside_fibres_acts_as_along_the_motion(arm):
    """Along a run with OpenSim's own spring, the force of its expression is that spring; a product has no form."""
    mapping, t = (
        draft(arm).with_effect(Term("elbow_moment", "port", "linear_stiffness", "-2*elbow")),
        np.arange(40) / 100,
    )
    product = draft(arm).with_effect(Term("elbow_moment", "port", "product_coupling", "-step(elbow_speed)*elbow"))
    assert write_model(arm, product).along == product.effects and not write_model(arm, product).absent
    u = np.column_stack([0.2 + 0.15 * np.sin(9 * t), 0.2 + 0.1 * np.cos(7 * t)])
    start = Motion(np.array([[0.3]]), np.zeros((1, 1)), u[:1])
    run = write_model(arm, mapping).engine.run(start, u[None], 100.0)
    forces = forces_at(arm, mapping, mapping.effects, Points(t, run[0], u, rate=100.0))
    assert np.abs(arm.run(start, u[None], 100.0) - run).max() > 0.05
    assert np.abs(arm.run(start, u[None], 100.0, forces[None]) - run).max() < 1e-3


def test_fibres_near_a_known_motion_move_as_those_at_rest(arm):
    known = Motion(np.array([[0.2]]), np.zeros((1, 1)), np.full((1, 2), 0.2), np.array([[0.130, 0.125]]))
    near = arm.near(known, np.array([[0.25]]), np.zeros((1, 1)))
    moved = near.z - known.z
    assert moved[0, 0] * moved[0, 1] < 0 and np.abs(moved).min() > 3e-4 and np.abs(moved).max() < 0.03 * 0.05 * 1.5


def test_a_weaker_muscle_in_the_file_is_the_value_by_hand(arm, tmp_path):
    path = tmp_path / "weak.osim"
    path.write_text(arm.text_with_value(ELBOW, "flexor_max_isometric_force", 420.0))
    at = Motion(np.array([[0.2]]), np.array([[1.0]]), np.full((1, 2), 0.3))
    found = read_model(path).accelerations(at, {})
    assert np.allclose(found, arm.accelerations(at, {"flexor_max_isometric_force": 420.0}), rtol=1e-12)
    assert abs(found - arm.accelerations(at, {})).max() > 1.0


def test_a_coordinate_bound_otherwise_and_a_state_that_is_no_muscles_are_refused(elbow, tmp_path):
    motor = '<ActivationCoordinateActuator name="motor"><coordinate>elbow</coordinate></ActivationCoordinateActuator>'
    path = tmp_path / "motor.osim"
    path.write_text(ELBOW.replace("</objects></ForceSet>", f"{motor}</objects></ForceSet>"))
    with pytest.raises(GaitdiscError, match=r"'motor'.*states and is no"):
        read_model(path)


TEXT = """<OpenSimDocument Version="40600"><Model name="arm"><gravity>0 -9.81 0</gravity>
<BodySet><objects><Body name="shank"><mass>4.0</mass><inertia>0.1 0.01 0.1 0 0 0</inertia></Body></objects></BodySet>
<ForceSet name="forceset"><objects><ThelenMuscle name="m"><PathPointSet><objects/></PathPointSet>
<max_isometric_force>500</max_isometric_force></ThelenMuscle>
<CoordinateActuator name="knee_motor"><optimal_force>15</optimal_force></CoordinateActuator></objects></ForceSet>
</Model></OpenSimDocument>"""
KNEE = Coordinate("knee", "rad", "knee")


def with_spring(text, term):
    return with_effect(text, ByHand(Term("knee_moment", "port", "spring", term), 1, lambda q, v: 0.0), KNEE)


def inserted(term):
    text = with_spring(TEXT, term)
    return text and text[text.index("<expression>") + 12 : text.index("</expression>")]


def test_a_force_goes_to_the_end_of_the_models_own_forces():
    text = with_spring(TEXT, "-2*knee")
    assert "</CoordinateActuator><ExpressionBasedCoordinateForce" in text
    assert text.replace(text[text.index("<Expr") : text.index("</Expr")], "").count("</objects>") == 2


def test_an_expression_is_written_as_opensim_reads_it():
    assert "max((0.0),((q)-(0.1)))" in inserted("-2*max(0, knee - 0.1)")
    assert inserted("-0.5*sign(knee_speed)").endswith("tanh((qdot)/0.02))")
    assert "sqrt((qdot)*(qdot))" in inserted("-knee_speed*abs(knee_speed)")
    assert "^" in inserted("-3*knee**3")


def test_what_knows_more_than_its_own_coordinate_has_no_form():
    assert inserted("-2*hip") is None
    assert inserted("-2*step(knee)") is None
    assert with_spring("<Model/>", "knee") is None


def test_numbers_of_the_model():
    assert "<mass>5.0</mass><inertia>0.125 0.0125 0.125 0.0" in with_value(TEXT, "shank_mass", 5.0)
    assert "<optimal_force>18.0</optimal_force>" in with_value(TEXT, "knee_motor_optimal_force", 18.0)
    said = with_value(TEXT, "gravity", 8.0)
    vector = [float(word) for word in said.split("<gravity>")[1].split("</gravity>")[0].split()]
    assert np.allclose(vector, [0.0, -8.0, 0.0])
    assert "<max_isometric_force>350.0</" in with_value(TEXT, "m_max_isometric_force", 350.0)
    assert with_value(TEXT, "n_max_isometric_force", 350.0) is None
    assert with_value(TEXT, "foot_mass", 1.0) is None


def test_an_absent_engine_is_an_answer_and_no_crash(monkeypatch):
    monkeypatch.setitem(sys.modules, "opensim", None)
    questions, answers = io.BytesIO(pickle.dumps(("described", ()))), io.BytesIO()
    serve(questions, answers, "arm.osim")
    word, said = pickle.loads(answers.getvalue())
    assert word == "absent" and "opensim" in said
