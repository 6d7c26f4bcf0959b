"""What was found, written into the model's own text, loaded again and compared with the expression by hand."""

import tempfile
import weakref
from collections.abc import Callable
from copy import copy
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import numpy as np

from gaitdisc.engines.engine import Engine, read_model
from gaitdisc.engines.mapping import REPLACED, read_mapping, replace_inputs
from gaitdisc.engines.motion import FAR, ByHand, Motion, Pushes, Values
from gaitdisc.engines.mujoco_model import MujocoModel
from gaitdisc.errors import GaitdiscError, SchemaError
from gaitdisc.simulation.evaluating import Points, evaluate
from gaitdisc.simulation.expression import names, parse
from gaitdisc.simulation.parts import Term
from gaitdisc.simulation.running import compile_simulation
from gaitdisc.simulation.simulation import Simulation

STATES = 50
PROBED, PROBED_HZ = 401, 1000.0  # controls at which a range is compared
SAME = 1e-9  # of the largest acceleration
AT_SPEED = 0.5  # [rad/s], from which friction is compared: an engine's own friction holds at standstill


@dataclass(frozen=True)
class WrittenModel:
    """A model's text with what was found."""

    engine: Engine  # that reads it
    text: str  # the user's own, with insertions; the same where nothing has a native form
    notes: tuple[str, ...]  # what was written in, with its deviation, and what was not
    absent: tuple[str, ...]  # what the engine does not run
    along: tuple[Term, ...]  # forces without a form that act as along the measured motion
    definitions: tuple[tuple[str, str], ...]  # of controls in the mapping, without those that the text says


def write_model(engine: Engine, augmented: Simulation, native: bool = True) -> WrittenModel:
    """Write effects, changed parameters and limits of controls into a model's text, as far as they have a form there.

    What has none acts as a force at each step of the engine's runs, beside fibres or with a delay as along the record.

    native: whether effects and limits are written at all; else each acts so
    """
    text, notes, absent, current = engine.path.read_text(encoding="utf-8"), list[str](), list[str](), engine
    forces, by_hand, values, held = (), (), dict[str, float](), dict[str, float]()
    before = {parameter.name: parameter.value for parameter in engine.parameters}
    added = {state.name for state in augmented.states[2 * len(engine.coordinates) :]}
    prescribed = engine.fibres or any("delay(" in term.term for term in augmented.effects)
    changes: list[tuple[str, Callable[[str], str | None], tuple[Term, ...], dict[str, float]]] = [
        (f"{name} = {value:.6g}", partial(engine.text_with_value, name=name, value=value), (), {name: value})
        for name, value in augmented.values().items()
        if abs(value - before[name]) > SAME * abs(before[name])
    ]
    for term in augmented.effects:
        changes.append((f"{term.name} at {term.place}", partial(_adding, engine, augmented, term), (term,), {}))
    for what, change, more_forces, more_values in changes:
        tried = change(text) if native or not more_forces else None
        wanted = (replace(augmented, definitions=()), (*forces, *more_forces), values | more_values)
        deviation, read = _deviation(engine, tried, *wanted)
        if tried is None or read is None or deviation > SAME:
            outcome = "cannot be expressed in the model's own file"
            if tried is not None:
                outcome = "is refused by the engine in the model's own form"
            if read is not None:
                outcome = f"would change the accelerations by a fraction of {deviation:.1g} in the model's own form"
            used = {name for force in more_forces for name in names(parse(force.term))}
            notes.append(f"{what} {outcome}: only {'discovery.json' if used & added else 'augmented.toml'} contains it")
            runs = not prescribed or not (used & added or getattr(engine, "balls", ()))
            if runs and any(force.kind == "port" for force in more_forces):
                by_hand = (*by_hand, *more_forces)
            elif more_values and hasattr(engine, "with_values"):
                held |= more_values
            else:
                absent.append(what)
            continue
        text, current, forces, values = tried, read, *wanted[1:]
        outcome = "is written into the model; the accelerations agree with those of the expression to a fraction of"
        notes.append(f"{what} {outcome} {deviation:.1g}")
    definitions = augmented.definitions
    for name, expression in definitions:
        outcome = "cannot be expressed in the model's file: only augmented.toml contains it"
        read = _ranged(current, augmented, text, name) if native and isinstance(current, MujocoModel) else None
        if read is not None:
            definitions = tuple(definition for definition in definitions if definition[0] != name)
            text, current = read.path.read_text(encoding="utf-8"), read
            outcome = f"is written into the model as the range of that control{_of_force(augmented, expression)}"
        notes.append(f"{name.removeprefix(REPLACED)}, as {expression}, {outcome}")
    # the controls of a run are as recorded: none follows from the motion
    absent += [name.removeprefix(REPLACED) for name, expression in definitions if _of_force(augmented, expression)]
    if text == engine.path.read_text(encoding="utf-8"):
        notes.append(f"the written model is the same as {engine.path.name}")
    current = getattr(current, "with_values", lambda _: current)(held)
    if by_hand and not prescribed:
        n, current = len(engine.coordinates), copy(engine) if current is engine else current
        acting = {q.speed: [f"({by.term})" for by in by_hand if by.place == q.port] for q in engine.coordinates}
        rates = ((state.name, " + ".join(acting.get(state.name, ())) or "0") for state in augmented.states[: 2 * n])
        lines = (*rates, *augmented.equations[2 * n :])
        parts = augmented.states, augmented.inputs, augmented.parameters
        current.pushes = Pushes(compile_simulation(Simulation("pushes", *parts, equations=lines)), n)
    return WrittenModel(current, text, tuple(notes), tuple(absent), by_hand if prescribed else (), definitions)


