"""A model of MuJoCo: accelerations, activations and runs by the engine itself."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import wraps
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from gaitdisc.engines.engine import ByHand, Coordinate, Motion, Pushes, Values, new_name, refuse_absent
from gaitdisc.engines.mujoco_text import with_effect, with_value
from gaitdisc.errors import ReadError, SchemaError
from gaitdisc.simulation.parts import Input, Parameter

JOINT_UNITS = {"stiffness": ("N m/rad", "N/m"), "damping": ("N m s/rad", "N s/m"), "frictionloss": ("N m", "N")}


class _Place(NamedTuple):
    """Where a number of the model stands."""

    array: Any  # of the engine
    index: Any  # in it
    unit: str
    part: tuple[str, int]  # kind and number of the part that has it


def _heard(method: Callable[..., Any]) -> Callable[..., Any]:
    """A method that hears MuJoCo's warnings, which it would write into a file of the user's folder."""

    @wraps(method)
    def hearing(self: MujocoModel, *arguments: Any) -> Any:
        before = self._mujoco.get_mju_user_warning()
        self._mujoco.set_mju_user_warning(self._hear)
        try:
            return method(self, *arguments)
        finally:
            self._mujoco.set_mju_user_warning(before)

    return hearing


class MujocoModel:
    """A model of MuJoCo whose joints are hinges and slides."""

    called = "MuJoCo"
    fibres = False
    pushes: Pushes | None = None

    def __init__(self, path: Path | str) -> None:
        try:
            import mujoco  # pyright: ignore[reportMissingImports] the extra
        except ImportError as error:
            raise refuse_absent("mujoco", error) from None
        self.path = Path(path)
        self._mujoco: Any = mujoco
        self.warnings: tuple[str, ...] = ()  # what MuJoCo said of the model and of its runs
        self._model: Any = self._read()
        # a run that leaves every bound would set out again from the model's own pose, as if nothing had happened
        self._model.opt.disableflags |= int(self._mujoco.mjtDisableBit.mjDSBL_AUTORESET)
        self._data: Any = self._mujoco.MjData(self._model)
        model, known = self._model, (int(mujoco.mjtJoint.mjJNT_HINGE), int(mujoco.mjtJoint.mjJNT_SLIDE))
        for number in range(model.njnt):
            if model.jnt_type[number] not in known:
                raise SchemaError(
                    "each joint is a hinge or a slide, which has one coordinate and one speed",
                    f"{self.path.name}: joint {self._called('joint', number) or number + 1!r} is a ball or free joint",
                    "Write it as hinges and slides one after the other, or weld the body to the world.",
                )
        bound = np.flatnonzero(model.eq_active0)
        if bound.size:
            name = self._called("equality", int(bound[0])) or int(bound[0]) + 1
            raise SchemaError(
                "every coordinate of the model is free",
                f"{self.path.name}: the equality constraint {name!r} makes one depend on others",
                'Switch it off (active="false"), or take the dependent joint out of the model.',
            )
        if not model.njnt:
            raise SchemaError("a model has one joint or more", f"{self.path.name} has none", "Give a body a joint.")
        self._names: dict[tuple[str, int], str] = {}
        ranges = np.where(model.jnt_limited[:, None], model.jnt_range, (-np.inf, np.inf)).tolist()
        turns = model.jnt_type == known[0]
        self.coordinates = tuple(
            Coordinate(self._name("joint", k), "rad" if turns[k] else "m", self._called("joint", k), *ranges[k])
            for k in range(model.njnt)
        )
        self.controls = tuple(Input(name, "1", "actuator") for name in self._control_names())
        self._places = self._places_of_parameters()
        self.parameters = tuple(
            Parameter(name, float(np.linalg.norm(array[index])), unit)
            for name, (array, index, unit, _) in self._places.items()
        )
        self.offered = tuple(one.name for one in self.parameters if one.value and "gear" not in one.name)
        ranges = np.where(model.actuator_ctrllimited[:, None], model.actuator_ctrlrange, (-np.inf, np.inf)).tolist()
        self.control_ranges = {k: (low, high) for k, (low, high) in enumerate(ranges) if np.isfinite(high)}
        self._stateful = self._model.actuator_actadr >= 0
        self.contacts = 0  # most that any evaluated point had

    @_heard
    def accelerations(self, at: Motion, values: Mapping[str, float], forces: Values | None = None) -> Values:
        """Accelerations (point, coordinate), with other values of some parameters and forces besides."""
        model, data, forward = self._model, self._data, self._mujoco.mj_forward
        kept = self._changed(values)
        found = np.empty_like(at.q)
        own = self._stateful
        acts = model.actuator_actadr[own]
        for point in range(len(at.q)):
            data.qpos[:] = at.q[point]
            data.qvel[:] = at.v[point]
            data.ctrl[~own] = at.u[point, ~own]
            data.act[acts] = at.u[point, own]
            data.qfrc_applied[:] = 0.0 if forces is None else forces[point]
            data.qacc_warmstart[:] = 0.0
            forward(model, data)
            found[point] = data.qacc
            self.contacts = max(self.contacts, data.ncon)
        data.qfrc_applied[:] = 0.0
        for array, index, before in reversed(kept):
            array[index] = before
        if kept:
            self._mujoco.mj_setConst(model, data)
        return found

    def as_force(self, parameter: str) -> tuple[int, str] | None:
        """Springs, dampers and friction of joints are forces on their coordinates."""
        part, _, word = parameter.rpartition("_")
        number = next((k for k, one in enumerate(self.coordinates) if one.name == part), -1)
        if number < 0 or word not in JOINT_UNITS:
            return None
        one, rest = self.coordinates[number], float(self._model.qpos_spring[number])
        forms = {
            "stiffness": f"{rest!r} - {one.name}",
            "damping": f"-{one.speed}",
            "frictionloss": f"-sign({one.speed})",
        }
        return number, forms[word]

    rates = accelerations  # no fibre has a state of its own

    @_heard
    def along(self, q: Values, v: Values, controls: Values, rate: float) -> Motion:
        """Return a prescribed motion with activations, integrated from equilibrium with the first controls."""
        found = np.array(controls, float)
        if not self._stateful.any():
            return Motion(q, v, found)
        model, data, steps = self._model, self._data, self._steps(rate)
        h, acts = 1.0 / (rate * steps), model.actuator_actadr[self._stateful]
        data.qvel[:] = 0.0
        data.act[acts] = controls[0, self._stateful]
        for sample in range(len(controls)):
            found[sample, self._stateful] = data.act[acts]
            after = controls[min(sample + 1, len(controls) - 1)]
            data.qpos[:] = q[sample]
            for step in range(steps):
                data.ctrl[:] = controls[sample] + (after - controls[sample]) * step / steps
                self._mujoco.mj_forward(model, data)
                data.act[:] += h * data.act_dot
        return Motion(q, v, found)

    def near(self, known: Motion, q: Values, v: Values) -> Motion:
        """Return other coordinates and speeds near a known motion."""
        return replace(known, q=q, v=v)

    @_heard
    def run(self, start: Motion, controls: Values, rate: float) -> Values:
        """Coordinates, then speeds (run, sample, state), by MuJoCo's own integrator; controls are linear in between."""
        model, data, steps = self._model, self._data, self._steps(rate)
        own, kept = self._stateful, model.opt.timestep
        model.opt.timestep = 1.0 / (rate * steps)
        found = np.empty((*controls.shape[:2], model.nq + model.nv))
        for run, driven in enumerate(controls):
            self._mujoco.mj_resetData(model, data)
            data.qpos[:], data.qvel[:] = start.q[run], start.v[run]
            data.act[model.actuator_actadr[own]] = start.u[run, own]
            found[run, 0] = *start.q[run], *start.v[run]
            pushed = None if self.pushes is None else self.pushes.begun(start)[[run]]
            begins = 0.0 if start.t is None else start.t[run]
            for sample in range(len(driven) - 1):
                change = (driven[sample + 1] - driven[sample]) / steps
                for step in range(steps):
                    data.ctrl[:] = driven[sample] + step * change
                    if self.pushes is not None and pushed is not None:
                        pushed[0, : 2 * model.nv] = *data.qpos, *data.qvel
                        now = np.array([begins + data.time])
                        data.qfrc_applied[:], rates = self.pushes.at(now, pushed, data.ctrl[None])
                        pushed[:, 2 * model.nv :] += model.opt.timestep * rates
                    self._mujoco.mj_step(model, data)
                found[run, sample + 1] = *data.qpos, *data.qvel
        model.opt.timestep = kept
        return found

    def text_with_value(self, text: str, name: str, value: float) -> str | None:
        """Text of the model with another value of a parameter."""
        kind, number = self._places[name].part
        return with_value(text, name, value, kind, self._called(kind, number))

    def text_with_effect(self, text: str, effect: ByHand) -> str | None:
        """Text of the model with an effect on a joint."""
        one = self.coordinates[effect.coordinate]
        values = {each.name: each.value for each in self.parameters}
        return with_effect(text, effect, one.called, {word: values[f"{one.name}_{word}"] for word in JOINT_UNITS})

    @_heard
    def _read(self) -> Any:
        try:
            return self._mujoco.MjModel.from_xml_path(str(self.path))
        except ValueError as error:
            raise ReadError(
                f"a model is one that MuJoCo {self._mujoco.__version__} reads",
                f"{self.path.name}: {' '.join(str(error).split())[:300]}",
                "Mend what it names: a part that this version does not know, or a mesh that does not lie beside it.",
            ) from None

    def _hear(self, said: str) -> None:
        sentence = " ".join(said.partition(" Time = ")[0].split())
        self.warnings = tuple(dict.fromkeys((*self.warnings, sentence)))

    def _steps(self, rate: float) -> int:
        """Steps of the integrator for a sample, none longer than the model's own."""
        return max(int(np.ceil(round(1.0 / (rate * self._model.opt.timestep), 6))), 1)

    def _name(self, kind: str, number: int) -> str:
        """Name of a part as it may stand in an expression, unlike those of its kind."""
        if (kind, number) not in self._names:
            taken = {name for (other, _), name in self._names.items() if other == kind}
            called = self._called(kind, number) or f"{kind}_{number + 1}"
            self._names[kind, number] = new_name(called, kind, taken)
        return self._names[kind, number]

    def _control_names(self) -> list[str]:
        """Names of the controls, unlike all others: a motor is often called as the joint that it drives."""
        taken = {"gravity", *(f"{self._name('body', body)}_mass" for body in range(1, self._model.nbody))}
        for one in self.coordinates:
            taken |= {one.name, one.speed, one.port, *(f"{one.name}_{word}" for word in JOINT_UNITS)}
        called = [self._called("actuator", number) or f"control_{number + 1}" for number in range(self._model.nu)]
        return [new_name(one, "control", taken) for one in called]

    def _called(self, kind: str, number: int) -> str:
        found = self._mujoco.mj_id2name(self._model, getattr(self._mujoco.mjtObj, f"mjOBJ_{kind.upper()}"), number)
        return found or ""

    def _places_of_parameters(self) -> dict[str, _Place]:
        """Every number that may be changed by name."""
        model = self._model
        places: dict[str, _Place] = {}
        if np.any(model.opt.gravity):
            places["gravity"] = _Place(model.opt.gravity, slice(None), "m/s^2", ("body", 0))
        for body in range(1, model.nbody):
            if model.body_dofnum[model.body_rootid[body]] or model.body_weldid[body]:
                places[f"{self._name('body', body)}_mass"] = _Place(model.body_mass, body, "kg", ("body", body))
        for number, one in enumerate(self.coordinates):
            slides = int(one.unit == "m")
            dof = model.jnt_dofadr[number]
            for word, array, index in (
                ("stiffness", model.jnt_stiffness, number),
                ("damping", model.dof_damping, dof),
                ("frictionloss", model.dof_frictionloss, dof),
            ):
                places[f"{one.name}_{word}"] = _Place(array, index, JOINT_UNITS[word][slides], ("joint", number))
        for number, one in enumerate(self.controls):
            if model.actuator_gaintype[number] == int(self._mujoco.mjtGain.mjGAIN_MUSCLE):
                if model.actuator_gainprm[number, 2] > 0:
                    places[f"{one.name}_force"] = _Place(model.actuator_gainprm, (number, 2), "N", ("actuator", number))
            else:
                places[f"{one.name}_gear"] = _Place(model.actuator_gear, (number, 0), "1", ("actuator", number))
        return places

    def _changed(self, values: Mapping[str, float]) -> list[tuple[Any, Any, Any]]:
        """Put other values in, and give what stood there before."""
        kept = []
        for name, value in values.items():
            array, index, *_ = self._places[name]
            before = np.array(array[index], float)
            size = float(np.linalg.norm(before))
            if size == value:
                continue
            kept.append((array, index, before))
            array[index] = before * (value / size) if before.ndim else value
            if name.endswith("_mass"):  # a body of the same shape: its inertia goes with its mass
                kept.append((self._model.body_inertia, index, self._model.body_inertia[index].copy()))
                self._model.body_inertia[index] *= value / size
            if name.endswith("_force"):
                kept.append((self._model.actuator_biasprm, index, float(self._model.actuator_biasprm[index])))
                self._model.actuator_biasprm[index] = value
        if kept:
            self._mujoco.mj_setConst(self._model, self._data)
        return kept
