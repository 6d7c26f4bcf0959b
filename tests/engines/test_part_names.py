"""Names of parts, as laboratories call them."""

import pytest

from gaitdisc.engines.engine import part_name
from gaitdisc.simulation.expression import names, parsed


@pytest.mark.parametrize(
    "called", ["knee angle", "hüfte", "lambda", "t", "sin", "2nd", "_x", "a" * 90, "膝", "/jointset/hip_r"]
)
def test_any_name_becomes_one_that_an_expression_knows(called):
    name = part_name(called, "joint")
    assert set(names(parsed(f"2*{name} + 1"))) == {name}
    assert part_name(called, "joint", {name}) != name


def test_a_motor_called_as_its_joint_is_told_apart(tmp_path):
    mujoco_model = pytest.importorskip("gaitdisc.engines.mujoco_model")
    pytest.importorskip("mujoco", reason="MuJoCo is not installed: pip install 'gaitdisc[mujoco]'")
    (tmp_path / "arm.xml").write_text(
        '<mujoco><worldbody><body><joint name="elbow"/><geom size="0.1"/><body><joint name="lift" type="slide"/>'
        '<geom size="0.1"/></body></body></worldbody><actuator><motor name="elbow" joint="elbow"/>'
        '<motor name="lift_force" joint="lift"/><motor joint="lift"/></actuator></mujoco>'
    )
    model = mujoco_model.MujocoModel(tmp_path / "arm.xml")
    assert [one.name for one in model.coordinates] == ["elbow", "lift"]
    assert [one.name for one in model.controls] == ["elbow_control", "lift_force_control", "control_3"]
