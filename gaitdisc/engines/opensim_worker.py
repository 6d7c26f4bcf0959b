"""The process in which OpenSim computes: questions come in by one pipe, answers go out by another."""

from __future__ import annotations

import os
import pickle
import sys
from collections.abc import Callable
from typing import Any, BinaryIO

import numpy as np

PORT = "force_by_hand_on_"
ROTATIONAL = 1
KEPT = 12  # models with other values that are kept ready
ACCURACY = 1e-7


class _Ready:
    """A model with its state: an actuator of unit force stands on every free coordinate."""

    def __init__(self, osim: Any, path: str, values: dict[str, float], profiles: Any = None) -> None:
        self.osim, self.model = osim, osim.Model(path)
        controllers = self.model.getControllerSet()
        for k in range(controllers.getSize()):
            controllers.get(k).setEnabled(False)
        self.actuators = [one.getName() for one in self.model.getActuators()]
        for name, value in values.items():
            _set(self.model, osim, name, value)
        every = self.model.getCoordinateSet()
        names = [every.get(k).getName() for k in range(every.getSize())]
        self.locked = [name for name in names if every.get(name).getDefaultLocked()]
        free = [name for name in names if name not in self.locked]
        for name in free:
            force = osim.CoordinateActuator(name)
            force.setName(PORT + name)
            force.setOptimalForce(1.0)
            self.model.addForce(force)
        if profiles is not None:
            self._driven(*profiles)
        self.state = state = self.model.initSystem()
        every = self.model.getCoordinateSet()
        self.free = [every.get(name) for name in free]
        self.dependent = [one.getName() for one in self.free if one.isDependent(state)]
        self.muscles = [
            one.getName() for one in self.model.getActuators() if one.getNumStateVariables() > 0 and _named(self, one)
        ]

    def _driven(self, time: Any, controls: Any) -> None:
        """Controls along time, linear between samples."""
        osim = self.osim
        controller = osim.PrescribedController()
        for number, name in enumerate(self.actuators):
            line = osim.PiecewiseLinearFunction()
            for t, value in zip(time, controls[:, number], strict=True):
                line.addPoint(float(t), float(value))
            controller.addActuator(self.model.getActuators().get(name))
            controller.prescribeControlForActuator(name, line)
        self.model.addController(controller)

    def placed(self, q: Any, v: Any) -> None:
        for one, position, speed in zip(self.free, q, v, strict=True):
            one.setValue(self.state, float(position), False)
            one.setSpeedValue(self.state, float(speed))

    def acceleration(self, controls: Any) -> list[float]:
        """Accelerations under the controls of the model's own actuators, then forces on the coordinates."""
        given = self.osim.Vector(len(controls), 0.0)
        for k, value in enumerate(controls):
            given.set(k, float(value))
        self.model.realizeVelocity(self.state)
        self.model.setControls(self.state, given)
        self.model.realizeAcceleration(self.state)
        return [one.getAccelerationValue(self.state) for one in self.free]


def _named(ready: _Ready, actuator: Any) -> bool:
    return actuator.getName() in ready.actuators


def _set(model: Any, osim: Any, name: str, value: float) -> None:
    """Put a number into a model."""
    if name == "gravity":
        now = model.getGravity()
        size = np.linalg.norm([now.get(k) for k in range(3)])
        model.setGravity(osim.Vec3(*(float(now.get(k) * value / size) for k in range(3))))
        return
    part, _, word = name.rpartition("_")
    if word == "mass":
        body = model.getBodySet().get(part)
        share, inertia = value / body.getMass(), body.getInertia()
        moments, products = inertia.getMoments(), inertia.getProducts()
        body.setMass(float(value))
        scaled = [float(each.get(k) * share) for each in (moments, products) for k in range(3)]
        body.setInertia(osim.Inertia(*scaled))
        return
    osim.CoordinateActuator.safeDownCast(model.getForceSet().get(name.removesuffix("_optimal_force"))).setOptimalForce(
        float(value)
    )