def whole_model(path: Path | str) -> tuple[Simulation, Engine]:
    """Mapping of a model, and the engine of the model with all that the mapping says: other numbers, and effects."""
    mapping, engine = read_mapping(path)
    written = write_model(engine, mapping)
    others = (f"{name} = {text}" for name, text in mapping.definitions if not name.startswith(REPLACED))
    absent = (*written.absent, *(f"{force.name} at {force.place}" for force in written.along), *others)
    if absent:
        raise SchemaError(
            f"{engine.called} can run only what the model's own file contains",
            f"{Path(path).name} also has: {'; '.join(absent)}",
            "Remove these from the mapping, or write them into the model by hand.",
        )
    return replace(mapping, definitions=written.definitions), written.engine


def _adding(engine: Engine, augmented: Simulation, term: Term, text: str) -> str | None:
    """Text with a term in the model's own form."""
    number = next((k for k, coordinate in enumerate(engine.coordinates) if coordinate.port == term.place), -1)

    def at(coordinate: float, speed: float) -> float:
        x = np.zeros((1, len(augmented.states)))
        x[0, [number, len(engine.coordinates) + number]] = coordinate, speed
        still = Points(np.zeros(1), x, np.zeros((1, len(augmented.inputs))))
        return float(forces_at(engine, augmented, (term,), still)[0, number])

    return None if number < 0 else engine.text_with_effect(text, ByHand(term, number, at))


