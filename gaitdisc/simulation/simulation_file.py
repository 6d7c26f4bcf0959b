"""Reading a simulation file (docs/simulation.md); those that come with the package can be read and copied."""

import math
import re
from collections.abc import Mapping
from dataclasses import fields
from pathlib import Path
from typing import Any

from gaitdisc.channel import did_you_mean
from gaitdisc.errors import MissingFileError, ReadError, SchemaError, SimulationError
from gaitdisc.regular_file import check_regular
from gaitdisc.simulation.evaluating import refuse_delays
from gaitdisc.simulation.parts import SECTIONS, Input, Parameter, Port, Sensor, State, Term
from gaitdisc.simulation.python_simulation import any_equations
from gaitdisc.simulation.simulation import Simulation
from gaitdisc.simulation.unit_check import refuse_units
from gaitdisc.toml_text import parse_toml

LARGEST = 256 * 1024  # bytes
MODELS = (".xml", ".mjcf", ".osim")  # endings of what an engine reads
MOST_TABLES = 1000  # the library that parses takes a time that grows with their square
_PARTS: dict[str, Any] = {"states": State, "inputs": Input, "parameters": Parameter, "ports": Port}
# keys of each part: the fields of its class after its name, but for what an engine says of an input
TABLES = {
    section: tuple(item.name for item in fields(part)[1:] if item.name != "computed")
    for section, part in _PARTS.items()
}
_KEYS = ("title", "model", *TABLES, *SECTIONS, "effects")
_EFFECT = ("port", "equation", "name", "term")
SENSOR = tuple(item.name for item in fields(Sensor)[1:])
_FOLDER = Path(__file__).parent / "systems"


def read_simulation(path: Path | str) -> Simulation:
    r"""Read a simulation from a TOML file.

    Parameters
    ----------
    path : Path or str
        File of at most 256 KiB.

    Returns
    -------
    Simulation
        Simulation with its source and layout, so that it can be written back.

    Raises
    ------
    ReadError
        If the file cannot be read, is too large, or is not TOML.
    SchemaError
        If it is not a simulation; the message gives file, line and remedy.

    Examples
    --------
    >>> import tempfile
    >>> path = Path(tempfile.mkdtemp()) / "decay.toml"
    >>> _ = path.write_text('[states.x]\nunit = "1"\n[equations]\nx = "-x"\n')
    >>> read_simulation(path).equations
    (('x', '-x'),)
    """
    path = Path(path)
    try:
        size = check_regular(path)
        if size > LARGEST:
            raise ReadError(
                f"a simulation file must not be larger than {LARGEST // 1024} KiB",
                f"the size of {path.name} is {size / 1024:.0f} KiB",
                "Write a model of this size as a PythonSimulation.",
            )
        text = path.read_bytes().decode("utf-8-sig")
    except OSError as error:
        kind = MissingFileError if isinstance(error, FileNotFoundError) else ReadError
        found = f"{path.name}: {error.strerror or error}"
        raise kind("a simulation must be a TOML file", found, "Check the path.") from error
    except UnicodeDecodeError as error:
        raise ReadError(
            "a simulation file must be UTF-8 text",
            f"{path.name} has an invalid byte at offset {error.start}",
            "Save it as UTF-8.",
        ) from error
    return parse_simulation(text, path.name, path)


def parse_simulation(text: str, file: str = "the simulation", source: Path | None = None) -> Simulation:
    """Simulation of the text of a TOML file."""
    if len(re.findall(r"^\s*\[", text, re.MULTILINE)) > MOST_TABLES:
        raise _not_toml(file, f"more than {MOST_TABLES} tables")
    try:
        table = parse_toml(text.replace("\r\n", "\n"))
    except ValueError as error:
        raise _not_toml(file, str(error)[:200] or type(error).__name__) from None
    try:
        simulation = _simulation(table, text, source)
        refuse_delays(simulation)
        refuse_units(simulation)
        return simulation
    except SimulationError as error:
        line = _line(text, error.place)
        where = f"{file}, line {line}" if line else file
        part = f", [{error.place[0]}] {' '.join(error.place[1:])}".rstrip() if error.place else ""
        raise SchemaError(f"{where}{part}: {error.needed}", error.found, error.remedy) from None


