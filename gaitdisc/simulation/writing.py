"""Writing a simulation back, with the comments and the order of the file that it came from."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path

from gaitdisc.errors import GaitdiscError, ReadError, SchemaError
from gaitdisc.own_files import guarded
from gaitdisc.simulation.parts import Input, Parameter, Sensor, State, Term
from gaitdisc.simulation.python_simulation import PythonSimulation
from gaitdisc.simulation.refusal import SimulationError
from gaitdisc.simulation.simulation import Lines, Simulation
from gaitdisc.simulation.simulation_file import ERRORS, simulation_of
from gaitdisc.toml_text import quoted
from gaitdisc.whole_file import write_whole

_REPLACED = "replaced_"  # begins the name of the definition that an input of a Python object is replaced by
_HEADER = re.compile(r"\s*\[")
_STRING = r"\"(?:[^\"\\\n]|\\.)*\"|'[^'\n]*'|[^#\"'\n]*?"


def write_simulation(simulation: Simulation | PythonSimulation, path: Path | str, overwrite: bool = False) -> Path:
    r"""Write a simulation file; never a partial one.

    Parameters
    ----------
    simulation : Simulation or PythonSimulation
        Simulation to write. The right-hand side of a Python object is not written; `read_into` restores the rest.
    path : Path or str
        Path of the file.
    overwrite : bool
        Whether to replace a file that `write_simulation` did not write, or that was changed since.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    WriteError
        If it cannot be written; an older file is unchanged.

    Examples
    --------
    >>> import tempfile
    >>> decay = simulation_of('[states.x]  # metres\n[equations]\nx = "-x"\n')
    >>> more = decay.with_effect(Term("x", "equation", "constant_load", "0.5"))
    >>> print(write_simulation(more, Path(tempfile.mkdtemp()) / "decay.toml").read_text(), end="")
    [states.x]  # metres
    [equations]
    x = "-x"
    <BLANKLINE>
    [[effects]]
    equation = "x"
    name = "constant_load"
    term = "0.5"
    """
    if not isinstance(simulation, Simulation | PythonSimulation):
        raise SimulationError(
            "only a Simulation can be written to a simulation file",
            f"found {type(simulation).__name__}",
            "Convert a function first: gaitdisc.simulation_from_function(function).",
        )
    text = _python_text(simulation) if isinstance(simulation, PythonSimulation) else simulation_text(simulation)
    with guarded("gd.write_simulation", overwrite=overwrite):
        return write_whole(path, text)


def simulation_text(simulation: Simulation) -> str:
    """Text of a simulation file.

    What it was read from is changed only where the simulation differs; where that cannot be done (values inside inline
    tables, say) everything is written anew.
    """
    if simulation.layout:
        text = _changed_text(simulation)
        try:
            if simulation_of(text) == simulation:
                return text
        except GaitdiscError:
            pass  # the layout is one that line by line changes do not fit
    return _new_text(simulation)


def read_into(model: PythonSimulation, path: Path | str) -> PythonSimulation:
    """Give a Python object what was written of it: effects, numbers, starts, observations, inputs."""
    path = Path(path)
    try:
        text = path.read_text(encoding="utf-8")
        table = tomllib.loads(text)
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise ReadError("a model must be a TOML file", f"{path.name}: {error}", "Check the path.") from error
    for section in ("states", "inputs", "ports"):
        own, its = [part.name for part in getattr(model, section)], list(table.get(section, {}))
        if own != its:
            raise SchemaError(
                f"the {section} must be those of {model.title!r}: {', '.join(own) or 'none'}",
                f"{path.name} has {', '.join(its) or 'none'}",
                "Read the file that was written from this model.",
            )
    equations = [f"{name} = {quoted(listed)}" for name, listed in model.equations]
    read = simulation_of("\n".join([text, "[equations]", *equations, ""]), path.name)
    replaced = tuple((name.removeprefix(_REPLACED), listed) for name, listed in read.definitions)
    return replace(model, parts=replace(read, definitions=(), layout="", source=None), replaced=replaced)


def _python_text(simulation: PythonSimulation) -> str:
    """Text that says everything but the equations."""
    replaced = tuple((f"{_REPLACED}{name}", text) for name, text in simulation.replaced)
    return "\n".join(
        (
            "# The right-hand side is a Python object, which no file holds: there are no [equations] here. To give the",
            "# object what stands here: model = gaitdisc.simulation.writing.read_into(model, path)",
            _new_text(replace(simulation.parts, definitions=replaced), ("definitions", "observations")),
        )
    )


def _changed_text(simulation: Simulation) -> str:
    before = simulation_of(simulation.layout)
    ending = "\r\n" if "\r\n" in simulation.layout else "\n"
    lines = simulation.layout.replace("\r\n", "\n").rstrip("\n").split("\n")
    added = []
    known = {parameter.name: parameter for parameter in before.parameters}
    for parameter in simulation.parameters:
        if parameter.name not in known:
            added += ["", *_parameter(parameter)]
        elif parameter != known[parameter.name]:
            lines = _with_parameter(lines, known[parameter.name], parameter)
    for section in ("definitions",) if simulation.model else ("definitions", "equations"):
        lines = _with_expressions(lines, section, getattr(before, section), getattr(simulation, section))
    lines = _with_observations(lines, before, simulation)
    for state in simulation.states[len(before.states) :]:
        lines = _with_line(lines, "equations", state.name, dict(simulation.equations)[state.name])
        added += ["", *_state(state)]
    kept = before.effects == simulation.effects[: len(before.effects)]
    if not kept:
        lines = _without_effects(lines)
    for term in simulation.effects[len(before.effects) if kept else 0 :]:
        added += ["", *_effect(term)]
    return ending.join([*lines, *added, ""])


def _with_parameter(lines: list[str], old: Parameter, new: Parameter) -> list[str]:
    """Another value in the parameter's table, or the whole table anew."""
    start, end = _table(lines, rf"parameters\s*\.\s*{old.name}")
    if start < 0:
        return lines
    if replace(old, value=new.value) != new:
        return [*lines[:start], *_parameter(new), *lines[end:]]
    return _with_values(lines, (start, end), {"value": repr(new.value)})


