"""A free body with a ball joint moves as the same bodies on slides and hinges; its numbers are written or held."""

import numpy as np
import pytest

from gaitdisc.engines.ball_joints import STEEPEST, to_coordinates, to_positions
from gaitdisc.engines.conventions import refuse_other_units
from gaitdisc.engines.engine import read_model
from gaitdisc.engines.mapping import draft
from gaitdisc.engines.motion import Motion
from gaitdisc.engines.written import write_model
from gaitdisc.errors import SchemaError

from .conftest import MUJOCO

HINGES = "".join(f'<joint type="hinge" axis="{axis}" {{0}}/>' for axis in ("0 1 0", "1 0 0", "0 0 1"))
SLIDES = "".join(f'<joint type="slide" axis="{axis}"/>' for axis in ("1 0 0", "0 1 0", "0 0 1"))
SOCKET = 'pos="0.02 0.03 0.1"'
BODY = """<mujoco><option timestep="0.001" gravity="0.5 0 -9.81"/><worldbody><body name="trunk">{free}
<geom type="box" size=".1 .2 .3" mass="2" pos=".05 0 .1"/><body name="thigh" pos="0 0.1 -.3">{ball}
<geom type="box" size=".05 .04 .2" pos=".02 .03 -.2"/><body pos="0 0 -.4">
<joint name="knee" axis="0 1 0" damping="0.1"/><geom type="capsule" fromto="0 0 0 0 0 -.3" size=".03"/></body>
</body></body></worldbody><actuator><motor name="turn" joint="knee" gear="3"/></actuator></mujoco>"""
RNG = np.random.default_rng(3)
AT = Motion(RNG.uniform(-1, 1, (4, 10)), RNG.uniform(-3, 3, (4, 10)), RNG.uniform(-1, 1, (4, 1)))
pytestmark = pytest.mark.skipif(not MUJOCO, reason="MuJoCo is not installed: gaitdisc[mujoco]")


@pytest.fixture
def bodies(tmp_path):
    """Return a free trunk with a thigh on a ball joint, and both on slides and hinges."""
    (tmp_path / "ball.xml").write_text(
        BODY.format(free='<freejoint name="root"/>', ball=f'<joint name="hip" type="ball" {SOCKET}/>')
    )
    (tmp_path / "hinges.xml").write_text(BODY.format(free=SLIDES + HINGES.format(""), ball=HINGES.format(SOCKET)))
    return read_model(tmp_path / "ball.xml"), read_model(tmp_path / "hinges.xml")


def test_angles_and_their_rates_come_back_also_beyond_a_turn():
    q = AT.q + np.array([0, 0, 0, 9, 0, -7, 0, 0, 0, 0])
    positions, velocities = to_positions((3, 6), q, AT.v)
    assert positions.shape == (4, 12) and np.allclose(np.linalg.norm(positions[:, 3:7], axis=1), 1)
    back = to_coordinates((3, 6), positions[:, None], velocities[:, None], q)
    assert np.allclose(back[:, 0], np.hstack([q, AT.v]), atol=1e-12)


def test_it_moves_as_on_slides_and_hinges(bodies):
    ball, hinges = bodies
    forces = RNG.uniform(-2, 2, AT.q.shape)
    for own in (None, forces):
        assert np.allclose(ball.accelerations(AT, {}, own), hinges.accelerations(AT, {}, own), rtol=1e-5, atol=1e-4)
    heavier = [one.accelerations(AT, {"trunk_mass": 3.0}) for one in bodies]
    assert np.allclose(*heavier, rtol=1e-5, atol=1e-4)
    runs = [one.run(AT, np.repeat(AT.u[:, None], 11, axis=1), 100.0) for one in bodies]
    assert np.allclose(runs[0], runs[1], atol=0.05) and np.ptp(runs[0][:, :, :10], axis=1).max() > 0.2


def test_names_and_numbers_of_its_joints(bodies):
    ball, _ = bodies
    assert [one.name for one in ball.coordinates[2:7]] == [
        *("root_along_z", "root_about_y", "root_about_x", "root_about_z", "hip_about_y"),
    ]
    assert [(one.unit, one.port) for one in ball.coordinates[2:4]] == [
        ("m", "root_along_z_force"),
        ("rad", "root_about_y_moment"),
    ]
    assert {"root_damping", "hip_damping", "hip_stiffness"} <= set(ball.offered)
    damped = ball.accelerations(AT, {"hip_damping": 0.4}) - ball.accelerations(AT, {})
    power = (damped[:, 6:9] * AT.v[:, 6:9]).sum(axis=1)
    assert (power < 0).all()


def test_its_numbers_are_written_and_what_has_no_name_is_held(bodies):
    ball, hinges = bodies
    given = {"root_damping": 0.3, "hip_damping": 0.4, "hip_stiffness": 2.0, "thigh_mass": 4.0}
    written = write_model(ball, draft(ball).with_values(given))
    assert not written.absent and all("is written into the model" in note for note in written.notes)
    assert "freejoint" not in written.text and "<inertial" in written.text
    assert np.allclose(written.engine.accelerations(AT, {}), ball.accelerations(AT, given), rtol=1e-9)
    held = write_model(hinges, draft(hinges).with_values({"body_4_mass": 2.0}))
    assert not held.absent and held.text == hinges.path.read_text()
    assert np.allclose(held.engine.accelerations(AT, {}), hinges.accelerations(AT, {"body_4_mass": 2.0}), rtol=1e-12)
    still = np.repeat(AT.u[:, None], 3, axis=1)
    assert np.abs(held.engine.run(AT, still, 100.0) - hinges.run(AT, still, 100.0))[:, 2].max() > 1e-3


def test_an_angle_in_the_middle_near_a_right_angle_is_refused(bodies):
    ball, _ = bodies
    states = np.zeros((1, 5, 20))
    states[0, 2, 7] = -STEEPEST - 0.05
    with pytest.raises(SchemaError, match=r"'hip about x' must stay within 1.4 rad.*'hip_about_x' reaches 1.45 rad"):
        refuse_other_units(draft(ball), ball, None, states)  # pyright: ignore[reportArgumentType]
