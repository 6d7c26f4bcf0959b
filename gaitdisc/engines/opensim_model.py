"""A model of OpenSim, computed in a process of its own: an engine that crashes costs that process only."""

from __future__ import annotations

import os
import pickle
import re
import subprocess
import sys
import weakref
from collections.abc import Mapping
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any
from xml.sax.saxutils import escape, quoteattr

import numpy as np

from gaitdisc.engines.motion import ByHand, Coordinate, Motion, Pushes, Values, new_name, refuse_absent
from gaitdisc.errors import ReadError, SchemaError
from gaitdisc.simulation.expression import Name, Number, Tree, parse
from gaitdisc.simulation.parts import Input, Parameter

ALLOWED = ("sin", "cos", "tan", "tanh", "exp", "sqrt", "min", "max")
ELEMENTS = {"mass": "Body", "optimal_force": "CoordinateActuator", "max_isometric_force": r"\w*Muscle"}  # of any kind
SPRING, LIMIT = "SpringGeneralizedForce", "CoordinateLimitForce"  # all other effects are forces of an expression
NATIVE = {"linear_stiffness": SPRING, "viscous_damping": SPRING, "one_sided_spring": LIMIT}
TRANSITION = 1e-4  # [deg, m], over which a limit's stiffness sets in
FORCES = r"<ForceSet\b.*?</ForceSet>"
BINARY = {"+": "+", "-": "-", "*": "*", "/": "/", "**": "^"}


