"""The mapping file of a model: a simulation file whose equations are those of an engine's model beside it."""

from __future__ import annotations

import os
from dataclasses import replace
from pathlib import Path

import numpy as np

from gaitdisc.channel import nearest_word
from gaitdisc.engines.engine import Engine, read_model
from gaitdisc.engines.motion import Motion, Values
from gaitdisc.engines.tracked_mapping import read_tracked
from gaitdisc.errors import SchemaError
from gaitdisc.recording import Finding
from gaitdisc.simulation.evaluating import Points, evaluate
from gaitdisc.simulation.expression import parse, substitute, written
from gaitdisc.simulation.parts import Port, Sensor, State
from gaitdisc.simulation.python_simulation import any_equations
from gaitdisc.simulation.simulation import Simulation
from gaitdisc.simulation.simulation_file import is_model, read_simulation
from gaitdisc.simulation.writing import write_simulation

REPLACED = "replaced_"  # begins the definition that a control is replaced by
MOST = 60  # coordinates and controls: with a port and some numbers each, what a search can distinguish
SAME = 1e-5  # by which a number of the mapping may differ from the model's, as a share: numbers in files are rounded


def draft(engine: Engine, degrees: bool = False) -> Simulation:
    """Mapping of a model: every free coordinate measured in a column of its name, every control another.

    degrees: whether the columns of angles are in degrees
    """
    found = engine.coordinates
    if len(found) + len(engine.controls) > MOST:
        raise SchemaError(
            f"a model must have at most {MOST} free coordinates and controls together",
            f"{engine.path.name} has {len(found)} coordinates and {len(engine.controls)} controls",
            "Lock the joints that your record does not show (MuJoCo: remove these joints).",
        )
    states = [State(one.name, one.unit, f"coordinate {one.called}") for one in found]
    states += [State(one.speed, f"{one.unit}/s") for one in found]
    parameters = [one for one in engine.parameters if one.name in engine.offered]
    ports = [Port(one.port, one.force_unit, f"on {one.called}, in its positive direction") for one in found]
    turned = {one.name for one in found if degrees and one.unit == "rad"}
    scale = repr(float(np.rad2deg(1.0)))
    return Simulation(
        title=f"{engine.path.name}, a model of {engine.called}",
        states=tuple(states),
        inputs=engine.controls,
        parameters=tuple(parameters),
        ports=tuple(ports),
        definitions=(),
        equations=any_equations(states, (*engine.controls, *parameters, *ports)),
        observations=tuple((one.name, f"{scale}*{one.name}" if one.name in turned else one.name) for one in found),
        sensors=tuple(Sensor(one.name, "deg" if one.name in turned else one.unit) for one in found),
        model=engine.path.name,
    )


def write_mapping(engine: Engine, file: Path, degrees: bool = False) -> Simulation:
    """Write the mapping of a model, for a person to correct."""
    model = os.path.relpath(engine.path.resolve(), file.resolve().parent)
    mapping = replace(draft(engine, degrees), model=Path(model).as_posix())
    write_simulation(mapping, file)
    return mapping


def read_mapping(path: Path | str) -> tuple[Simulation, Engine]:
    """Mapping and model: of a mapping file, or of a model with the mapping beside it, or with none.

    path: leg.toml with `model = "leg.xml"`, or leg.xml; without a leg.toml beside it every column has a coordinate's
        name and its unit
    """
    path = Path(path)
    file = path.with_suffix(".toml") if is_model(path) else path
    if file != path and not file.is_file():
        engine = read_model(path)
        return draft(engine), engine
    if read_tracked(file) is not None:
        raise SchemaError(
            "a mapping for a forward simulation must state the model's controls",
            f"{file.name} has [tracked]: its motion is prescribed, and only `gaitdisc discover` reads it",
            "Run `gaitdisc discover`. To simulate, write a mapping without [tracked] for a copy of the model.",
        )
    mapping = read_simulation(file)
    engine = read_model(file.parent / mapping.model)
    check_mapping(mapping, engine)
    return mapping, engine


