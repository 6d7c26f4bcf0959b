"""Writing a simulation back, with the comments and the order of the file that it came from."""

from collections.abc import Iterable
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import Any

import tomlkit
from tomlkit.exceptions import TOMLKitError

from gaitdisc.errors import GaitdiscError, ReadError, SchemaError, SimulationError
from gaitdisc.own_files import guard
from gaitdisc.simulation.parts import Sensor
from gaitdisc.simulation.python_simulation import PythonSimulation
from gaitdisc.simulation.simulation import Simulation
from gaitdisc.simulation.simulation_file import SENSOR, TABLES, parse_simulation
from gaitdisc.toml_text import parse_toml, quote
from gaitdisc.whole_file import write_whole

_REPLACED = "replaced_"  # begins the name of the definition that an input of a Python object is replaced by


def write_simulation(simulation: Simulation | PythonSimulation, path: Path | str, overwrite: bool = False) -> Path:
    r"""Write a simulation file, completely or not at all.

    Parameters
    ----------
    simulation : Simulation or PythonSimulation
        Simulation to write. The right-hand side of a `PythonSimulation` is not written; `read_into` restores everything
        else.
    path : Path or str
        Path of the file.
    overwrite : bool
        Whether to replace a file that `write_simulation` did not write, or that was changed since.

    Returns
    -------
    Path
        Path of the written file.

    Raises
    ------
    WriteError
        If the file cannot be written; an older file is unchanged.

    Examples
    --------
    >>> import tempfile
    >>> from gaitdisc.simulation.parts import Term
    >>> decay = parse_simulation('[states.x]  # metres\n[equations]\nx = "-x"\n')
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
    with guard("gd.write_simulation", overwrite=overwrite):
        return write_whole(path, text)


def simulation_text(simulation: Simulation) -> str:
    """Text of a simulation file.

    What it was read from is changed only where the simulation differs; where that cannot be done everything is written
    anew.
    """
    if simulation.layout:
        with suppress(GaitdiscError, TOMLKitError):
            text = _change_text(simulation)
            if parse_simulation(text) == simulation:
                return text
    return tomlkit.dumps(_table(simulation, long=bool(simulation.sensors)))


def read_into(model: PythonSimulation, path: Path | str) -> PythonSimulation:
    """Give a Python object what was written of it: effects, numbers, starts, observations, inputs."""
    path = Path(path)
    try:
        text = path.read_text(encoding="utf-8")
        table = parse_toml(text)
    except (OSError, ValueError) as error:
        raise ReadError("a model must be a TOML file", f"{path.name}: {error}", "Check the path.") from error
    for section in ("states", "inputs", "ports"):
        names, stated = [part.name for part in getattr(model, section)], list(table.get(section, {}))
        if names != stated:
            raise SchemaError(
                f"the {section} must be those of {model.title!r}: {', '.join(names) or 'none'}",
                f"{path.name} has {', '.join(stated) or 'none'}",
                "Read the file that was written from this model.",
            )
    equations = [f"{name} = {quote(listed)}" for name, listed in model.equations]
    read = parse_simulation("\n".join([text, "[equations]", *equations, ""]), path.name)
    replaced = tuple((name.removeprefix(_REPLACED), listed) for name, listed in read.definitions)
    return replace(model, parts=replace(read, definitions=(), layout="", source=None), replaced=replaced)


def _python_text(simulation: PythonSimulation) -> str:
    """Text that says everything but the equations."""
    replaced = tuple((f"{_REPLACED}{name}", text) for name, text in simulation.replaced)
    table = _table(replace(simulation.parts, definitions=replaced), long=bool(simulation.sensors))
    del table["equations"]
    return (
        "# The right-hand side is a Python object, so this file has no [equations]. To apply the file to the\n"
        "# object: model = gaitdisc.simulation.writing.read_into(model, path)\n"
    ) + tomlkit.dumps(table)


def _table(simulation: Simulation, long: bool) -> dict[str, Any]:
    """All that a simulation file says.

    long: whether each observation is a table, in which what is known of its sensor has a place
    """
    table: dict[str, Any] = {"model": simulation.model} if simulation.model else {}
    for section, keys in TABLES.items():
        table[section] = {part.name: _entry(part, keys) for part in getattr(simulation, section)}
    table["definitions"] = dict(simulation.definitions)
    table["equations"] = {} if simulation.model else dict(simulation.equations)
    table["observations"] = {
        name: {"expression": text, **_entry(simulation.sensor(name), SENSOR)} if long else text
        for name, text in simulation.observations
    }
    table["effects"] = [{e.kind: e.place, "name": e.name, "term": e.term} for e in simulation.effects]
    return {"title": simulation.title, **{section: content for section, content in table.items() if content}}


def _entry(part: object, keys: Iterable[str]) -> dict[str, Any]:
    """What is said of a part; its unit even where it is empty, unless it is a sensor's, which may be left open."""
    entry = {key: getattr(part, key) for key in keys}
    always = () if isinstance(part, Sensor) else ("unit",)
    return {key: value for key, value in entry.items() if key in always or value not in (None, "")}


def _change_text(simulation: Simulation) -> str:
    """Text of the file that a simulation was read from, changed where they differ; new tables stand at its end."""
    document = tomlkit.parse(simulation.layout.replace("\r\n", "\n"))
    before, after = _table(parse_simulation(simulation.layout), long=True), _table(simulation, long=True)
    if "observations" not in document:
        implied = simulation.observations == tuple((state.name, state.name) for state in simulation.states)
        before["observations"] = after["observations"] if implied and not simulation.sensors else {}
    had, has = before.pop("effects", []), after.pop("effects", [])
    if has[: len(had)] != had:
        del document["effects"]
        had = []
    added = _change(document, before, after)
    if has != had:
        added["effects"] = has[len(had) :]
    text = tomlkit.dumps(document).rstrip("\n") + "\n" + ("\n" + tomlkit.dumps(added) if added else "")
    return text.replace("\n", "\r\n") if "\r\n" in simulation.layout else text


def _change(table: Any, before: dict[str, Any], after: dict[str, Any], short: bool = False) -> dict[str, Any]:
    """Change a table where two states of it differ, and give back what needs tables of its own.

    short: whether its lines are observations, each an expression
    """
    added: dict[str, Any] = {}
    if [key for key in after if key in before] != [key for key in before if key in after]:
        before = dict.fromkeys(before)  # in another order: all is written again
    for key in before:
        if key in table and (key not in after or before[key] is None):
            del table[key]
    for key, value in after.items():
        if value == before.get(key):
            continue
        there = table.get(key)
        if isinstance(there, dict) and isinstance(value, dict):
            lines = key == "observations" and any(isinstance(entry, str) for entry in there.values())
            nested = _change(there, before.get(key) or {}, value, lines)
            added |= {key: nested} if nested else {}
        elif isinstance(value, dict) and not short:
            added[key] = value
        else:
            table[key] = _line(value) if short else value
    return added


def _line(observation: dict[str, Any]) -> Any:
    """Observation in one line."""
    if len(observation) == 1:
        return observation["expression"]
    line = tomlkit.inline_table()
    line.update(observation)
    return line
