"""The mapping of a walk with recorded forces, read and written: what its [tracked] table names."""

import os
import re
from dataclasses import dataclass, replace
from pathlib import Path
from xml.etree import ElementTree

import numpy as np

from gaitdisc.channel import did_you_mean
from gaitdisc.errors import ReadError, SchemaError
from gaitdisc.toml_text import parse_toml, quote
from gaitdisc.whole_file import write_whole

FILES = ("external_loads", "forces", "actuators", "speeds", "accelerations")
NUMBERS = ("lowpass_hz", "noise_deg", "start_s", "end_s")


@dataclass(frozen=True)
class Tracked:
    """A mapping with a [tracked] table."""

    model: Path
    loads: tuple[Path, Path]  # the ExternalLoads file, and the storage file that it names
    forces: Path | None = None
    actuators: Path | None = None
    speeds: Path | None = None
    accelerations: Path | None = None
    lowpass_hz: float = 6.0
    noise_deg: float | None = None  # standard deviation of an angle in the record, 1 mm of a translation at 0.3 deg
    start_s: float = -np.inf  # part of the record in which all forces on the ground are known
    end_s: float = np.inf

    @property
    def named(self) -> dict[str, Path]:
        """What the table names, by the words there."""
        some = (self.loads[0], self.forces, self.actuators, self.speeds, self.accelerations)
        return {name: file for name, file in zip(FILES, some, strict=True) if file is not None}

    @property
    def files(self) -> tuple[Path, ...]:
        """All that is read beside the model."""
        return self.loads[1], *self.named.values()


def read_tracked(path: Path | str) -> Tracked | None:
    """Mapping of a walk with recorded forces: of an .osim with such a mapping beside it, or of that file itself."""
    path = Path(path)
    file = path if path.suffix.lower() == ".toml" else path.with_suffix(".toml")
    if path.suffix.lower() not in (".osim", ".toml") or not file.is_file():
        return None
    try:
        text = file.read_text(encoding="utf-8")
        if re.search(r"^\s*\[tracked\]", text, re.MULTILINE) is None:
            return None
        table = parse_toml(text)
    except (OSError, ValueError) as error:
        raise ReadError("a mapping must be a TOML file", f"{file.name}: {error}", "Correct it.") from None
    given = table["tracked"]
    known = (*FILES, *NUMBERS)
    unknown = [name for name in table if name not in ("title", "model", "tracked")]
    unknown += [name for name in given if name not in known]
    if unknown:
        raise SchemaError(
            f"a mapping with [tracked] may have only title, model and, in [tracked], {', '.join(known)}",
            f"{file.name} has {unknown[0]!r}",
            did_you_mean(unknown[0], known, "Remove this key."),
        )
    if "external_loads" not in given:
        raise SchemaError(
            "a tracked walk must have recorded ground forces",
            f"[tracked] of {file.name} names no external_loads",
            'Write external_loads = "grf.xml", the external-loads file of the inverse dynamics. Without ground '
            "forces, no joint moment can be computed.",
        )
    for name in NUMBERS:
        value = given.get(name, 1.0)
        if not isinstance(value, int | float) or isinstance(value, bool) or not 0 <= value < 1e3:
            raise SchemaError(f"{name} must be from 0 to 1000", f"{file.name} has {value!r}", "Correct the number.")
    paths = {name: _there(file, name, given[name]) for name in FILES if name in given}
    model = _there(file, "model", table.get("model", f"{file.stem}.osim"))
    tracked = Tracked(model, find_loads(paths.pop("external_loads")))
    return replace(tracked, **paths, **{name: float(given[name]) for name in NUMBERS if name in given})


def _there(file: Path, what: str, name: object) -> Path:
    path = file.parent / str(name)
    if not path.is_file():
        raise ReadError(
            f"{what} of {file.name} must name an existing file",
            f"there is no file {name}",
            "Correct the path, which is relative to the mapping's folder.",
        )
    return path


def find_loads(loads: Path) -> tuple[Path, Path]:
    """Return an ExternalLoads file, and the storage file that it names."""
    if loads.suffix.lower() in (".mot", ".sto"):
        raise ReadError(
            "external_loads must be the .xml file (ExternalLoads) that assigns each force to a body",
            f"{loads.name} holds the forces themselves",
            f"Give the external-loads file (.xml) that names {loads.name} in <datafile>.",
        )
    named = (read_xml(loads).findtext(".//datafile") or "").strip()
    path = loads.parent / named
    if not named or not path.is_file():
        raise ReadError(
            f"{loads.name} must name the file of its forces in <datafile>",
            f"there is no file {named!r} in its folder" if named else "it names no file",
            f"Correct <datafile>; its path is relative to the folder of {loads.name}.",
        )
    return loads, path


def read_xml(path: Path) -> ElementTree.Element:
    """Return the root of a file of OpenSim."""
    try:
        return ElementTree.parse(path).getroot()
    except ElementTree.ParseError as error:
        raise ReadError("an OpenSim file must be XML", f"{path.name}: {error}", "Export this file again.") from None


def write_tracked_mapping(tracked: Tracked, file: Path) -> None:
    """Write the mapping, with paths that count from its own folder."""

    def beside(path: Path) -> str:
        return quote(Path(os.path.relpath(path.resolve(), file.resolve().parent)).as_posix())

    lines = [f"model = {beside(tracked.model)}", "", "[tracked]"]
    lines += [f"{name} = {beside(path)}" for name, path in tracked.named.items()]
    numbers = {name: getattr(tracked, name) for name in NUMBERS}
    lines += [f"{name} = {value!r}" for name, value in numbers.items() if value is not None and np.isfinite(value)]
    write_whole(file, "\n".join(lines) + "\n")
