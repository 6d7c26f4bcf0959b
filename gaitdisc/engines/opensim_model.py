"""A model of OpenSim, computed in a process of its own: an engine that crashes costs that process only."""

from __future__ import annotations

import atexit
import os
import pickle
import re
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gaitdisc.engines.engine import ByHand, Coordinate, Motion, refuse_absent
from gaitdisc.engines.opensim_text import with_effect, with_value
from gaitdisc.errors import ReadError, SchemaError
from gaitdisc.simulation.parts import Input, Parameter

WORKER = Path(__file__).with_name("opensim_worker.py")


class OpensimModel:
    """A model of OpenSim whose coordinates are driven by actuators without muscles' states.

    Examples
    --------
    >>> OpensimModel("arm.osim").coordinates[0].port  # doctest: +SKIP
    'shoulder_moment'
    """

    called = "OpenSim"
    worker = WORKER

    def __init__(self, path: Path | str) -> None:
        self.path = Path(path)
        self._process: subprocess.Popen[bytes] | None = None
        told = self._ask("described")
        self._refuse_what_has_no_place(told)
        self.coordinates = tuple(
            Coordinate(_name(name), "rad" if turns else "m", name, low, high)
            for name, turns, low, high in told["coordinates"]
        )
        self.controls = tuple(Input(_name(name), "1", kind) for name, kind in told["controls"])
        self.parameters = tuple(Parameter(_name(name), value, unit) for name, value, unit in told["parameters"])
        self._called = {_name(name): name for name, _, _ in told["parameters"]}
        self.offered = tuple(
            one.name for one in self.parameters if one.value and not one.name.endswith("optimal_force")
        )

    def accelerations(
        self, at: Motion, values: Mapping[str, float], forces: NDArray[np.float64] | None = None
    ) -> NDArray[np.float64]:
        """Accelerations (point, coordinate), with other values of some parameters."""
        own = {one.name: one.value for one in self.parameters}
        changed = {self._called[name]: value for name, value in values.items() if value != own[name]}
        push = np.zeros_like(at.q) if forces is None else forces
        return self._ask("accelerations", at.q, at.v, at.u, changed, push)

    def as_force(self, parameter: str) -> tuple[int, str] | None:
        """None: masses, gravity and optimal forces are more."""
        del parameter

    def acting(self, controls: NDArray[np.float64], rate: float, q: NDArray[np.float64]) -> NDArray[np.float64]:
        """The controls themselves: these actuators have no state."""
        del rate, q
        return np.array(controls, float)

    def run(self, start: Motion, controls: NDArray[np.float64], rate: float) -> NDArray[np.float64]:
        """Coordinates, then speeds (run, sample, state), by OpenSim's Manager (adaptive steps)."""
        return self._ask("run", start.q, start.v, controls, rate)

    def text_with_value(self, text: str, name: str, value: float) -> str | None:
        """Text of the model with another value of a parameter."""
        return with_value(text, self._called[name], value)

    def text_with_effect(self, text: str, effect: ByHand) -> str | None:
        """Text of the model with an effect on a coordinate."""
        one = self.coordinates[effect.coordinate]
        return with_effect(text, effect.term, (one.name, one.speed), one.called)

    def _ask(self, question: str, *arguments: Any) -> Any:
        """What the process answers; it is started with the model when first asked, and anew after it died."""
        if self._process is None or self._process.poll() is not None:
            self._started()
        assert self._process is not None
        try:
            return self._conversed(question, *arguments)
        except (EOFError, BrokenPipeError, pickle.UnpicklingError):
            code = self._process.wait()
            raise ReadError(
                "OpenSim computes the model to the end",
                f"{self.path.name}: its process ended with exit code {code}",
                "Open the model in OpenSim itself: a model that it cannot simulate there is not simulated here.",
            ) from None

    def _started(self) -> None:
        self._process = subprocess.Popen(
            [sys.executable, "-P", str(self.worker), str(self.path)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            env=os.environ | {"OMP_NUM_THREADS": "1", "PYTHONPATH": os.pathsep.join(sys.path)},
        )
        atexit.register(self._process.kill)

    def _conversed(self, question: str, *arguments: Any) -> Any:
        assert self._process is not None and self._process.stdin is not None and self._process.stdout is not None
        pickle.dump((question, arguments), self._process.stdin)
        self._process.stdin.flush()
        word, answer = pickle.load(self._process.stdout)
        if word == "absent":
            raise refuse_absent("opensim", ImportError(answer))
        if word == "refused":
            raise ReadError(
                "a model is one that OpenSim reads and computes",
                f"{self.path.name}: {' '.join(answer.split())[:300]}",
                "Mend what it names, or open the model in OpenSim and save it in its present version.",
            )
        return answer

    def _refuse_what_has_no_place(self, told: Mapping[str, Any]) -> None:
        if told["muscles"]:
            raise SchemaError(
                "each actuator acts on a coordinate without a state of its own",
                f"{self.path.name}: {told['muscles'][0]!r} and {len(told['muscles']) - 1} more have states (muscles)",
                "Drive the model by coordinate actuators: joint moments in the place of muscles.",
            )
        if told["dependent"]:
            raise SchemaError(
                "every unlocked coordinate of the model is free",
                f"{self.path.name}: {told['dependent'][0]!r} depends on another by a constraint",
                "Take the constraint out, or lock the coordinate.",
            )
        if not told["coordinates"]:
            raise SchemaError(
                "a model has one free coordinate or more",
                f"{self.path.name}: all are locked ({', '.join(told['locked']) or 'there is none'})",
                "Unlock those that were measured.",
            )


def _name(called: str) -> str:
    """Name of a part as it may stand in an expression."""
    return re.sub(r"\W", "_", called)
