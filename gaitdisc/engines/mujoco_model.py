"""A model of MuJoCo: accelerations, activations and runs by the engine itself."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from copy import copy
from dataclasses import replace
from functools import wraps
from pathlib import Path
from typing import Any

import numpy as np

from gaitdisc.engines.ball_joints import WAYS, to_accelerations, to_coordinates, to_forces, to_positions
from gaitdisc.engines.motion import ByHand, Coordinate, Motion, Pushes, Values, new_name, refuse_absent
from gaitdisc.engines.mujoco_numbers import PASSIVE, list_of_controls, list_of_parts, read_number, with_numbers
from gaitdisc.engines.mujoco_text import with_effect, with_range, with_value
from gaitdisc.errors import ReadError, SchemaError
from gaitdisc.simulation.parts import Input, Parameter


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
    """A model of MuJoCo; a ball or free joint turns by three angles."""

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
        model = self._model = self._read()
        # a run that leaves every bound would set out again from the model's own pose, as if nothing had happened; and
        # controls are clipped where they come in, so that what each does is known at its limit too
        bit = self._mujoco.mjtDisableBit
        model.opt.disableflags |= int(bit.mjDSBL_AUTORESET) | int(bit.mjDSBL_CLAMPCTRL)
        self._data: Any = self._mujoco.MjData(model)
        bound = np.flatnonzero(model.eq_active0)
        if bound.size:
            name = self._called("equality", int(bound[0])) or int(bound[0]) + 1
            raise SchemaError(
                "every coordinate of the model must be free",
                f"{self.path.name}: the equality constraint {name!r} makes a coordinate depend on others",
                'Switch this constraint off (active="false"), or remove the dependent joint from the model.',
            )
        if not model.njnt:
            raise SchemaError("a model must have a joint", f"{self.path.name} has none", "Add a joint.")
        names, kinds, taken = self._names("joint", model.njnt, set()), model.jnt_type, set[str]()
        self.balls = (model.jnt_dofadr + 3 * (kinds == 0))[kinds < 2].tolist()  # first of the three angles of each
        limited = (model.jnt_limited & (kinds > 1))[:, None]  # a ball's limit is a cone
        ranges = np.where(limited, model.jnt_range, (-np.inf, np.inf)).tolist()
        words = [self._called("joint", k) for k in range(model.njnt)]
        self.coordinates = tuple(
            Coordinate(new_name(name + way, "joint", taken), unit, (called or name) + way if way else called, *limits)
            for name, called, kind, limits in zip(names, words, kinds, ranges, strict=True)
            for unit, way in WAYS[kind]
        )
        parts = list_of_parts(mujoco, model, self._names)
        taken = {"gravity", *parts} | {each for q in self.coordinates for each in (q.name, q.speed, q.port)}
        self.controls = tuple(Input(name, "1", "actuator") for name in self._names("control", model.nu, taken))
        self._places = parts | list_of_controls(mujoco, model, self.controls)
        values = {name: read_number(model, name, at) for name, at in self._places.items()}
        self.parameters = tuple(Parameter(name, value, self._places[name].unit) for name, value in values.items())
        at_zero = {("joint", k) for k in np.flatnonzero(kinds < 2)} | {("tendon", k) for k in range(model.ntendon)}
        flags = ((name, values[name] and "gear" not in name, at.part in at_zero) for name, at in self._places.items())
        self.offered = tuple(name for name, there, free in flags if there or (free and "loss" not in name))
        limited = model.actuator_ctrllimited[:, None]
        self.control_ranges = np.where(limited, model.actuator_ctrlrange, (-np.inf, np.inf))  # (control, low and high)
        self._stateful = self._model.actuator_actadr >= 0
        self.contacts = 0  # most that any evaluated point had

    @_heard
    def accelerations(self, at: Motion, values: Mapping[str, float], forces: Values | None = None) -> Values:
        """Accelerations (point, coordinate), with other values of some parameters and forces besides."""
        model, data, forward = self.with_values(values)._model, self._data, self._mujoco.mj_forward
        qacc, stateful = np.empty_like(at.q), self._stateful
        (qpos, qvel), acts = to_positions(self.balls, at.q, at.v), model.actuator_actadr[stateful]
        forces = None if forces is None else to_forces(self.balls, at.q, forces)
        for point in range(len(at.q)):
            data.qpos[:], data.qvel[:] = qpos[point], qvel[point]
            data.ctrl[~stateful], data.act[acts] = at.u[point, ~stateful], at.u[point, stateful]
            data.qfrc_applied[:] = 0.0 if forces is None else forces[point]
            data.qacc_warmstart[:] = 0.0
            forward(model, data)
            qacc[point] = data.qacc
            self.contacts = max(self.contacts, data.ncon)
        data.qfrc_applied[:] = 0.0
        return to_accelerations(self.balls, at.q, at.v, qacc)

    def as_force(self, parameter: str) -> tuple[int, str] | None:
        """Springs, dampers and friction of joints are forces on their coordinates."""
        part, _, word = parameter.rpartition("_")
        number = next((k for k, coordinate in enumerate(self.coordinates) if coordinate.name == part), -1)
        if number < 0 or word not in PASSIVE:
            return None
        joint, rest = self.coordinates[number], self._model.qpos_spring[number + sum(k < number for k in self.balls)]
        return number, PASSIVE[word][2].format(rest=float(rest), name=joint.name, speed=joint.speed)

    rates = accelerations  # no fibre has a state of its own

    @_heard
    def along(self, q: Values, v: Values, controls: Values, rate: float) -> Motion:
        """Return a prescribed motion with activations, integrated from equilibrium with the first controls."""
        controls = np.clip(controls, *self.control_ranges.T)
        acting = np.array(controls, float)
        if not self._stateful.any():
            return Motion(q, v, acting)
        model, data, steps = self._model, self._data, self._steps(rate)
        h, acts = 1.0 / (rate * steps), model.actuator_actadr[self._stateful]
        qpos, _ = to_positions(self.balls, q, v)
        data.qvel[:], data.act[acts] = 0.0, controls[0, self._stateful]
        for sample in range(len(controls)):
            acting[sample, self._stateful] = data.act[acts]
            after = controls[min(sample + 1, len(controls) - 1)]
            data.qpos[:] = qpos[sample]
            for step in range(steps):
                data.ctrl[:] = controls[sample] + (after - controls[sample]) * step / steps
                self._mujoco.mj_forward(model, data)
                data.act[:] += h * data.act_dot
        return Motion(q, v, acting)

    def near(self, known: Motion, q: Values, v: Values) -> Motion:
        """Return other coordinates and speeds near a known motion."""
        return replace(known, q=q, v=v)

    @_heard
    def run(self, start: Motion, controls: Values, rate: float, forces: Values | None = None) -> Values:
        """Coordinates, then speeds (run, sample, state), by MuJoCo itself; controls and forces are linear between."""
        model, data, steps, kinds = self._model, self._data, self._steps(rate), self._mujoco.mjtState
        kept, balls, nu = model.opt.timestep, self.balls, model.nu
        model.opt.timestep = 1.0 / (rate * steps)
        given = controls if forces is None else np.concatenate([controls, forces], axis=2)
        driven = given[:, :-1, None] + np.arange(steps)[:, None] * np.diff(given, axis=1)[:, :, None] / steps
        driven = driven.reshape(len(given), driven.shape[1] * steps, given.shape[2])
        driven[:, :, :nu] = np.clip(driven[:, :, :nu], *self.control_ranges.T)
        reached = np.empty((len(controls), driven.shape[1] + 1, model.nq + model.nv))
        reached[:, 0] = begun = np.hstack(to_positions(balls, start.q, start.v))
        halted = np.ones(len(controls), bool)
        if self.pushes is None and driven.shape[1]:  # all at once, each halted where MuJoCo warns
            whole = np.array([self._begin(*pair) for pair in zip(begun, start.u, strict=True)])
            kind = int(kinds.mjSTATE_CTRL) | (forces is not None) * int(kinds.mjSTATE_QFRC_APPLIED)
            states, _ = self._mujoco.rollout.rollout(model, data, whole, driven, control_spec=kind)
            reached[:, 1:] = states[:, :, 1 : 1 + begun.shape[1]]
            halted = states[:, -1, 0] < (driven.shape[1] - 0.5) * model.opt.timestep
        for run in np.flatnonzero(halted):
            self._begin(begun[run], start.u[run])
            pushed = None if self.pushes is None else self.pushes.begun(start)[[run]]
            begins = 0.0 if start.t is None else start.t[run]
            for step, control in enumerate(driven[run]):
                data.ctrl[:], data.qfrc_applied[:] = control[:nu], 0.0 if forces is None else control[nu:]
                if self.pushes is not None and pushed is not None:
                    q = pushed[:, : model.nv]
                    x = to_coordinates(balls, data.qpos[None, None], data.qvel[None, None], q)
                    pushed[:, : 2 * model.nv] = x[0]
                    acting, rates = self.pushes.at(np.array([begins + data.time]), pushed, data.ctrl[None])
                    data.qfrc_applied[:] = to_forces(balls, q, acting)[0]
                    pushed[:, 2 * model.nv :] += model.opt.timestep * rates
                self._mujoco.mj_step(model, data)
                reached[run, step + 1] = *data.qpos, *data.qvel
        model.opt.timestep = kept
        return to_coordinates(balls, reached[:, ::steps, : model.nq], reached[:, ::steps, model.nq :], start.q)

    def _begin(self, state: Values, acting: Values) -> Values:
        """Put the model into positions and velocities with what acts through each control, and give its whole state."""
        model, data, whole = self._model, self._data, self._mujoco.mjtState.mjSTATE_FULLPHYSICS
        self._mujoco.mj_resetData(model, data)
        data.qpos[:], data.qvel[:] = np.split(state, [model.nq])
        data.act[model.actuator_actadr[self._stateful]] = acting[self._stateful]
        given = np.empty(self._mujoco.mj_stateSize(model, whole))
        self._mujoco.mj_getState(model, data, given, whole)
        return given

    def text_with_value(self, text: str, name: str, value: float) -> str | None:
        """Text of the model with another value of a parameter."""
        (kind, number), model = self._places[name].part, self._model
        share = value / (read_number(model, name, self._places[name]) or 1.0)
        numbers = {"pos": model.body_ipos, "quat": model.body_iquat, "diaginertia": share * model.body_inertia}
        inertia = {word: each[number] for word, each in numbers.items()} if name.endswith("_mass") else {}
        return with_value(text, name, value, kind, self._called(kind, number), inertia)

    @property
    def servos(self) -> dict[str, tuple[float, float, str]]:
        """Of each control that is no force itself: its gain, and its force at 0 and that by its joint's motion."""
        affine = self._mujoco.mjtBias.mjBIAS_AFFINE
        return {name: motor for name, (k, motor) in self._motors.items() if self._model.actuator_biastype[k] == affine}

    def without_force_limits(self, values: Mapping[str, float]) -> tuple[MujocoModel, list[tuple[int, str]]]:
        """Model whose motors have no largest force; the coordinate of each, and the force that its limit takes away."""
        changed, free, taken = self.with_values(values), copy(self), list[tuple[int, str]]()
        model, free._model = changed._model, copy(self._model)
        for name, (k, (gain, constant, moved)) in changed._motors.items():
            if model.actuator_forcelimited[k]:
                (low, high), force = model.actuator_forcerange[k].tolist(), f"{gain!r}*{name} + {constant!r} + {moved}"
                more = f"{float(model.actuator_gear[k, 0])!r}*(min(max({force}, {low!r}), {high!r}) - ({force}))"
                taken.append((int(model.jnt_dofadr[model.actuator_trnid[k, 0]]), more))
                free._model.actuator_forcelimited[k] = False
        return (free if taken else self), taken

    @property
    def _motors(self) -> dict[str, tuple[int, tuple[float, float, str]]]:
        """Of each motor of a hinge or slide, its force being affine: its number; gain, force at 0 and by the motion."""
        model, enums, motors = self._model, self._mujoco, dict[str, tuple[int, tuple[float, float, str]]]()
        for number, control in enumerate(self.controls):
            joint, gear = model.actuator_trnid[number, 0], model.actuator_gear[number, 0]
            on_joint = model.actuator_trntype[number] == enums.mjtTrn.mjTRN_JOINT and model.jnt_type[joint] > 1
            known = model.actuator_biastype[number] <= int(enums.mjtBias.mjBIAS_AFFINE)  # or none
            if on_joint and known and model.actuator_gaintype[number] == enums.mjtGain.mjGAIN_FIXED:
                at = self.coordinates[model.jnt_dofadr[joint]]
                constant, position, speed = model.actuator_biasprm[number, :3].tolist()
                moved = f"{float(gear * position)!r}*{at.name} + {float(gear * speed)!r}*{at.speed}"
                motors[control.name] = number, (float(model.actuator_gainprm[number, 0]), constant, moved)
        return motors

    def text_with_range(self, text: str, control: int, low: float, high: float, of: str = "ctrl") -> str | None:
        """Text of the model with a narrower range of a control, or of its force."""
        if of == "ctrl":
            low, high = np.clip((low, high), *self.control_ranges[control]).tolist()
        return with_range(text, self._called("actuator", control), low, high, of)

    def text_with_effect(self, text: str, effect: ByHand) -> str | None:
        """Text of the model with an effect on a joint."""
        coordinate, values = self.coordinates[effect.coordinate], {each.name: each.value for each in self.parameters}
        passive = {word: values.get(f"{coordinate.name}_{word}", 0.0) for word in PASSIVE}
        return with_effect(text, effect, coordinate.called, passive)

    @_heard
    def _read(self) -> Any:
        try:
            return self._mujoco.MjModel.from_xml_path(str(self.path))
        except ValueError as error:
            raise ReadError(
                f"MuJoCo {self._mujoco.__version__} must be able to read the model",
                f"{self.path.name}: {' '.join(str(error).split())[:300]}",
                "Correct the part that the message names: this version may not know it, or a mesh file may be missing.",
            ) from None

    def _hear(self, warning: str) -> None:
        sentence = " ".join(warning.partition(" Time = ")[0].split())
        self.warnings = tuple(dict.fromkeys((*self.warnings, sentence)))

    def _steps(self, rate: float) -> int:
        """Steps of the integrator for a sample, none longer than the model's own."""
        return max(int(np.ceil(round(1.0 / (rate * self._model.opt.timestep), 6))), 1)

    def _names(self, kind: str, count: int, taken: set[str]) -> list[str]:
        """Names of parts as they may stand in an expression, unlike each other and what is taken."""
        known = "actuator" if kind == "control" else kind
        return [new_name(self._called(known, k) or f"{kind}_{k + 1}", kind, taken) for k in range(count)]

    def _called(self, kind: str, number: int) -> str:
        of = getattr(self._mujoco.mjtObj, f"mjOBJ_{kind.upper()}")
        return self._mujoco.mj_id2name(self._model, of, number) or ""

    def with_values(self, values: Mapping[str, float]) -> MujocoModel:
        """Model with other values of some parameters; itself where none differs."""
        model = with_numbers(self._model, self._places, values)
        if model is self._model:
            return self
        other = copy(self)
        other._model = model
        self._mujoco.mj_setConst(model, self._data)
        return other
