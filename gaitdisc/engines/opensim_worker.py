"""The process in which OpenSim computes: questions come in by one pipe, answers go out by another."""

import os
import pickle
import sys
from collections.abc import Callable, Iterator
from contextlib import suppress
from functools import lru_cache, partial
from typing import Any, BinaryIO

import numpy as np

PORT = "force_by_hand_on_"
ROTATIONAL, UNBOUND = 1, (-np.inf, np.inf)
KEPT = 12  # models with other values that are kept ready
ACCURACY = {False: 1e-7, True: 1e-5}  # without and with muscles: fibres take short steps
BEFORE, STEPS = 0.1, 10  # [s] in which a prescribed motion sets out from rest, and in how many steps
REST = 0.01  # activation of a muscle at rest, below which those of OpenSim do not go


class Ready:
    """A model with its state: an actuator of unit force stands on every free coordinate."""

    def __init__(
        self, osim: Any, model: Any, values: dict[str, float], profiles: Any = None, motion: Any = None
    ) -> None:
        self.osim, self.model = osim, model
        for controller in model.getControllerSet():  # the controls of the question, and no others, drive it
            controller.setEnabled(False)
        self.actuators = [actuator.getName() for actuator in self.model.getActuators()]
        self.numbers = _list_numbers(model, osim)
        for name, value in values.items():
            self.numbers[name][2](float(value))
        every = model.getCoordinateSet()
        names = [every.get(k).getName() for k in range(every.getSize())]
        self.locked = [name for name in names if every.get(name).getDefaultLocked()]
        self.couplers = couplers(model, osim)
        self.names = free = [name for name in names if name not in self.locked and name not in self.couplers]
        for name in free:
            force = osim.CoordinateActuator(name)
            force.setName(PORT + name)
            force.setOptimalForce(1.0)
            model.addForce(force)
        if profiles is not None:  # controls along time, linear between samples
            controller = osim.PrescribedController()
            lines = [*_follow(osim.PiecewiseLinearFunction, *profiles)]
            ports = [PORT + coordinate for coordinate in free] if len(lines) > len(self.actuators) else []
            for name, line in zip([*self.actuators, *ports], lines, strict=True):
                controller.addActuator(model.getActuators().get(name))
                controller.prescribeControlForActuator(name, line)
            model.addController(controller)
        if motion is not None:  # coordinates along time, smooth between samples
            for name, line in zip(free, _follow(osim.SimmSpline, *motion), strict=True):
                every.get(name).setPrescribedFunction(line)
                every.get(name).setDefaultIsPrescribed(True)
        self.state = state = model.initSystem()
        self.free = [model.getCoordinateSet().get(name) for name in free]
        self.dependent = [coordinate.getName() for coordinate in self.free if coordinate.isDependent(state)]
        self.activations, self.fibres, self.others = self._states_of_muscles()

    def _states_of_muscles(self) -> tuple[dict[int, int], list[int], list[str]]:
        """Place of each actuator's activation, and of the muscles' other states; actuators with yet other states."""
        activations, fibres, others = {}, [], []
        for number, name in enumerate(self.actuators):
            actuator = self.model.getActuators().get(name)
            paths = [actuator.getStateVariableNames().get(k) for k in range(actuator.getNumStateVariables())]
            if paths and self.osim.Muscle.safeDownCast(actuator) is None:
                others.append(name)
                continue
            for path in paths:
                before = self.model.getStateVariableValue(self.state, path)
                self.model.setStateVariableValue(self.state, path, 0.0123)
                place = int(np.argmin(np.abs(self.state.getZ().to_numpy() - 0.0123)))
                self.model.setStateVariableValue(self.state, path, before)
                if path.endswith("/activation"):
                    activations[number] = place
                else:
                    fibres.append(place)
        return activations, fibres, others

    def placed(self, q: Any, v: Any) -> dict[str, dict[str, float]]:
        """Put a posture in; how far each coupled coordinate goes with each that leads it: follower, leader."""
        every, slopes = self.model.getCoordinateSet(), {}
        for coordinate, position, speed in zip(self.free, q, v, strict=True):
            coordinate.setValue(self.state, float(position), False)
            coordinate.setSpeedValue(self.state, float(speed))
        for name, (others, function, scale) in self.couplers.items():
            leading = [every.get(other) for other in others]
            where = self.osim.Vector.createFromMat(np.array([q.getValue(self.state) for q in leading]))
            gains = [scale * function.calcDerivative(self.osim.StdVectorInt([k]), where) for k in range(len(others))]
            every.get(name).setValue(self.state, scale * function.calcValue(where), False)
            speeds = [coordinate.getSpeedValue(self.state) for coordinate in leading]
            every.get(name).setSpeedValue(self.state, float(np.dot(gains, speeds)))
            slopes[name] = dict(zip(others, gains, strict=True))
        return slopes

    def tense(self, q: Any, v: Any, u: Any, z: Any = None) -> None:
        """Put a posture in, activations, and lengths of fibres: without them those of the equilibrium."""
        self.placed(q, v)
        states = self.state.updZ()
        for number, place in self.activations.items():
            states.set(place, max(float(u[number]), REST))
        if z is None and self.fibres:
            self.model.equilibrateMuscles(self.state)
        for place, length in zip(self.fibres, [] if z is None else z, strict=z is not None):
            states.set(place, float(length))

    def rates(self, controls: Any) -> list[float]:
        """Accelerations and fibres' speeds under the controls of the model's own actuators, then of the ports."""
        self.model.realizeVelocity(self.state)
        self.model.setControls(self.state, self.osim.Vector.createFromMat(np.array(controls, float)))
        self.model.realizeAcceleration(self.state)
        rates = [coordinate.getAccelerationValue(self.state) for coordinate in self.free]
        return [*rates, *self.state.getZDot().to_numpy()[self.fibres]] if self.fibres else rates