class OpensimModel:
    """A model of OpenSim, with muscles or without."""

    called = "OpenSim"
    worker = Path(__file__).with_name("opensim_worker.py")
    control_ranges = np.empty((0, 2))  # it clips no control
    pushes: Pushes | None = None

    def __init__(self, path: Path | str) -> None:
        self.path = Path(path)
        self._process: subprocess.Popen[bytes] | None = None
        described = self._query("described")
        if described["others"]:
            raise SchemaError(
                "each actuator must be a muscle, or a coordinate actuator without states",
                f"{self.path.name}: {described['others'][0]!r} has states and is not a muscle",
                "Drive the model by muscles, or by coordinate actuators without states.",
            )
        if described["dependent"]:
            raise SchemaError(
                "every unlocked coordinate must be free, or depend on another one by a CoordinateCouplerConstraint",
                f"{self.path.name}: {described['dependent'][0]!r} depends on another coordinate in a different way",
                "Use a CoordinateCouplerConstraint, remove the dependence, or lock the coordinate.",
            )
        if not described["coordinates"]:
            raise SchemaError(
                "a model must have at least one free coordinate",
                f"{self.path.name}: all are locked ({', '.join(described['locked']) or 'there is none'})",
                "Unlock the measured coordinates.",
            )
        taken: set[str] = set()
        self.coordinates = tuple(
            Coordinate(new_name(name, "coordinate", taken), "rad" if turns else "m", name, low, high)
            for name, turns, low, high in described["coordinates"]
        )
        self._called = {new_name(name, "number", taken): name for name, *_ in described["parameters"]}
        taken |= {each for coordinate in self.coordinates for each in (coordinate.speed, coordinate.port)}
        self.controls = tuple(
            Input(new_name(name, "control", taken), "1", kind) for name, kind in described["controls"]
        )
        self.parameters = tuple(
            Parameter(name, value, unit)
            for name, (_, value, unit, _) in zip(self._called, described["parameters"], strict=True)
        )
        self.fibres: bool = described["muscles"]
        moving = {name for name, value, _, moves in described["parameters"] if value and moves}
        self.offered = tuple(
            name for name, called in self._called.items() if called in moving and not called.endswith("optimal_force")
        )

    def accelerations(self, at: Motion, values: Mapping[str, float], forces: Values | None = None) -> Values:
        """Accelerations (point, coordinate), with other values of some parameters."""
        return self.rates(at, values, forces)[:, : len(self.coordinates)]

    def rates(self, at: Motion, values: Mapping[str, float], forces: Values | None = None) -> Values:
        """Accelerations, then the speeds of the fibres (point, coordinate + fibre)."""
        of_model = {parameter.name: parameter.value for parameter in self.parameters}
        changed = {self._called[name]: value for name, value in values.items() if value != of_model[name]}
        push = np.zeros_like(at.q) if forces is None else forces
        return self._query("rates", at.q, at.v, at.u, at.z, changed, push)

    def as_force(self, _: str) -> tuple[int, str] | None:
        """None: masses, gravity and optimal forces are more."""

    def without_force_limits(self, _: Mapping[str, float]) -> tuple[OpensimModel, list[tuple[int, str]]]:
        """Itself: it limits no actuator's force."""
        return self, []

    def along(self, q: Values, v: Values, controls: Values, rate: float) -> Motion:
        """Return a prescribed motion with the muscles' states, which OpenSim alone integrates from the excitations."""
        return Motion(q, v, *self._query("along", q, v, controls, rate)) if self.fibres else Motion(q, v, controls)

    def near(self, known: Motion, q: Values, v: Values) -> Motion:
        """Return other coordinates and speeds near a known motion; fibres move as their lengths at rest do."""
        if known.z is None:
            return replace(known, q=q, v=v)
        before, after = (self._query("equilibria", each, known.u) for each in (known.q, q))
        return Motion(q, v, known.u, known.z + after - before)

    def run(self, start: Motion, controls: Values, rate: float, forces: Values | None = None) -> Values:
        """Coordinates, then speeds (run, sample, state), by OpenSim's Manager; with pushes by Runge-Kutta, order 4."""
        if self.pushes is None:
            driven = controls if forces is None else np.concatenate([controls, forces], axis=2)
            return self._query("run", start.q, start.v, start.u, start.z, driven, rate)
        pushes, n, h = self.pushes, len(self.coordinates), 1 / rate
        t = np.zeros(len(start.q)) if start.t is None else start.t

        def rates(t: Values, x: Values, u: Values) -> Values:
            forces, state_rates = pushes.at(t, x, u)
            at = Motion(x[:, :n], x[:, n : 2 * n], u)
            return np.hstack([at.v, self.accelerations(at, {}, forces), state_rates])

        states = [pushes.begun(start)]
        for before, after in pairwise(np.swapaxes(controls, 0, 1)):
            x, between = states[-1], (before + after) / 2
            k1 = rates(t, x, before)
            k2 = rates(t + h / 2, x + h / 2 * k1, between)
            k3 = rates(t + h / 2, x + h / 2 * k2, between)
            t = t + h
            states.append(x + h / 6 * (k1 + 2 * k2 + 2 * k3 + rates(t, x + h * k3, after)))
        return np.stack(states, axis=1)[:, :, : 2 * n]

    def text_with_value(self, text: str, name: str, value: float) -> str | None:
        """Text of the model with another value of a parameter."""
        return with_value(text, self._called[name], value)

    def text_with_effect(self, text: str, effect: ByHand) -> str | None:
        """Text of the model with an effect on a coordinate."""
        return with_effect(text, effect, self.coordinates[effect.coordinate])

    def _query(self, question: str, *arguments: Any) -> Any:
        """What the process answers; it is started with the model at the first question, and anew after it died."""
        if self._process is None or self._process.poll() is not None:
            self._process = subprocess.Popen(
                [sys.executable, "-P", str(self.worker), str(self.path)],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.DEVNULL,
                env=os.environ | {"OMP_NUM_THREADS": "1", "PYTHONPATH": os.pathsep.join(sys.path)},
            )
            for ending in (self._process.wait, self._process.kill):  # the last comes first
                weakref.finalize(self, ending)
        assert self._process.stdin is not None and self._process.stdout is not None
        try:
            pickle.dump((question, arguments), self._process.stdin)
            self._process.stdin.flush()
            word, answer = pickle.load(self._process.stdout)
        except (EOFError, BrokenPipeError, pickle.UnpicklingError):
            code = self._process.wait()
            raise ReadError(
                "OpenSim must compute the model to the end",
                f"{self.path.name}: the process ended with exit code {code}",
                "Open the model in OpenSim itself: a model that fails there cannot be simulated here.",
            ) from None
        if word == "absent":
            raise refuse_absent("opensim", ImportError(answer))
        if word == "refused":
            raise ReadError(
                "OpenSim must be able to read and compute the model",
                f"{self.path.name}: {' '.join(answer.split())[:300]}",
                "Correct the part that the message names, or open the model in OpenSim and save it again.",
            )
        return answer