def is_model(path: Path) -> bool:
    """Whether a file is one that an engine reads."""
    return path.suffix.lower() in MODELS


def names_engine(path: Path | str) -> bool:
    """Whether a file is a model of an engine, or the mapping of one."""
    path = Path(path)
    if is_model(path) or not path.is_file() or path.suffix.lower() != ".toml" or path.stat().st_size > LARGEST:
        return is_model(path)
    return re.search(rb"^(model\s*=|\[tracked\])", path.read_bytes(), re.MULTILINE) is not None


def _not_toml(file: str, fault: str) -> ReadError:
    return ReadError(f"{file} must be a TOML file", fault, "Correct the file. docs/simulation.md shows the form.")


def _simulation(table: Mapping[str, Any], text: str, source: Path | None) -> Simulation:
    _check_keys(table, _KEYS, ())
    tables = {section: _table(table.get(section, {}), (section,)) for section in (*TABLES, *SECTIONS)}
    parts = {section: tuple(_part(section, *entry) for entry in tables[section].items()) for section in TABLES}
    effects = table.get("effects", [])
    if not isinstance(effects, list):
        raise SimulationError("effects must be tables", "they have another form", "Write [[effects]].", ("effects",))
    sensors = {name: _sensor(name, e) for name, e in tables["observations"].items() if isinstance(e, dict)}
    tables["observations"] = {n: e["expression"] if n in sensors else e for n, e in tables["observations"].items()}
    lines: dict[str, Any] = {
        section: tuple((name, _expression(value, (section, name))) for name, value in tables[section].items())
        for section in SECTIONS
    }
    model = _text(table, "model", ())
    if model and lines["equations"]:
        raise SimulationError(
            "the equations must be either in the file or in a model of an engine",
            f"the file has both equations and model = {model!r}",
            "Remove one of them.",
            ("equations",),
        )
    if model:
        lines["equations"] = any_equations(parts["states"], (*parts["inputs"], *parts["parameters"], *parts["ports"]))
    return Simulation(
        _text(table, "title", ()),
        **parts,
        **lines,
        effects=tuple(_effect(entry, number) for number, entry in enumerate(effects)),
        sensors=tuple(sensors.values()),
        source=source,
        layout=text,
        model=model,
    )


def _part(section: str, name: str, entry: Any) -> Any:
    """State, input, parameter or port: its keys are the fields of its class."""
    place = (section, name)
    _check_keys(_table(entry, place), TABLES[section], place)
    if section == "parameters" and "value" not in entry:
        raise SimulationError("a parameter must have a value", "it has none", "Write value = ...", place)
    return _PARTS[section](name, **_fields(entry, place))


def _sensor(name: str, entry: Mapping[str, Any]) -> Sensor:
    place = ("observations", name)
    _check_keys(entry, ("expression", *SENSOR), place)
    if "expression" not in entry:
        raise SimulationError(
            "an observation must have an expression", "it has none", 'Write expression = "...".', place
        )
    return Sensor(name, **_fields({key: entry[key] for key in SENSOR if key in entry}, place))


def _fields(entry: Mapping[str, Any], place: tuple[str, ...]) -> dict[str, Any]:
    return {key: (_text if key in ("unit", "meaning") else _number)(entry, key, place) for key in entry}