def _with_expressions(lines: list[str], section: str, old: Lines, new: Lines) -> list[str]:
    had = dict(old)
    changed = {name: quoted(text) for name, text in new if had.get(name) != text}
    return _with_values(lines, _table(lines, section), changed) if changed else lines


def _with_observations(lines: list[str], before: Simulation, after: Simulation) -> list[str]:
    said = re.compile(r"\s*\[\s*observations\s*[.\]]")
    implied = len(after.states) > len(before.states) and not any(said.match(line) for line in lines)
    if before.observations == after.observations and not implied:
        return lines
    has, wanted = dict(before.observations), dict(after.observations)
    long = False
    for name in has:
        span = _table(lines, rf"observations\s*\.\s*[\"']?{re.escape(name)}[\"']?")
        long = long or span[0] >= 0
        if span[0] >= 0 and name in wanted:
            lines = _with_values(lines, span, {"expression": quoted(wanted[name])})
    start, end = _table(lines, "observations")
    if start < 0 and long:
        added = [["", *_observation(text, after.sensor(name))] for name, text in after.observations if name not in has]
        return [*lines, *(line for one in added for line in one)]
    if start < 0:
        return [*lines, "", "[observations]", *_expressions(after.observations)]
    if [name for name in wanted if name in has] != list(has):
        return [*lines[: start + 1], *_expressions(after.observations), "", *lines[end:]]
    lines = _with_expressions(lines, "observations", before.observations, after.observations)
    for name, text in after.observations:
        if name not in has:
            lines = _with_line(lines, "observations", name, text)
    return lines


def _with_line(lines: list[str], section: str, name: str, expression: str) -> list[str]:
    """One line more at the end of a table."""
    end = _table(lines, section)[1]
    while not lines[end - 1].strip():
        end -= 1
    return [*lines[:end], *_expressions([(name, expression)]), *lines[end:]]


def _without_effects(lines: list[str]) -> list[str]:
    start, end = _table(lines, "effects", double=True)
    while start >= 0:
        lines = [*lines[:start], *lines[end:]]
        start, end = _table(lines, "effects", double=True)
    while lines and not lines[-1].strip():
        lines.pop()
    return lines


