"""Which files are models, and what is said where the engine or the file is absent."""

import sys

import pytest

from gaitdisc.engines.engine import is_model, read_model
from gaitdisc.errors import GaitdiscError, ReadError


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
