"""Numbers of a MuJoCo model that may be changed by name: of bodies, joints, tendons and actuators."""

from collections.abc import Callable, Mapping, Sequence
from copy import copy
from operator import attrgetter
from typing import Any, NamedTuple

import numpy as np

from gaitdisc.engines.ball_joints import WAYS
from gaitdisc.simulation.parts import Input

PASSIVE = {  # numbers of a joint or tendon: their units where it turns and where it slides, and the force of one
    "stiffness": ("N m/rad", "N/m", "{rest!r} - {name}"),
    "damping": ("N m s/rad", "N s/m", "-{speed}"),
    "frictionloss": ("N m", "N", "-sign({speed})"),
}


class Number(NamedTuple):
    """Where a number of the model stands."""

    array: str  # of the engine
    index: Any  # in it
    unit: str
    part: tuple[str, int]  # kind and number of the part that has it


def list_of_parts(mujoco: Any, model: Any, name_parts: Callable[..., list[str]]) -> dict[str, Number]:
    """Every number of bodies, joints and tendons that may be changed by name."""
    places: dict[str, Number] = {}
    if np.any(model.opt.gravity):
        places["gravity"] = Number("opt.gravity", slice(None), "m/s^2", ("body", 0))
    for body, name in enumerate(name_parts("body", model.nbody, set())):
        if model.body_dofnum[model.body_rootid[body]] or model.body_weldid[body]:
            places[f"{name}_mass"] = Number("body_mass", body, "kg", ("body", body))
    joints = [WAYS[kind][0][0] for kind in model.jnt_type]
    along = zip(model.wrap_type[model.tendon_adr], model.wrap_objid[model.tendon_adr], strict=True)
    tendons = [joints[k] if way == int(mujoco.mjtWrap.mjWRAP_JOINT) else "m" for way, k in along]
    axes, taken = np.split(np.arange(model.nv), model.jnt_dofadr[1:]), set[str]()
    for kind, units, prefix in (("joint", joints, "jnt"), ("tendon", tendons, "tendon")):
        for number, (name, unit) in enumerate(zip(name_parts(kind, len(units), taken), units, strict=True)):
            for word, of in PASSIVE.items():
                whole = kind == "joint" and word != "stiffness"  # of each of its axes
                array, index = (f"dof_{word}", axes[number]) if whole else (f"{prefix}_{word}", number)
                places[f"{name}_{word}"] = Number(array, index, of[unit == "m"], (kind, number))
    return places


def list_of_controls(mujoco: Any, model: Any, controls: Sequence[Input]) -> dict[str, Number]:
    """Every muscle's force, and every motor's gear."""
    places: dict[str, Number] = {}
    for number, control in enumerate(controls):
        muscle = model.actuator_gaintype[number] == int(mujoco.mjtGain.mjGAIN_MUSCLE)
        word, array, place, unit = ("force", "gainprm", 2, "N") if muscle else ("gear", "gear", 0, "1")
        places[f"{control.name}_{word}"] = Number(f"actuator_{array}", (number, place), unit, ("actuator", number))
    return places


def read_number(model: Any, name: str, at: Number) -> float:
    """Length of gravity; of several equal numbers the first; of a muscle that has only a scale, what that makes."""
    value = attrgetter(at.array)(model)[at.index]
    if at.unit == "N" and name.endswith("_force") and value < 0:
        value = model.actuator_gainprm[at.index[0], 3] / model.actuator_acc0[at.index[0]]
    return float(np.linalg.norm(value) if name == "gravity" else np.ravel(value)[0])


def with_numbers(model: Any, places: Mapping[str, Number], values: Mapping[str, float]) -> Any:
    """Model with other values of some numbers; itself where none differs."""
    sizes = {name: read_number(model, name, places[name]) for name in values}
    shares = {name: values[name] / (size or 1.0) for name, size in sizes.items() if size != values[name]}
    model = copy(model) if shares else model
    for name, share in shares.items():
        array, index, *_ = places[name]
        numbers = attrgetter(array)(model)
        numbers[index] = numbers[index] * share if name == "gravity" else values[name]
        if name.endswith("_mass"):  # a body of the same shape: its inertia goes with its mass
            model.body_inertia[index] *= share
        if name.endswith("_force"):
            model.actuator_biasprm[index] = values[name]
    return model