def with_effect(text: str, effect: ByHand, coordinate: Coordinate) -> str | None:
    """Text with a force on a coordinate: OpenSim's own spring, damper or limit, or a force of the effect's expression.

    None where the expression knows more than that coordinate.
    """
    term, kind, forces = effect.term, NATIVE.get(effect.term.name), re.search(FORCES, text, re.DOTALL)
    if kind == SPRING:
        numbers = {"stiffness": -effect.at(1.0, 0.0), "rest_length": 0.0, "viscosity": -effect.at(0.0, 1.0)}
    elif kind == LIMIT:
        low, stiffness, high = effect.slack
        degree = np.rad2deg(1.0) if coordinate.unit == "rad" else 1.0
        numbers = {"upper_limit": high * degree, "lower_limit": low * degree, "transition": TRANSITION, "damping": 0.0}
        numbers |= {f"{side}_stiffness": stiffness / degree for side in ("upper", "lower")}  # it divides by either
    else:
        kind = "ExpressionBasedCoordinateForce"
        numbers = {"expression": _translate(parse(term.term), {coordinate.name: "q", coordinate.speed: "qdot"})}
    if None in numbers.values() or forces is None:
        return None
    words = {"coordinate": coordinate.called} | {word: str(value) for word, value in numbers.items()}
    inside = "".join(f"<{word}>{escape(value)}</{word}>" for word, value in words.items())
    element = f"<{kind} name={quoteattr(f'{term.name}_{coordinate.called}')}>{inside}</{kind}>\n"
    whole = forces[0]
    if "</objects>" not in whole:
        whole = re.sub(r"<objects\s*/>", "<objects>\n</objects>", whole, count=1)
    at = whole.rfind("</objects>")  # the last: the first ones are those of muscles' paths
    return f"{text[: forces.start()]}{whole[:at]}{element}{whole[at:]}{text[forces.end() :]}" if at >= 0 else None


def with_value(text: str, name: str, value: float) -> str | None:
    """Text with a mass, an optimal force or gravity changed; None where the file does not say it."""
    if name == "gravity":
        match = re.search(r"(?<=<gravity>)[^<]*(?=</gravity>)", text)
        if not match:
            return None
        share = float(value / np.linalg.norm([float(word) for word in match[0].split()]))
        return text[: match.start()] + _scale(match[0], share) + text[match.end() :]
    word = next(element for element in ELEMENTS if name.endswith(f"_{element}"))
    kind, part = ELEMENTS[word], name.removesuffix(f"_{word}")
    match = re.search(rf"<({kind}) name={re.escape(quoteattr(part))}>.*?</\1>", text, re.DOTALL)
    number = re.search(rf"(<{word}>)([^<]*)(</{word}>)", match[0]) if match else None
    if match is None or number is None:
        return None
    changed = f"{match[0][: number.start(2)]}{value!r}{match[0][number.end(2) :]}"
    if word == "mass":
        share = value / float(number[2])
        changed = re.sub(r"(?<=<inertia>)[^<]*(?=</inertia>)", lambda old: _scale(old[0], share), changed, count=1)
    return text[: match.start()] + changed + text[match.end() :]


def _scale(numbers: str, share: float) -> str:
    return " ".join(repr(float(word) * share) for word in numbers.split())


def _translate(tree: Tree, names: dict[str, str]) -> str | None:
    """Expression as OpenSim writes it; None where it has a name or a function that OpenSim does not know there."""
    if isinstance(tree, Number):
        return repr(tree.value)
    if isinstance(tree, Name):
        return names.get(tree.name)
    parts = [_translate(argument, names) for argument in tree.arguments]
    if None in parts:
        return None
    symbol, given = tree.symbol, [f"({part})" for part in parts]
    if symbol in BINARY:
        return BINARY[symbol].join(given)
    written = {
        "neg": f"(-1)*{given[0]}",
        "abs": f"sqrt({given[0]}*{given[0]})",
        "sign": f"tanh({given[0]}/0.02)",  # as this package rounds its corner
    }
    return written.get(symbol) or (f"{symbol}({','.join(given)})" if symbol in ALLOWED else None)