def check_mapping(mapping: Simulation, engine: Engine) -> None:
    """Refuse a mapping whose names are not the model's."""
    file, free = engine.path.name, engine.coordinates
    known = {
        "coordinate or speed": (mapping.states, (*(one.name for one in free), *(one.speed for one in free))),
        "control": (mapping.inputs, tuple(one.name for one in engine.controls)),
        "parameter": (mapping.parameters, tuple(one.name for one in engine.parameters)),
        "port": (mapping.ports, tuple(one.port for one in free)),
    }
    for kind, (parts, has) in known.items():
        given = tuple(one.name for one in parts)
        for name in (one for one in given if one not in has):
            hint = f"Did you mean {near!r}? " if (near := nearest_word(name, has)) else ""
            raise SchemaError(
                f"each {kind} of a mapping must exist in the model",
                f"{file} has no {name!r}",
                f"{hint}Known: {', '.join(has) or 'none'}.",
            )
        if kind not in ("parameter", "port") and given != has:
            raise SchemaError(
                f"a mapping must list every {kind.partition(' or ')[0]} of the model, in the model's order",
                f"the mapping lists {', '.join(given) or 'none'}; {file} has {', '.join(has) or 'none'}",
                f"Write the mapping again: gaitdisc new {engine.path.with_suffix('.toml').name} --from {file}.",
            )


def other_values(mapping: Simulation, engine: Engine) -> tuple[Finding, ...]:
    """Say which parameters have another value in the mapping than in the model; the mapping's is used."""
    own, found = {one.name: one.value for one in engine.parameters}, []
    for name, value in mapping.values().items():
        if abs(value - own[name]) > SAME * max(abs(own[name]), 1e-9):
            what = f"{name} is {value:g} in the mapping and {own[name]:g} in the model"
            found.append(Finding("note", "value", "model", what, "", name))
    return tuple(found)


def with_input_changed(mapping: Simulation, name: str, expression: str) -> Simulation:
    """Mapping in which a control is replaced by an expression of the recorded one, inside what replaces it already."""
    known, own = dict(mapping.definitions), f"{REPLACED}{name}"
    changed = substitute(parse(known.get(own, name)), {name: parse(expression)}, mapping.signals)
    return replace(mapping, definitions=tuple((known | {own: written(changed)}).items()))


def with_strength(mapping: Simulation, engine: Engine, name: str, gain: float) -> Simulation:
    """Mapping in which a control does so many times as much: by the motor's own number, where that is the same."""
    column, n = [one.name for one in engine.controls].index(name), len(engine.coordinates)
    own = next((one for one in engine.parameters if one.name in (f"{name}_gear", f"{name}_optimal_force")), None)
    if own is not None:
        u = np.full((1, len(engine.controls)), 0.1)
        half = np.where(np.arange(u.shape[1]) == column, 0.5 * u, u)
        at, less = (Motion(np.full((1, n), 0.2), np.full((1, n), 0.3), each) for each in (u, half))
        if np.allclose(engine.accelerations(less, {}), engine.accelerations(at, {own.name: own.value / 2}), 1e-9):
            return mapping.with_parameter(replace(own, value=gain * mapping.values().get(own.name, own.value)))
    return with_input_changed(mapping, name, f"{gain!r}*{name}")


def replace_inputs(mapping: Simulation, time: Values, u: Values, rate: float, x: Values | None = None) -> Values:
    """Controls of one trial (sample, control) with those that the mapping replaces by an expression of the recorded.

    x (sample, state): states that may stand in it; 0 where absent
    """
    plain = replace(mapping, model="", effects=(), definitions=())
    points = Points(time, np.zeros((len(time), len(plain.states))) if x is None else x, u, rate=rate)
    changed, called = u.copy(), [one.name for one in mapping.inputs]
    for name, expression in mapping.definitions:
        changed[:, called.index(name.removeprefix(REPLACED))] = evaluate(plain, expression, points)
    return changed
