"""Which files are models, and what is said where the engine or the file is absent."""

import sys

import pytest

from gaitdisc.engines.engine import Coordinate, is_model, read_model, refuse_unknown
from gaitdisc.errors import GaitdiscError, ReadError


def test_a_slide_has_a_force_and_a_hinge_a_moment(tmp_path):
    assert Coordinate("pelvis_ty", "m", "pelvis_ty").port == "pelvis_ty_force"
    assert Coordinate("knee", "rad", "knee").port == "knee_moment"
    assert is_model(tmp_path / "leg.xml") and is_model(tmp_path / "arm.OSIM") and not is_model(tmp_path / "leg.toml")


def test_a_missing_file_and_a_missing_engine_are_refused(tmp_path, monkeypatch):
    with pytest.raises(ReadError, match="there is none at"):
        read_model(tmp_path / "leg.xml")
    file = tmp_path / "leg.xml"
    file.write_text("<mujoco/>")
    monkeypatch.setitem(sys.modules, "mujoco", None)
    with pytest.raises(GaitdiscError, match=r"Install it: pip install 'gaitdisc\[mujoco\]'"):
        read_model(file)


def test_an_unknown_name_is_told_with_the_nearest():
    said = str(refuse_unknown("control", "hip_moter", ("hip_motor", "knee_motor"), "leg.xml"))
    assert "leg.xml has none called 'hip_moter'" in said and "Did you mean 'hip_motor'?" in said
