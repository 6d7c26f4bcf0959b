"""A walk that OpenSim tracks: the motion is prescribed, ground and muscle forces come from files, moments are left."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from gaitdisc.engines.motion import Coordinate, Motion, TrackedMotion, Values, new_name
from gaitdisc.engines.opensim_model import OpensimModel
from gaitdisc.engines.opensim_worker import PORT, ROTATIONAL, Ready, answer_questions
from gaitdisc.engines.tracked_mapping import Tracked
from gaitdisc.errors import SchemaError
from gaitdisc.simulation.parts import Parameter

TRANSLATIONAL = 2


class OpensimTracked(OpensimModel):
    """A model of OpenSim whose muscles pull as a file says."""

    worker = Path(__file__)

    def __init__(self, tracked: Tracked) -> None:
        self.path, self._process, self.tracked = tracked.model, None, tracked
        self._query("loaded", *tracked.loads, tracked.actuators)
        described = self._query("described")
        taken: set[str] = set()
        self.coordinates = tuple(
            Coordinate(new_name(name, "coordinate", taken), "rad" if turns else "m", name)
            for name, turns in described["coordinates"]
        )
        if not self.coordinates:
            raise SchemaError(
                "a model must have at least one free coordinate", f"{self.path.name}: all are locked", "Unlock one."
            )
        self._called = {new_name(f"{name}_mass", "number", taken): f"{name}_mass" for name, _ in described["masses"]}
        masses = zip(self._called, described["masses"], strict=True)
        self.parameters = tuple(Parameter(name, mass, "kg") for name, (_, mass) in masses)
        self.controls, self.offered, self.fibres = (), (), False  # muscles pull as recorded, whatever their fibres do
        self.actuators: tuple[str, ...] = tuple(described["actuators"])
        self.base: tuple[int, ...] = tuple(described["base"])  # coordinates of the joint with the ground
        self.vertical: int = described["vertical"]  # the base's upward coordinate, -1 where there is none
        self.paths = frozenset[str](described["paths"])  # muscles, and all else that pulls along a path
        self.mass_kg: float = described["mass_kg"]

    def accelerations(self, at: Motion, values: Mapping[str, float], forces: Values | None = None) -> Values:
        """Accelerations (point, coordinate) without muscles and without the ground, with other masses [kg]."""
        push = np.zeros_like(at.q) if forces is None else forces
        return self._query("accelerations", self._numbers(values), at.q, at.v, push)

    def demanded(self, motion: TrackedMotion, loaded: bool = True, values: Mapping[str, float] | None = None) -> Values:
        """Generalised forces (sample, coordinate) that a motion demands of muscles beside the recorded loads."""
        return self._query("demanded", self._numbers(values), motion.time, motion.q, motion.v, motion.a, loaded)

    def _numbers(self, values: Mapping[str, float] | None) -> dict[str, float]:
        return {self._called[name]: value for name, value in (values or {}).items()}

    def arms(self, time: Values, q: Values, names: tuple[str, ...]) -> Values:
        """Generalised force (sample, name, coordinate) of each actuator's unit force, or unit net moment."""
        return self._query("arms", time, q, list(names))

    def other(self, path: Path) -> OpensimTracked:
        """Another model under the same loads."""
        return OpensimTracked(replace(self.tracked, model=path))