class _Answers:
    """What is known of a model, question by question."""

    def __init__(self, osim: Any, path: str) -> None:
        self.osim, self.path, self.ready = osim, path, {}

    def with_values(self, values: dict[str, float]) -> _Ready:
        key = tuple(sorted(values.items()))
        if key not in self.ready:
            while len(self.ready) >= KEPT:
                self.ready.pop(next(iter(self.ready)))
            self.ready[key] = _Ready(self.osim, self.path, values)
        return self.ready[key]

    def described(self) -> dict[str, Any]:
        one = self.with_values({})
        model = one.model
        gravity = float(np.linalg.norm([model.getGravity().get(k) for k in range(3)]))
        parameters = [("gravity", gravity, "m/s^2")] if gravity else []
        parameters += [
            (f"{body.getName()}_mass", body.getMass(), "kg") for body in model.getBodySet() if body.getMass()
        ]
        controls = []
        for name in one.actuators:
            actuator = model.getActuators().get(name)
            controls.append((name, actuator.getConcreteClassName()))
            if actuator.getConcreteClassName() == "CoordinateActuator":
                own = self.osim.CoordinateActuator.safeDownCast(actuator)
                parameters.append((f"{name}_optimal_force", own.getOptimalForce(), "N m"))
        coordinates = [(each.getName(), each.getMotionType() == ROTATIONAL, *_range(each)) for each in one.free]
        told = {"coordinates": coordinates, "controls": controls, "parameters": parameters}
        return told | {"muscles": one.muscles, "dependent": one.dependent, "locked": one.locked}

    def accelerations(self, q: Any, v: Any, u: Any, values: dict[str, float], forces: Any) -> Any:
        one = self.with_values(values)
        found = np.empty_like(q)
        for point in range(len(q)):
            one.placed(q[point], v[point])
            found[point] = one.acceleration([*u[point], *forces[point]])
        return found

    def run(self, q: Any, v: Any, controls: Any, rate: float) -> Any:
        found = np.empty((*controls.shape[:2], 2 * q.shape[1]))
        ready: dict[bytes, _Ready] = {}
        time = np.arange(controls.shape[1]) / rate
        for run, driven in enumerate(controls):
            one = ready.get(driven.tobytes()) or _Ready(self.osim, self.path, {}, (time, driven))
            ready[driven.tobytes()] = one
            one.state.setTime(0.0)
            one.placed(q[run], v[run])
            manager = self.osim.Manager(one.model)
            manager.setIntegratorAccuracy(ACCURACY)
            manager.initialize(one.state)
            found[run, 0] = [*q[run], *v[run]]
            for sample in range(1, len(time)):
                state = manager.integrate(float(time[sample]))
                found[run, sample] = [
                    *(each.getValue(state) for each in one.free),
                    *(each.getSpeedValue(state) for each in one.free),
                ]
        return found


def _range(coordinate: Any) -> tuple[float, float]:
    """Range of a coordinate where it is more than a default; a range in OpenSim binds nothing."""
    low, high = coordinate.getRangeMin(), coordinate.getRangeMax()
    return (low, high) if coordinate.getDefaultClamped() else (-np.inf, np.inf)


def serve(questions: BinaryIO, answers: BinaryIO, path: str, answering: Callable[[Any, str], Any] = _Answers) -> None:
    """Answer until nobody asks."""
    answered: Any = None
    while True:
        try:
            question, arguments = pickle.load(questions)
        except EOFError:
            return
        try:
            if answered is None:
                import opensim  # pyright: ignore[reportMissingImports] the extra

                opensim.Logger.setLevelString("Off")
                answered = answering(opensim, path)
            answer = ("answer", getattr(answered, question)(*arguments))
        except ImportError as error:
            answer = ("absent", str(error))
        except Exception as error:  # whatever the engine throws
            answer = ("refused", str(error))
        pickle.dump(answer, answers)
        answers.flush()


def answer_questions(answering: Callable[[Any, str], Any] = _Answers) -> None:
    """Serve the process that started this one."""
    pipe = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # OpenSim prints where it likes
    serve(sys.stdin.buffer, pipe, sys.argv[1], answering)


if __name__ == "__main__":
    answer_questions()