def _ranged(engine: MujocoModel, augmented: Simulation, text: str, name: str) -> Engine | None:
    """Model of a text with a control's definition as its range; None where it is not the same."""
    control, controls = name.removeprefix(REPLACED), [control.name for control in engine.controls]
    number, probes = controls.index(control), FAR * np.linspace(-1, 1, PROBED) ** 3  # densest where limits are
    u, still = np.tile(probes[:, None], len(controls)), np.zeros((PROBED, len(engine.coordinates)))
    clipped = replace_inputs(augmented, probes, u, PROBED_HZ)
    (low, high), expression = clipped[[0, -1], number].tolist(), dict(augmented.definitions)[name]
    if control in engine.servos and _of_force(augmented, expression):
        gain, constant, _ = engine.servos[control]
        low, high = sorted((gain * low + constant, gain * high + constant))
        tried = engine.text_with_range(text, number, low, high, "force")
        deviation, read = _deviation(engine, tried, replace(augmented, definitions=((name, expression),)), (), {})
        return read if deviation < SAME else None
    alone = low < high and set(names(parse(expression))) == {control}
    tried = engine.text_with_range(text, number, low, high) if alone else None
    if tried is None:
        return None
    read = load_beside(engine.path, tried)
    acting, wanted = (model.along(still, still, each, PROBED_HZ).u for model, each in ((read, u), (engine, clipped)))
    return read if np.array_equal(acting[:, number], wanted[:, number]) else None


def _of_force(augmented: Simulation, expression: str) -> str:
    """What is limited of a control beside itself, by whether its expression has states."""
    return "" if {state.name for state in augmented.states}.isdisjoint(names(parse(expression))) else "'s force"


def forces_at(engine: Engine, augmented: Simulation, terms: tuple[Term, ...], points: Points) -> Values:
    """Force of terms on each coordinate (point, coordinate); infinite where points of no trial do not determine it."""
    if not points.rate and any("delay(" in term.term or "t" in names(parse(term.term)) for term in terms):
        return np.full((len(points.x), len(engine.coordinates)), np.inf)
    plain = replace(augmented, model="", effects=(), definitions=())
    forces = np.zeros((len(points.x), len(engine.coordinates)))
    for term in terms:
        column = next(k for k, coordinate in enumerate(engine.coordinates) if coordinate.port == term.place)
        forces[:, column] += evaluate(plain, term.term, points)
    return forces


def _deviation(
    engine: Engine, text: str | None, augmented: Simulation, forces: tuple[Term, ...], values: dict[str, float]
) -> tuple[float, Engine | None]:
    """Largest deviation of a written model's accelerations from those by hand, over the largest; and that model."""
    if text is None:
        return np.inf, None
    rng, n = np.random.default_rng(0), len(engine.coordinates)
    low, high = np.transpose([(max(q.low, -1.0), min(q.high, 1.0)) for q in engine.coordinates])
    q = rng.uniform(low, high, (STATES, n))
    v = rng.uniform(AT_SPEED, 4.0, (STATES, n)) * rng.choice([-1, 1], (STATES, n))
    at = Motion(q, v, rng.uniform(0, 1, (STATES, len(engine.controls))))
    x = np.hstack([q, v, np.zeros((STATES, len(augmented.states) - 2 * n))])
    push = forces_at(engine, augmented, forces, Points(np.zeros(STATES), x, 0.0 * at.u))
    if not np.isfinite(push).all():
        return np.inf, None
    try:
        read = load_beside(engine.path, text, getattr(engine, "other", read_model))
    except GaitdiscError:
        return np.inf, None
    driven = replace_inputs(augmented, np.arange(STATES) / PROBED_HZ, at.u, PROBED_HZ, x)
    wanted = engine.accelerations(replace(at, u=driven), values, push)
    some = np.isfinite(wanted).all(axis=1)  # where every muscle has an equilibrium
    off, size = (np.abs(each[some]).max(initial=0.0) for each in (read.accelerations(at, {}) - wanted, wanted))
    return float(off / size) if size and np.isfinite(off) else np.inf, read


def load_beside(path: Path, text: str, read: Callable[[Path], Engine] = read_model) -> Engine:
    """Model of another text, with the files that lie beside the first."""
    folder = tempfile.TemporaryDirectory()
    for other in path.resolve().parent.iterdir():
        if other.name != path.name:
            (Path(folder.name) / other.name).symlink_to(other)
    copy = Path(folder.name) / path.name
    copy.write_text(text, encoding="utf-8")
    engine = read(copy)
    weakref.finalize(engine, folder.cleanup)  # an engine may read its file again
    return engine