def _effect(entry: Any, number: int) -> Term:
    place = ("effects", str(number))
    entry = _table(entry, place)
    _check_keys(entry, _EFFECT, place)
    kinds = [kind for kind in ("port", "equation") if kind in entry]
    if len(kinds) != 1 or "term" not in entry:
        raise SimulationError(
            "an effect must have a term, and a port or an equation",
            f"found {', '.join(entry) or 'nothing'}",
            'Write port = "..." (or equation = "...") and term = "...".',
            place,
        )
    term = _expression(entry["term"], place)
    return Term(_text(entry, kinds[0], place), kinds[0], _text(entry, "name", place), term)


def _check_keys(table: Mapping[str, Any], known: tuple[str, ...], place: tuple[str, ...]) -> None:
    for key in table:
        if key not in known:
            remedy = f"{did_you_mean(key, known)} Known: {', '.join(known)}.".lstrip()
            raise SimulationError(
                "only keys of the simulation file are allowed", f"found {key[:60]!r}", remedy, place or (key,)
            )


def _table(value: Any, place: tuple[str, ...]) -> Mapping[str, Any]:
    if not isinstance(value, dict):
        raise SimulationError("the entry must be a table", f"found {str(value)[:60]!r}", "Write [section.name].", place)
    return value


def _text(table: Mapping[str, Any], key: str, place: tuple[str, ...]) -> str:
    value = table.get(key, "")
    if not isinstance(value, str):
        raise SimulationError(
            f"{key} must be text", f"found {str(value)[:60]}", f'Write {key} = "...".', place or (key,)
        )
    return value


def _number(table: Mapping[str, Any], key: str, place: tuple[str, ...]) -> float:
    value = table[key]
    if type(value) not in (int, float) or abs(value) > 1e300 or not math.isfinite(value):
        fault = f"found {str(value)[:60]}" if type(value) is not int else "the number exceeds 1e300"
        raise SimulationError(f"{key} must be a finite number", fault, "Write a number without quotes.", place)
    return float(value)


def _expression(value: Any, place: tuple[str, ...]) -> str:
    if type(value) in (int, float) and abs(value) < 1e300 and math.isfinite(value):
        return repr(value)
    if not isinstance(value, str):
        raise SimulationError("expressions must be text", f"found {str(value)[:60]}", 'Write "..." with quotes.', place)
    return value


def _line(text: str, place: tuple[str, ...]) -> int | None:
    """Line of a part, counted from 1; of its section where it has no line of its own."""
    if not place:
        return None
    section, number, here = "", -1, None
    for line, words in enumerate(text.split("\n"), 1):
        header = re.match(r"\s*\[\[?\s*([A-Za-z0-9_.\"' -]+?)\s*\]\]?", words)
        if header:
            keys = tuple(key.strip("\"' ") for key in header[1].split("."))
            section = keys[0]
            number += keys == ("effects",)
            if keys == place or (keys, (str(number),)) == (("effects",), place[1:]):
                return line
            here = line if section == place[0] and here is None else here
        elif (section, place[-1]) == place or (not section and len(place) == 1):
            key = re.match(r"\s*[\"']?([A-Za-z0-9_-]+)[\"']?\s*[.=]", words)
            if key and key[1] == place[-1]:
                return line
    return here


def list_bundled() -> tuple[str, ...]:
    """Names of the simulations that come with the package.

    >>> "lorenz" in list_bundled()
    True
    """
    return tuple(sorted(path.stem for path in _FOLDER.glob("*.toml")))


def bundled(name: str) -> Simulation:
    """Return a simulation that is included in the package.

    Parameters
    ----------
    name : str
        Name such as `pendulum` or `lorenz`; the error for an unknown name lists all names.

    Raises
    ------
    ReadError
        If no simulation has this name.

    Examples
    --------
    >>> import gaitdisc as gd
    >>> gd.bundled_simulation("pendulum").values()["length"]
    0.8
    """
    if name not in list_bundled():
        remedy = f"{did_you_mean(name, list_bundled())} Known: {', '.join(list_bundled())}.".lstrip()
        raise ReadError("the simulation must be one that is included in the package", f"there is no {name!r}", remedy)
    return read_simulation(_FOLDER / f"{name}.toml")
