"""Which files are models, and the engine that reads each."""

from __future__ import annotations

from pathlib import Path

from gaitdisc.engines.engine import Engine
from gaitdisc.errors import ReadError

ENGINES = {".xml": "mujoco", ".mjcf": "mujoco", ".osim": "opensim"}


def is_model(path: Path) -> bool:
    """Whether a file is one that an engine reads."""
    return path.suffix.lower() in ENGINES


def read_model(path: Path | str) -> Engine:
    """Model of an engine's file; the engine is imported here."""
    path = Path(path)
    if not path.is_file():
        raise ReadError("a model is read from its file", f"there is none at {path}", "Check the path.")
    if ENGINES.get(path.suffix.lower()) == "mujoco":
        from gaitdisc.engines.mujoco_model import MujocoModel

        return MujocoModel(path)
    if ENGINES.get(path.suffix.lower()) == "opensim":
        from gaitdisc.engines.opensim_model import OpensimModel

        return OpensimModel(path)
    raise ReadError("a model is a file of MuJoCo (.xml) or OpenSim (.osim)", f"found {path.name}", "Name such a file.")
