"""A model of MuJoCo: accelerations, activations and runs by the engine itself."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import wraps
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from gaitdisc.engines.motion import ByHand, Coordinate, Motion, Pushes, Values, new_name, refuse_absent
from gaitdisc.engines.mujoco_text import with_effect, with_range, with_value
from gaitdisc.errors import ReadError, SchemaError
from gaitdisc.simulation.parts import Input, Parameter

PASSIVE = {  # numbers of a joint or tendon: their units where it turns and where it slides, and the force of one
    "stiffness": ("N m/rad", "N/m", "{rest!r} - {name}"),
    "damping": ("N m s/rad", "N s/m", "-{speed}"),
    "frictionloss": ("N m", "N", "-sign({speed})"),
}


def _size(value: Any) -> float:
    """Length of a vector; a single number as it is, with its sign."""
    return float(np.linalg.norm(value) if np.ndim(value) else value)


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
            import mujoco.rollout  # pyright: ignore[reportMissingImports] the extra
        except ImportError as error:
            raise refuse_absent("mujoco", error) from None
        self.path = Path(path)
        self._mujoco: Any = mujoco
        self.warnings: tuple[str, ...] = ()  # what MuJoCo said of the model and of its runs
        self._model: Any = self._read()
        # a run that leaves every bound would set out again from the model's own pose, as if nothing had happened; and
        # controls are clipped where they come in, so that what each does is known at its limit too
        bit = self._mujoco.mjtDisableBit
        self._model.opt.disableflags |= int(bit.mjDSBL_AUTORESET) | int(bit.mjDSBL_CLAMPCTRL)
        self._data: Any = self._mujoco.MjData(self._model)
        model, joint = self._model, self._mujoco.mjtJoint
        known = int(joint.mjJNT_HINGE), int(joint.mjJNT_SLIDE)
        others = [repr(self._called("joint", k) or k + 1) for k in range(model.njnt) if model.jnt_type[k] not in known]
        if others:
            raise SchemaError(
                "each joint is a hinge or a slide, which has one coordinate and one speed",
                f"{self.path.name}: joint {', '.join(others)} is a ball or free joint and cannot be examined",
                "Write it as hinges and slides one after the other, or weld the body to the world.",
            )
        bound = np.flatnonzero(model.eq_active0)
        if bound.size:
            name = self._called("equality", int(bound[0])) or int(bound[0]) + 1
            raise SchemaError(
                "every coordinate of the model must be free",
                f"{self.path.name}: the equality constraint {name!r} makes one depend on others",
                'Switch it off (active="false"), or take the dependent joint out of the model.',
            )
        if not model.njnt:
            raise SchemaError("a model must have a joint", f"{self.path.name} has none", "Give a body a joint.")
        ranges = np.where(model.jnt_limited[:, None], model.jnt_range, (-np.inf, np.inf)).tolist()
        turns = model.jnt_type == known[0]
        self.coordinates = tuple(
            Coordinate(name, "rad" if turns[k] else "m", self._called("joint", k), *ranges[k])
            for k, name in enumerate(self._names("joint", model.njnt, set()))
        )
        places = self._places_of_parts()
        taken = {"gravity", *places} | {each for one in self.coordinates for each in (one.name, one.speed, one.port)}
        self.controls = tuple(Input(name, "1", "actuator") for name in self._names("control", model.nu, taken))
        self._places = places | self._places_of_controls()
        self.parameters = tuple(
            Parameter(name, _size(array[index]), unit) for name, (array, index, unit, _) in self._places.items()
        )
        self.offered = tuple(
            one.name
            for one, place in zip(self.parameters, self._places.values(), strict=True)
            if (one.value and "gear" not in one.name) or (place.part[0] == "tendon" and "loss" not in one.name)
        )
        limited = model.actuator_ctrllimited[:, None]
        self.control_ranges = np.where(limited, model.actuator_ctrlrange, (-np.inf, np.inf))  # (control, low and high)
        self._stateful = self._model.actuator_actadr >= 0
        self.contacts = 0  # most that any evaluated point had

    @_heard
    def accelerations(self, at: Motion, values: Mapping[str, float], forces: Values | None = None) -> Values:
        """Accelerations (point, coordinate), with other values of some parameters and forces besides."""
        model, data, forward = self._model, self._data, self._mujoco.mj_forward
        kept = self._change_values(values)
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
        if number < 0 or word not in PASSIVE:
            return None
        one, rest = self.coordinates[number], float(self._model.qpos_spring[number])
        return number, PASSIVE[word][2].format(rest=rest, name=one.name, speed=one.speed)

    rates = accelerations  # no fibre has a state of its own

    @_heard
    def along(self, q: Values, v: Values, controls: Values, rate: float) -> Motion:
        """Return a prescribed motion with activations, integrated from equilibrium with the first controls."""
        controls = np.clip(controls, *self.control_ranges.T)
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
        kept, count = model.opt.timestep, model.nq + model.nv
        model.opt.timestep = 1.0 / (rate * steps)
        change = np.diff(controls, axis=1)[:, :, None] / steps
        driven = np.clip(controls[:, :-1, None] + np.arange(steps)[:, None] * change, *self.control_ranges.T)
        driven = driven.reshape(len(controls), -1, model.nu)
        found = np.empty((len(controls), driven.shape[1] + 1, count))
        found[:, 0] = np.hstack([start.q, start.v])
        halted = np.ones(len(controls), bool)
        if self.pushes is None and driven.shape[1]:  # all at once, each halted where MuJoCo warns
            begun = np.array([self._begun(start, run) for run in range(len(controls))])
            states, _ = self._mujoco.rollout.rollout(model, data, begun, driven)
            found[:, 1:] = states[:, :, 1 : 1 + count]
            halted = states[:, -1, 0] < (driven.shape[1] - 0.5) * model.opt.timestep
        for run in np.flatnonzero(halted):
            self._begun(start, int(run))
            pushed = None if self.pushes is None else self.pushes.begun(start)[[run]]
            begins = 0.0 if start.t is None else start.t[run]
            for step, control in enumerate(driven[run]):
                data.ctrl[:] = control
                if self.pushes is not None and pushed is not None:
                    pushed[0, : 2 * model.nv] = *data.qpos, *data.qvel
                    now = np.array([begins + data.time])
                    data.qfrc_applied[:], rates = self.pushes.at(now, pushed, data.ctrl[None])
                    pushed[:, 2 * model.nv :] += model.opt.timestep * rates
                self._mujoco.mj_step(model, data)
                found[run, step + 1] = *data.qpos, *data.qvel
        model.opt.timestep = kept
        return found[:, ::steps]

    def _begun(self, start: Motion, run: int) -> Values:
        """Put the model where a run begins, and give its whole state there."""
        model, data, whole = self._model, self._data, self._mujoco.mjtState.mjSTATE_FULLPHYSICS
        self._mujoco.mj_resetData(model, data)
        data.qpos[:], data.qvel[:] = start.q[run], start.v[run]
        data.act[model.actuator_actadr[self._stateful]] = start.u[run, self._stateful]
        state = np.empty(self._mujoco.mj_stateSize(model, whole))
        self._mujoco.mj_getState(model, data, state, whole)
        return state

    def text_with_value(self, text: str, name: str, value: float) -> str | None:
        """Text of the model with another value of a parameter."""
        kind, number = self._places[name].part
        return with_value(text, name, value, kind, self._called(kind, number))

    def text_with_range(self, text: str, control: int, low: float, high: float) -> str | None:
        """Text of the model with a narrower range of a control."""
        low, high = np.clip((low, high), *self.control_ranges[control]).tolist()
        return with_range(text, self._called("actuator", control), low, high)

    def text_with_effect(self, text: str, effect: ByHand) -> str | None:
        """Text of the model with an effect on a joint."""
        one = self.coordinates[effect.coordinate]
        values = {each.name: each.value for each in self.parameters}
        return with_effect(text, effect, one.called, {word: values[f"{one.name}_{word}"] for word in PASSIVE})

    @_heard
    def _read(self) -> Any:
        try:
            return self._mujoco.MjModel.from_xml_path(str(self.path))
        except ValueError as error:
            raise ReadError(
                f"MuJoCo {self._mujoco.__version__} must be able to read the model",
                f"{self.path.name}: {' '.join(str(error).split())[:300]}",
                "Correct the part that it names: this version may not know it, or a mesh file may be missing.",
            ) from None

    def _hear(self, said: str) -> None:
        sentence = " ".join(said.partition(" Time = ")[0].split())
        self.warnings = tuple(dict.fromkeys((*self.warnings, sentence)))

    def _steps(self, rate: float) -> int:
        """Steps of the integrator for a sample, none longer than the model's own."""
        return max(int(np.ceil(round(1.0 / (rate * self._model.opt.timestep), 6))), 1)

    def _names(self, kind: str, count: int, taken: set[str]) -> list[str]:
        """Names of parts as they may stand in an expression, unlike each other and what is taken."""
        known = "actuator" if kind == "control" else kind
        return [new_name(self._called(known, k) or f"{kind}_{k + 1}", kind, taken) for k in range(count)]

    def _called(self, kind: str, number: int) -> str:
        found = self._mujoco.mj_id2name(self._model, getattr(self._mujoco.mjtObj, f"mjOBJ_{kind.upper()}"), number)
        return found or ""

    def _places_of_parts(self) -> dict[str, _Place]:
        """Every number of bodies, joints and tendons that may be changed by name."""
        model = self._model
        places: dict[str, _Place] = {}
        if np.any(model.opt.gravity):
            places["gravity"] = _Place(model.opt.gravity, slice(None), "m/s^2", ("body", 0))
        for body, name in enumerate(self._names("body", model.nbody, set())):
            if model.body_dofnum[model.body_rootid[body]] or model.body_weldid[body]:
                places[f"{name}_mass"] = _Place(model.body_mass, body, "kg", ("body", body))
        joints = {one.name: one.unit for one in self.coordinates}
        along = zip(model.wrap_type[model.tendon_adr], model.wrap_objid[model.tendon_adr], strict=True)
        units = [[*joints.values()][k] if way == int(self._mujoco.mjtWrap.mjWRAP_JOINT) else "m" for way, k in along]
        tendons = dict(zip(self._names("tendon", model.ntendon, set(joints)), units, strict=True))
        of_joints = (model.jnt_stiffness, model.dof_damping, model.dof_frictionloss)
        of_tendons = (model.tendon_stiffness, model.tendon_damping, model.tendon_frictionloss)
        for kind, parts, arrays in (("joint", joints, of_joints), ("tendon", tendons, of_tendons)):
            for number, (name, unit) in enumerate(parts.items()):
                for (word, of), array in zip(PASSIVE.items(), arrays, strict=True):
                    places[f"{name}_{word}"] = _Place(array, number, of[unit == "m"], (kind, number))
        return places

    def _places_of_controls(self) -> dict[str, _Place]:
        """Every muscle's force, and every motor's gear."""
        model, places = self._model, {}
        for number, one in enumerate(self.controls):
            if model.actuator_gaintype[number] == int(self._mujoco.mjtGain.mjGAIN_MUSCLE):
                if model.actuator_gainprm[number, 2] > 0:
                    places[f"{one.name}_force"] = _Place(model.actuator_gainprm, (number, 2), "N", ("actuator", number))
            else:
                places[f"{one.name}_gear"] = _Place(model.actuator_gear, (number, 0), "1", ("actuator", number))
        return places

    def _change_values(self, values: Mapping[str, float]) -> list[tuple[Any, Any, Any]]:
        """Put other values in, and give what stood there before."""
        model, changes = self._model, []
        for name, value in values.items():
            array, index, *_ = self._places[name]
            before, size = array[index], _size(array[index])
            if size != value:
                changes.append((array, index, before * (value / size) if np.ndim(before) else value))
                if name.endswith("_mass"):  # a body of the same shape: its inertia goes with its mass
                    changes.append((model.body_inertia, index, model.body_inertia[index] * (value / size)))
                if name.endswith("_force"):
                    changes.append((model.actuator_biasprm, index, value))
        kept = [(array, index, np.array(array[index])) for array, index, _ in changes]
        for array, index, after in changes:
            array[index] = after
        if kept:
            self._mujoco.mj_setConst(model, self._data)
        return kept