def _follow(kind: Callable[[], Any], time: Any, values: Any) -> Iterator[Any]:
    """A function of time through the values of each column (sample, column)."""
    for along in values.T:
        line = kind()
        for t, value in zip(time, along, strict=True):
            line.addPoint(float(t), float(value))
        yield line


def couplers(model: Any, osim: Any) -> dict[str, tuple[list[str], Any, float]]:
    """Coordinates that follow others by a function: these others, the function, and its scale."""
    followers = {}
    for constraint in model.getConstraintSet():
        coupler = osim.CoordinateCouplerConstraint.safeDownCast(constraint)
        if coupler is not None and coupler.get_isEnforced():
            names, scale = coupler.getIndependentCoordinateNames(), coupler.getPropertyByName("scale_factor").toString()
            leading = [names.get(number) for number in range(names.getSize())]
            followers[coupler.getDependentCoordinateName()] = leading, coupler.getFunction(), float(scale)
    return followers


def _list_numbers(model: Any, osim: Any) -> dict[str, tuple[float, str, Callable[[float], None]]]:
    """Every number of a model that may be changed by name: its value, its unit, and what puts another in."""
    numbers, gravity = dict[str, tuple[float, str, Callable[[float], None]]](), model.getGravity().to_numpy().copy()
    size = float(np.linalg.norm(gravity))
    if size:
        numbers["gravity"] = size, "m/s^2", lambda value: model.setGravity(osim.Vec3(*(gravity * value / size)))
    for body in model.getBodySet():
        if body.getMass():
            numbers[f"{body.getName()}_mass"] = body.getMass(), "kg", partial(_set_mass, osim, body)
    for actuator in model.getActuators():
        name = actuator.getName()
        motor, muscle = osim.CoordinateActuator.safeDownCast(actuator), osim.Muscle.safeDownCast(actuator)
        if motor is not None:
            numbers[f"{name}_optimal_force"] = motor.getOptimalForce(), "N m", motor.setOptimalForce
        if muscle is not None:
            numbers[f"{name}_max_isometric_force"] = muscle.getMaxIsometricForce(), "N", muscle.setMaxIsometricForce
    return numbers


def _set_mass(osim: Any, body: Any, value: float) -> None:
    """Give a body of the same shape another mass: its inertia is scaled with it."""
    share, inertia = value / body.getMass(), body.getInertia()
    body.setMass(value)
    moments = (inertia.getMoments(), inertia.getProducts())
    body.setInertia(osim.Inertia(*(float(each.get(k) * share) for each in moments for k in range(3))))