def _table(lines: list[str], name: str, double: bool = False) -> tuple[int, int]:
    """Lines from a table's header to the next header; -1 where there is none."""
    opening, closing = ("[[", "]]") if double else ("[", "]")
    header = re.compile(rf"\s*{re.escape(opening)}\s*{name}\s*{re.escape(closing)}\s*(#.*)?$")
    start = next((number for number, line in enumerate(lines) if header.match(line)), -1)
    end = next((number for number in range(start + 1, len(lines)) if _HEADER.match(lines[number])), len(lines))
    return start, end


def _with_values(lines: list[str], span: tuple[int, int], values: dict[str, str]) -> list[str]:
    """Other values of some keys of a table; what stands before and after them is kept."""
    changed = list(lines)
    for number in range(max(span[0], 0), span[1]):
        found = re.match(rf"(\s*[\"']?([^\"'=\s]+)[\"']?\s*=\s*)({_STRING})(\s*(?:#.*)?)$", lines[number])
        if found and found[2] in values:
            changed[number] = f"{found[1]}{values[found[2]]}{found[4]}"
    return changed


def _new_text(simulation: Simulation, sections: Iterable[str] = ("definitions", "equations", "observations")) -> str:
    lines = [f"title = {quoted(simulation.title)}"]
    if simulation.model:
        lines += [f"model = {quoted(simulation.model)}"]
        sections = [section for section in sections if section != "equations"]
    for state in simulation.states:
        lines += ["", *_state(state)]
    for each in simulation.inputs:
        unit = f"unit = {quoted(each.unit)}"
        lines += ["", f"[inputs.{each.name}]", unit, *_numbers(each, ERRORS), *_meaning(each.meaning)]
    for parameter in simulation.parameters:
        lines += ["", *_parameter(parameter)]
    for port in simulation.ports:
        lines += ["", f"[ports.{port.name}]", f"unit = {quoted(port.unit)}", *_meaning(port.meaning)]
    for section in sections:
        if section == "observations" and simulation.sensors:
            for name, text in simulation.observations:
                lines += ["", *_observation(text, simulation.sensor(name))]
        elif getattr(simulation, section):
            lines += ["", f"[{section}]", *_expressions(getattr(simulation, section))]
    for term in simulation.effects:
        lines += ["", *_effect(term)]
    return "\n".join([*lines, ""])


def _state(state: State) -> list[str]:
    unit = f"unit = {quoted(state.unit)}"
    return [f"[states.{state.name}]", unit, *_meaning(state.meaning), *_numbers(state, ("initial",))]


def _parameter(parameter: Parameter) -> list[str]:
    unit = f"unit = {quoted(parameter.unit)}"
    bounds, meaning = _numbers(parameter, ("low", "high")), _meaning(parameter.meaning)
    return [f"[parameters.{parameter.name}]", f"value = {parameter.value!r}", unit, *bounds, *meaning]


def _observation(expression: str, sensor: Sensor) -> list[str]:
    unit = [f"unit = {quoted(sensor.unit)}"] if sensor.unit else []
    numbers = _numbers(sensor, ("sd", "lowpass"))
    return [f"[observations.{_key(sensor.channel)}]", f"expression = {quoted(expression)}", *unit, *numbers]


def _effect(term: Term) -> list[str]:
    return [
        "[[effects]]",
        f"{term.kind} = {quoted(term.place)}",
        f"name = {quoted(term.name)}",
        f"term = {quoted(term.term)}",
    ]


def _expressions(lines: Iterable[tuple[str, str]]) -> list[str]:
    return [f"{_key(name)} = {quoted(text)}" for name, text in lines]


def _key(name: str) -> str:
    return name if re.match(r"[A-Za-z0-9_-]+$", name) else quoted(name)


def _numbers(part: State | Input | Parameter | Sensor, keys: tuple[str, ...]) -> list[str]:
    return [f"{key} = {value!r}" for key in keys if (value := getattr(part, key)) is not None]


def _meaning(text: str) -> list[str]:
    return [f"meaning = {quoted(text)}"] if text else []