class _Tracked:
    """What is known of a model under prescribed motion; lives in the worker's process."""

    def __init__(self, osim: Any, path: str) -> None:
        self.osim, self.path, self.model = osim, path, osim.Model(path)

    def loaded(self, loads: Path, data: Path, actuators: Path | None, values: Any = ()) -> None:
        osim, model, self.files = self.osim, self.model, (loads, data, actuators)
        if actuators:
            for actuator in osim.ForceSet(str(actuators)):
                model.updForceSet().cloneAndAppend(actuator)
        model.finalizeConnections()
        external = osim.ExternalLoads(str(loads), True)
        external.setDataFileName(str(data))
        model.addModelComponent(external)
        ready = Ready(osim, model, dict(values))
        self.state, self.names, self.actuators, self.placed = ready.state, ready.names, ready.actuators, ready.placed
        self.loads = [external.get(k) for k in range(external.getSize())]
        self.solver = osim.InverseDynamicsSolver(model)
        self.free = {name: model.getCoordinateSet().get(name) for name in [*self.names, *ready.couplers]}
        scalar = osim.ScalarActuator.safeDownCast
        self.given = {name: scalar(model.getActuators().get(name)) for name in self.actuators}
        self.by_hand = [scalar(model.getActuators().get(PORT + name)) for name in self.names]
        for actuator in (*self.given.values(), *self.by_hand):
            actuator.overrideActuation(self.state, True)
            actuator.setOverrideActuation(self.state, 0.0)
            if osim.PathActuator.safeDownCast(actuator) is not None:
                actuator.setAppliesForce(self.state, False)  # pulls come in as moments: no path is followed for nothing
        self.place: dict[str, int] = {}  # where the engine keeps each speed: its order is not the files'
        for name in self.free:
            self._speeds({name: 1.0})
            self.place[name] = int(np.argmax(np.abs(self.state.getU().to_numpy())))
        self._speeds({})

    def _with_values(self, values: dict[str, float]) -> _Tracked:
        other = _Tracked(self.osim, self.path)
        other.loaded(*self.files, values)
        return other

    def _speeds(self, speeds: Mapping[str, float]) -> None:
        for name, coordinate in self.free.items():
            coordinate.setSpeedValue(self.state, float(speeds.get(name, 0.0)))

    def described(self) -> dict[str, Any]:
        osim, model, base = self.osim, self.model, list[str]()
        for joint in model.getJointSet():
            if joint.getParentFrame().findBaseFrame().getName() == "ground" and joint.numCoordinates() > 1:
                base += [joint.get_coordinates(i).getName() for i in range(joint.numCoordinates())]
        zero = np.zeros((1, len(self.names)))
        still = self.demanded({}, [0.0], zero, zero, zero, False)[0]
        weight = model.getTotalMass(self.state) * np.linalg.norm([model.getGravity().get(i) for i in range(3)])
        base_indices = [k for k, name in enumerate(self.names) if name in base]
        sliding = [k for k in base_indices if self.free[self.names[k]].getMotionType() == TRANSLATIONAL]
        upward = [k for k in sliding if abs(still[k]) > 0.9 * weight]
        return {
            "coordinates": [(name, self.free[name].getMotionType() == ROTATIONAL) for name in self.names],
            "actuators": self.actuators,
            "base": base_indices,
            "vertical": upward[0] if upward and weight > 0 else -1,
            "paths": [name for name, force in self.given.items() if osim.PathActuator.safeDownCast(force) is not None],
            "mass_kg": model.getTotalMass(self.state),
            "masses": [(body.getName(), body.getMass()) for body in model.getBodySet() if body.getMass()],
        }

    def _solved(self, a: Mapping[str, float], slopes: Mapping[str, Mapping[str, float]]) -> Any:
        """Inverse dynamics of the free coordinates; what a coupled one needs comes through those that lead it."""
        wanted = self.osim.Vector(self.state.getNU(), 0.0)
        for name, value in a.items():
            wanted.set(self.place[name], float(value))
        for name, leads in slopes.items():
            wanted.set(self.place[name], sum(slope * float(a.get(other, 0.0)) for other, slope in leads.items()))
        whole = self.solver.solve(self.state, wanted).to_numpy()
        moments = np.array([whole[self.place[name]] for name in self.names])
        for name, leads in slopes.items():
            for other, slope in leads.items():
                moments[self.names.index(other)] += slope * whole[self.place[name]]
        return moments

    def demanded(self, values: dict[str, float], time: Any, q: Any, v: Any, a: Any, loaded: bool) -> Any:
        if values:
            return self._with_values(values).demanded({}, time, q, v, a, loaded)
        moments = np.empty_like(q)
        for load in self.loads:
            load.setAppliesForce(self.state, loaded)
        for k, t in enumerate(time):
            self.state.setTime(float(t))
            slopes = self.placed(q[k], v[k])
            moments[k] = self._solved(dict(zip(self.names, a[k], strict=True)), slopes)
        for load in self.loads:
            load.setAppliesForce(self.state, True)
        return moments

    def arms(self, time: Any, q: Any, names: list[str]) -> Any:
        osim, arms = self.osim, np.zeros((len(q), len(names), len(self.names)))
        paths, others, at = [], [], [""] * len(names)
        for number, name in enumerate(names):
            given = self.given.get(name)
            if given is None:  # a net moment, called after its coordinate
                at[number] = name.rpartition("_")[0]
            elif (motor := osim.CoordinateActuator.safeDownCast(given)) is not None:
                at[number] = motor.getCoordinate().getName()
            elif (path := osim.PathActuator.safeDownCast(given)) is not None:
                paths.append((number, path))
            else:
                others.append((number, given))
        for k, t in enumerate(time):
            self.state.setTime(float(t))
            slopes = self.placed(q[k], 0.0 * q[k])
            for column, name in enumerate(self.names):
                with_it = {name: 1.0} | {other: leads[name] for other, leads in slopes.items() if name in leads}
                arms[k, :, column] = [with_it.get(coordinate, 0.0) for coordinate in at]
                self._speeds(with_it)
                self.model.realizeVelocity(self.state)
                for number, path in paths:
                    arms[k, number, column] = -path.getLengtheningSpeed(self.state)
            if others:
                self._speeds({})
                before = self._solved({}, slopes)
                for number, actuator in others:
                    actuator.setOverrideActuation(self.state, 1.0)
                    arms[k, number] = before - self._solved({}, slopes)
                    actuator.setOverrideActuation(self.state, 0.0)
        return arms

    def accelerations(self, values: dict[str, float], q: Any, v: Any, forces: Any) -> Any:
        if values:
            return self._with_values(values).accelerations({}, q, v, forces)
        rates = np.empty_like(q)
        self.state.setTime(0.0)
        for k, force in enumerate(forces):
            self.placed(q[k], v[k])
            for actuator, value in zip(self.by_hand, force, strict=True):
                actuator.setOverrideActuation(self.state, float(value))
            self.model.realizeAcceleration(self.state)
            rates[k] = [self.free[name].getAccelerationValue(self.state) for name in self.names]
        for actuator in self.by_hand:
            actuator.setOverrideActuation(self.state, 0.0)
        return rates


if __name__ == "__main__":
    answer_questions(_Tracked)
