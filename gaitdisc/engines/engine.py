"""What an engine's model offers, whichever engine it is; which files are models, and how their parts are called."""

from __future__ import annotations

import keyword
import re
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from gaitdisc.errors import ReadError, SchemaError
from gaitdisc.simulation.compiled_simulation import Compiled
from gaitdisc.simulation.expression import RESERVED
from gaitdisc.simulation.parts import Input, Parameter, Term

Values = NDArray[np.float64]
SPEED = "_speed"
LONGEST = 40  # characters, which leaves room for what a kind of number is called behind it
ENGINES = {".xml": "mujoco", ".mjcf": "mujoco", ".osim": "opensim"}


@dataclass(frozen=True)
class Coordinate:
    """A free coordinate of a model."""

    name: str  # as it may stand in an expression
    unit: str  # rad or m
    called: str  # its name in the model's file
    low: float = -np.inf  # range that the model gives it [unit]; infinite where it gives none
    high: float = np.inf

    @property
    def speed(self) -> str:
        """Name of its speed."""
        return f"{self.name}{SPEED}"

    @property
    def port(self) -> str:
        """Name of the generalised force on it."""
        return f"{self.name}_{'moment' if self.unit == 'rad' else 'force'}"

    @property
    def force_unit(self) -> str:
        """Unit of that force."""
        return "N m" if self.unit == "rad" else "N"


@dataclass(frozen=True)
class Motion:
    """Where a model is evaluated."""

    q: Values  # (point, coordinate), coordinates and speeds [rad, m; 1/s]
    v: Values
    u: Values  # (point, control), what acts through each: its activation where it has one, else itself
    z: Values | None = None  # (point, fibre) [m], lengths of fibres; in equilibrium where absent
    own: Values | None = None  # (point, state), of pushes; 0 where absent
    t: Values | None = None  # (point,) [s], time of pushes; 0 where absent

    def at(self, points: NDArray[np.intp]) -> Motion:
        """Return some of its points."""
        return Motion(self.q[points], self.v[points], self.u[points], None if self.z is None else self.z[points])

    @staticmethod
    def joined(motions: Sequence[Motion]) -> Motion:
        """Points of several motions as those of one."""
        fields = ("q", "v", "u") if motions[0].z is None else ("q", "v", "u", "z")
        return Motion(*(np.concatenate([getattr(one, name) for one in motions]) for name in fields))


@dataclass(frozen=True)
class Pushes:
    """Forces that act at each step of a run beside those of the model's own file, and the states that they bring."""

    machine: Compiled  # of the coordinates, the speeds, whose rates are the forces, and the states of the pushes
    count: int  # coordinates

    def at(self, t: Values, x: Values, u: Values) -> tuple[Values, Values]:
        """Forces (point, coordinate) and rates of their states at times, all states (point, state) and controls."""
        rates = self.machine.rates(t, x, u)
        return rates[:, self.count : 2 * self.count], rates[:, 2 * self.count :]

    def begun(self, start: Motion) -> Values:
        """All states (point, state) where runs begin."""
        own = np.zeros((len(start.q), len(self.machine.states) - 2 * self.count)) if start.own is None else start.own
        return np.hstack([start.q, start.v, own])


@dataclass(frozen=True)
class ByHand:
    """A term as a function of its port's own coordinate and speed."""

    term: Term
    coordinate: int
    at: Callable[[float, float], float]  # takes a coordinate and a speed, all else being zero


class Engine(Protocol):
    """A model that an engine has read."""

    path: Path
    called: str
    coordinates: tuple[Coordinate, ...]
    controls: tuple[Input, ...]
    parameters: tuple[Parameter, ...]  # all that may be changed by name
    offered: tuple[str, ...]  # those that a new mapping lists
    fibres: bool  # whether muscles have states besides their activation
    pushes: Pushes | None  # what acts in its runs besides

    def accelerations(self, at: Motion, values: Mapping[str, float], forces: Values | None = None) -> Values:
        """Accelerations (point, coordinate) under generalised forces (point, coordinate)."""
        ...

    def as_force(self, parameter: str) -> tuple[int, str] | None:
        """Coordinate on which a parameter's unit is a force, and that force over its names; None where it is more."""
        ...

    def rates(self, at: Motion, values: Mapping[str, float]) -> Values:
        """Accelerations, then the speeds of the fibres (point, coordinate + fibre)."""
        ...

    def along(self, q: Values, v: Values, controls: Values, rate: float) -> Motion:
        """Return a prescribed motion (sample, coordinate) with the muscle states that the engine computes along it."""
        ...

    def near(self, known: Motion, q: Values, v: Values) -> Motion:
        """Return other coordinates and speeds near a known motion, with the fibres that go with them."""
        ...

    def run(self, start: Motion, controls: Values, rate: float) -> Values:
        """Coordinates, then speeds (run, sample, state), by the engine's own integrator."""
        ...

    def text_with_value(self, text: str, name: str, value: float) -> str | None:
        """Text of the model with another value of a parameter; None where the file has no place for it."""
        ...

    def text_with_effect(self, text: str, effect: ByHand) -> str | None:
        """Text of the model with an effect; None where the engine has no form of it."""
        ...


def refuse_absent(package: str, error: ImportError) -> SchemaError:
    """Say how an engine is installed."""
    return SchemaError(
        f"a model of this kind is computed by the package {package}",
        f"it is not installed here ({str(error).splitlines()[0][:120]})",
        f"Install it: pip install 'gaitdisc[{package}]'.",
    )


def part_name(called: str, kind: str, taken: Collection[str] = ()) -> str:
    """Name for a part of a model: letters, digits and _; of one whose name is taken, its kind stands behind it.

    >>> part_name("knee-angle r", "joint"), part_name("lambda", "joint"), part_name("1st", "motor")
    ('knee_angle_r', 'lambda_joint', 'motor_1st')
    >>> part_name("elbow", "control", {"elbow"}), part_name("elbow", "control", {"elbow", "elbow_control"})
    ('elbow_control', 'elbow_control_2')
    """
    name = re.sub(r"[^A-Za-z0-9_]", "_", called)[:LONGEST]
    if not re.match("[A-Za-z]", name):
        name = f"{kind}_{name.lstrip('_')}"
    if keyword.iskeyword(name) or name in RESERVED or name in taken:
        name = f"{name}_{kind}"
    free, number = name, 1
    while free in taken:
        number += 1
        free = f"{name}_{number}"
    return free


def new_name(called: str, kind: str, taken: set[str]) -> str:
    """Name of a part, which is taken from then on."""
    name = part_name(called, kind, taken)
    taken.add(name)
    return name


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
