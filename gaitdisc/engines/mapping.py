"""The mapping file of a model: a simulation file whose equations are those of an engine's model beside it."""

import os
from dataclasses import replace
from pathlib import Path

import numpy as np

from gaitdisc.channel import did_you_mean
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
    """Mapping of a model: each free coordinate in a column of its name (`degrees`: angles in deg), each control."""
    free = engine.coordinates
    if len(free) + len(engine.controls) > MOST:
        raise SchemaError(
            f"a model must have at most {MOST} free coordinates and controls together",
            f"{engine.path.name} has {len(free)} coordinates and {len(engine.controls)} controls",
            "Lock the joints that your record does not show (MuJoCo: remove these joints).",
        )
    states = [State(coordinate.name, coordinate.unit, f"coordinate {coordinate.called}") for coordinate in free]
    states += [State(coordinate.speed, f"{coordinate.unit}/s") for coordinate in free]
    parameters = [parameter for parameter in engine.parameters if parameter.name in engine.offered]
    ports = [Port(q.port, q.force_unit, f"on {q.called}, in its positive direction") for q in free]
    scale, turned = repr(float(np.rad2deg(1.0))), {q.name for q in free if degrees and q.unit == "rad"}
    return Simulation(
        title=f"{engine.path.name}, a model of {engine.called}",
        states=tuple(states),
        inputs=engine.controls,
        parameters=tuple(parameters),
        ports=tuple(ports),
        definitions=(),
        equations=any_equations(states, (*engine.controls, *parameters, *ports)),
        observations=tuple((q.name, f"{scale}*{q.name}" if q.name in turned else q.name) for q in free),
        sensors=tuple(Sensor(q.name, "deg" if q.name in turned else q.unit) for q in free),
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
        "coordinate or speed": (mapping.states, (*(q.name for q in free), *(q.speed for q in free))),
        "control": (mapping.inputs, tuple(control.name for control in engine.controls)),
        "parameter": (mapping.parameters, tuple(parameter.name for parameter in engine.parameters)),
        "port": (mapping.ports, tuple(coordinate.port for coordinate in free)),
    }
    for kind, (parts, has) in known.items():
        given = tuple(part.name for part in parts)
        if absent := [name for name in given if name not in has]:
            raise SchemaError(
                f"each {kind} of a mapping must exist in the model",
                f"{file} has no {absent[0]!r}",
                f"{did_you_mean(absent[0], has)} Known: {', '.join(has) or 'none'}.".lstrip(),
            )
        if kind not in ("parameter", "port") and given != has:
            raise SchemaError(
                f"a mapping must list every {kind.partition(' or ')[0]} of the model, in the model's order",
                f"the mapping lists {', '.join(given) or 'none'}; {file} has {', '.join(has) or 'none'}",
                f"Write the mapping again: gaitdisc new {engine.path.with_suffix('.toml').name} --from {file}.",
            )


def other_values(mapping: Simulation, engine: Engine) -> tuple[Finding, ...]:
    """Say which parameters have another value in the mapping than in the model; the mapping's is used."""
    of_model, findings = {parameter.name: parameter.value for parameter in engine.parameters}, []
    for name, value in mapping.values().items():
        if abs(value - of_model[name]) > SAME * max(abs(of_model[name]), 1e-9):
            what = f"{name} is {value:g} in the mapping and {of_model[name]:g} in the model"
            findings.append(Finding("note", "value", "model", what, "", name))
    return tuple(findings)


def with_input_changed(mapping: Simulation, name: str, expression: str) -> Simulation:
    """Mapping in which a control is replaced by an expression of the recorded one, inside what replaces it already."""
    known, definition = dict(mapping.definitions), f"{REPLACED}{name}"
    changed = substitute(parse(known.get(definition, name)), {name: parse(expression)}, mapping.signals)
    return replace(mapping, definitions=tuple((known | {definition: written(changed)}).items()))


def with_strength(mapping: Simulation, engine: Engine, name: str, gain: float) -> Simulation:
    """Mapping in which a control does so many times as much: by the motor's own number, where that is the same."""
    column, n = [control.name for control in engine.controls].index(name), len(engine.coordinates)
    gear = next((part for part in engine.parameters if part.name in (f"{name}_gear", f"{name}_optimal_force")), None)
    if gear is not None:
        u = np.full((1, len(engine.controls)), 0.1)
        half = np.where(np.arange(u.shape[1]) == column, 0.5 * u, u)
        at, less = (Motion(np.full((1, n), 0.2), np.full((1, n), 0.3), each) for each in (u, half))
        if np.allclose(engine.accelerations(less, {}), engine.accelerations(at, {gear.name: gear.value / 2}), 1e-9):
            return mapping.with_parameter(replace(gear, value=gain * mapping.values().get(gear.name, gear.value)))
    return with_input_changed(mapping, name, f"{gain!r}*{name}")


def replace_inputs(mapping: Simulation, time: Values, u: Values, rate: float, x: Values | None = None) -> Values:
    """Controls of one trial (sample, control) with those that the mapping replaces by an expression of the recorded.

    x (sample, state): states that may stand in it; 0 where absent
    """
    plain = replace(mapping, model="", effects=(), definitions=())
    points = Points(time, np.zeros((len(time), len(plain.states))) if x is None else x, u, rate=rate)
    changed, called = u.copy(), [control.name for control in mapping.inputs]
    for name, expression in mapping.definitions:
        changed[:, called.index(name.removeprefix(REPLACED))] = evaluate(plain, expression, points)
    return changed
