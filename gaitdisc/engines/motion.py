"""Coordinates, motions and forces of a model, whichever engine it is, and how its parts are called."""

from __future__ import annotations

import keyword
import re
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gaitdisc.errors import SchemaError
from gaitdisc.recording.arrays import Values
from gaitdisc.simulation.compiled_simulation import Compiled
from gaitdisc.simulation.expression import RESERVED
from gaitdisc.simulation.parts import Term

SPEED = "_speed"
LONGEST = 40  # characters, which leaves room for what a kind of number is called behind it
FAR = 1000.0  # [rad, m], beyond all that a joint does
BEYOND = 10.0  # [rad, m], where a one-sided spring pulls that pulls at all


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


@dataclass(frozen=True)
class TrackedMotion:
    """Coordinates with their rates, and forces of actuators, at the times that all files have."""

    time: Values  # (sample,) [s]
    q: Values  # (sample, coordinate) [rad, m]
    v: Values
    a: Values
    actuators: tuple[str, ...]  # columns of the forces' file
    forces: Values  # (sample, actuator) [N, N m]
    differentiated: bool  # whether rates come from the angles
    span: tuple[float, float] = (-np.inf, np.inf)  # of the file of angles [s]

    @property
    def rate_hz(self) -> float:
        """Samples a second."""
        return float((len(self.time) - 1) / (self.time[-1] - self.time[0]))


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
        states = np.zeros((len(start.q), len(self.machine.states) - 2 * self.count)) if start.own is None else start.own
        return np.hstack([start.q, start.v, states])


@dataclass(frozen=True)
class ByHand:
    """A term as a function of its port's own coordinate and speed."""

    term: Term
    coordinate: int
    at: Callable[[float, float], float]  # takes a coordinate and a speed, all else being zero

    @property
    def slack(self) -> tuple[float, float, float]:
        """Where a one-sided spring begins to be slack, its stiffness, and where it is slack no more."""
        side = 1.0 if abs(self.at(BEYOND, 0.0)) > 0.0 else -1.0
        far, farther = self.at(side * BEYOND, 0.0), self.at(side * 2 * BEYOND, 0.0)
        stiffness = -(farther - far) / (side * BEYOND)
        threshold = side * BEYOND + far / stiffness if stiffness else np.nan
        return (-FAR, stiffness, threshold) if side > 0 else (threshold, stiffness, FAR)


def refuse_absent(package: str, error: ImportError) -> SchemaError:
    """Say how an engine is installed."""
    return SchemaError(
        f"this kind of model requires the package {package}",
        f"it is not installed ({str(error).splitlines()[0][:120]})",
        f"Install it: pip install 'gaitdisc[{package}]'.",
    )


def new_name(called: str, kind: str, taken: set[str]) -> str:
    """Name for a part of a model, taken from then on: letters, digits and _; of one that is taken, kind behind it.

    >>> new_name("knee-angle r", "joint", set()), new_name("lambda", "joint", set()), new_name("1st", "motor", set())
    ('knee_angle_r', 'lambda_joint', 'motor_1st')
    >>> taken = {"elbow"}
    >>> new_name("elbow", "control", taken), new_name("elbow", "control", taken)
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
    taken.add(free)
    return free