class _Answers:
    """What is known of a model, question by question."""

    def __init__(self, osim: Any, path: str) -> None:
        self.osim, self.path = osim, path
        self.ready = lru_cache(KEPT)(lambda *values: self.fresh(dict(values)))

    def with_values(self, values: dict[str, float]) -> Ready:
        return self.ready(*sorted(values.items()))

    def fresh(self, values: dict[str, float], profiles: Any = None, motion: Any = None) -> Ready:
        return Ready(self.osim, self.osim.Model(self.path), values, profiles, motion)

    def described(self) -> dict[str, Any]:
        ready = self.with_values({})
        actuators = ready.model.getActuators()
        controls = [(name, actuators.get(name).getConcreteClassName()) for name in ready.actuators]
        free = ((each, (each.getRangeMin(), each.getRangeMax())) for each in ready.free)
        coordinates = [  # a range that is a default binds nothing
            (each.getName(), each.getMotionType() == ROTATIONAL, *(limits if each.getDefaultClamped() else UNBOUND))
            for each, limits in free
        ]
        numbers = [(name, value, unit, self._moves(name, value)) for name, (value, unit, _) in ready.numbers.items()]
        described = {"coordinates": coordinates, "controls": controls, "parameters": numbers, "locked": ready.locked}
        muscles = bool(ready.activations or ready.fibres)
        return described | {"muscles": muscles, "others": ready.others, "dependent": ready.dependent}

    def _moves(self, name: str, value: float) -> bool:
        """Whether another value changes an acceleration in one posture."""
        rates = []
        for values in ({}, {name: 1.1 * value}):
            ready = self.with_values(values)
            n, controls = len(ready.free), [0.1] * len(ready.actuators)
            ready.tense([each.getDefaultValue() + 0.1 for each in ready.free], [0.5] * n, controls)
            rates.append(ready.rates([*controls, *[0.0] * n])[:n])
        return not np.allclose(*rates, rtol=1e-9, atol=0.0)

    def rates(self, q: Any, v: Any, u: Any, z: Any, values: dict[str, float], forces: Any) -> Any:
        """Accelerations, then fibres' speeds (point, ...); NaN where lengths are sought and no equilibrium exists."""
        ready, without = self.with_values(values), (RuntimeError,) if z is None else ()
        rates = np.full((len(q), q.shape[1] + len(ready.fibres)), np.nan)
        for point in range(len(q)):
            with suppress(*without):
                ready.tense(q[point], v[point], u[point], None if z is None else z[point])
                rates[point] = ready.rates([*u[point], *forces[point]])
        return rates

    def equilibria(self, q: Any, u: Any) -> Any:
        """Lengths of fibres at rest (point, fibre); NaN where no equilibrium exists."""
        ready = self.with_values({})
        lengths = np.full((len(q), len(ready.fibres)), np.nan)
        for point in range(len(q)):
            with suppress(RuntimeError):
                ready.tense(q[point], 0.0 * q[point], u[point])
                lengths[point] = ready.state.getZ().to_numpy()[ready.fibres]
        return lengths

    def along(self, q: Any, v: Any, controls: Any, rate: float) -> Any:
        """Activations in the place of excitations, and lengths of fibres, along a motion that sets out from rest."""
        time, early = np.arange(len(q)) / rate, BEFORE * np.arange(-STEPS, 0)[:, None] / STEPS
        whole = np.concatenate([q[0] + v[0] * (early + early**2 / (2 * BEFORE)), q])
        motion = np.concatenate([early[:, 0], time]), whole
        ready = self.fresh({}, (time, controls), motion)
        ready.state.setTime(-BEFORE)
        ready.tense(whole[0], 0.0 * whole[0], controls[0])
        manager = self.osim.Manager(ready.model)
        manager.setIntegratorAccuracy(ACCURACY[True])
        manager.initialize(ready.state)
        states = np.array([manager.integrate(float(t)).getZ().to_numpy().copy() for t in time])
        u = np.array(controls, float)
        for number, place in ready.activations.items():
            u[:, number] = states[:, place]
        return u, states[:, ready.fibres]

    def run(self, q: Any, v: Any, u: Any, z: Any, controls: Any, rate: float) -> Any:
        states = np.full((*controls.shape[:2], 2 * q.shape[1]), np.inf)
        ready, time = dict[bytes, Ready](), np.arange(controls.shape[1]) / rate
        for run, driven in enumerate(controls):
            if z is not None and np.isnan(z[run]).any():  # muscles without an equilibrium: no run begins there
                continue
            prepared = ready.get(driven.tobytes()) or self.fresh({}, (time, driven))
            ready[driven.tobytes()] = prepared
            prepared.state.setTime(0.0)
            prepared.tense(q[run], v[run], u[run], None if z is None else z[run])
            manager = self.osim.Manager(prepared.model)
            manager.setIntegratorAccuracy(ACCURACY[bool(prepared.activations)])
            manager.initialize(prepared.state)
            states[run, 0] = [*q[run], *v[run]]
            for sample in range(1, len(time)):
                state = manager.integrate(float(time[sample]))
                reached = [(each.getValue(state), each.getSpeedValue(state)) for each in prepared.free]
                states[run, sample] = np.transpose(reached).ravel()
        return states


def serve(questions: BinaryIO, answers: BinaryIO, path: str, answering: Callable[[Any, str], Any] = _Answers) -> None:
    """Answer until no question comes."""
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
