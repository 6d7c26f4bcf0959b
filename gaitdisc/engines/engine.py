"""Which files are models, and their models of MuJoCo or OpenSim: what an engine offers, its classes say."""

from __future__ import annotations

from pathlib import Path

from gaitdisc.engines.mujoco_model import MujocoModel
from gaitdisc.engines.opensim_model import OpensimModel
from gaitdisc.errors import ReadError

Engine = MujocoModel | OpensimModel
ENGINES = {".xml": MujocoModel, ".mjcf": MujocoModel, ".osim": OpensimModel}


def is_model(path: Path) -> bool:
    """Whether a file is one that an engine reads."""
    return path.suffix.lower() in ENGINES


def read_model(path: Path | str) -> Engine:
    """Model of an engine's file; the engine is imported with it."""
    path = Path(path)
    if not path.is_file():
        raise ReadError("a model file must exist", f"there is none at {path}", "Check the path.")
    if not is_model(path):
        raise ReadError(
            "a model must be a MuJoCo (.xml) or OpenSim (.osim) file", f"found {path.name}", "Name such a file."
        )
    return ENGINES[path.suffix.lower()](path)
