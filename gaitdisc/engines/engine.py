"""Models of MuJoCo or OpenSim from their files: what an engine offers, its classes say."""

from pathlib import Path

from gaitdisc.engines.mujoco_model import MujocoModel
from gaitdisc.engines.opensim_model import OpensimModel
from gaitdisc.errors import ReadError
from gaitdisc.simulation.simulation_file import is_model

Engine = MujocoModel | OpensimModel


def read_model(path: Path | str) -> Engine:
    """Model of an engine's file; the engine is imported with it."""
    path = Path(path)
    if not path.is_file():
        raise ReadError("a model file must exist", f"there is none at {path}", "Check the path.")
    if not is_model(path):
        raise ReadError(
            "a model must be a MuJoCo (.xml) or OpenSim (.osim) file", f"found {path.name}", "Give such a file."
        )
    return OpensimModel(path) if path.suffix.lower() == ".osim" else MujocoModel(path)
