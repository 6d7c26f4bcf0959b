"""What an engine offers: names of parts and ports, which files are models, and what is absent."""

import sys

import pytest

from gaitdisc.engines.engine import read_model
from gaitdisc.engines.motion import new_name
from gaitdisc.errors import GaitdiscError, ReadError
from gaitdisc.simulation.expression import names, parse
from gaitdisc.simulation.simulation_file import is_model


def test_an_ending_says_whether_a_file_is_a_model(tmp_path):
    assert is_model(tmp_path / "leg.xml") and is_model(tmp_path / "arm.OSIM") and not is_model(tmp_path / "leg.toml")


def test_a_missing_file_and_a_missing_engine_are_refused(tmp_path, monkeypatch):
    with pytest.raises(ReadError, match="there is none at"):
        read_model(tmp_path / "leg.xml")
    file = tmp_path / "leg.xml"
    file.write_text("<mujoco/>")
    monkeypatch.setitem(sys.modules, "mujoco", None)
    with pytest.raises(GaitdiscError, match=r"Install it: pip install 'gaitdisc\[mujoco\]'"):
        read_model(file)


@pytest.mark.parametrize(
    "called", ["knee angle", "hüfte", "lambda", "t", "sin", "2nd", "_x", "a" * 90, "膝", "/jointset/hip_r"]
)
def test_any_name_becomes_one_that_an_expression_knows(called):
    name = new_name(called, "joint", set())
    assert set(names(parse(f"2*{name} + 1"))) == {name}
    assert new_name(called, "joint", {name}) != name


def test_a_motor_called_as_its_joint_is_told_apart(tmp_path):
    mujoco_model = pytest.importorskip("gaitdisc.engines.mujoco_model")
    pytest.importorskip("mujoco", reason="MuJoCo is not installed: pip install 'gaitdisc[mujoco]'")
    (tmp_path / "arm.xml").write_text(
        '<mujoco><worldbody><body><joint name="elbow"/><geom size="0.1"/><body><joint name="lift" type="slide"/>'
        '<geom size="0.1"/></body></body></worldbody><actuator><motor name="elbow" joint="elbow"/>'
        '<motor name="lift_force" joint="lift"/><motor joint="lift"/></actuator></mujoco>'
    )
    model = mujoco_model.MujocoModel(tmp_path / "arm.xml")
    assert [(one.name, one.port) for one in model.coordinates] == [("elbow", "elbow_moment"), ("lift", "lift_force")]
    assert [one.name for one in model.controls] == ["elbow_control", "lift_force_control", "control_3"]
