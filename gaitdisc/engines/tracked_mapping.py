"""The mapping of a walk with recorded forces, written: the [tracked] table that `read_tracked` reads."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np

from gaitdisc.engines.opensim_tracked import OpensimTracked
from gaitdisc.engines.tracked_files import FILES, Tracked, actuator_forces, check_loads, loads_of
from gaitdisc.errors import SchemaError
from gaitdisc.toml_text import quoted
from gaitdisc.whole_file import write_whole


def drafted_tracked(
    model: Path, loads: Path | None, forces: Path | None = None, actuators: Path | None = None
) -> tuple[Tracked, OpensimTracked]:
    """What a model's walk is tracked with, once model and files have been found to belong together."""
    if model.suffix.lower() != ".osim":
        raise SchemaError(
            "recorded ground forces are tracked in a model of OpenSim",
            f"{model.name} is none",
            "Leave out --external-loads, --forces and --actuators.",
        )
    if loads is None:
        raise SchemaError(
            "a walk is tracked with its recorded ground forces",
            f"{'forces' if forces else 'actuators'} are given without them",
            "Add --external-loads grf.xml, the file of OpenSim's inverse dynamics.",
        )
    for path in (model, loads, forces, actuators):
        if path is not None and not path.is_file():
            raise SchemaError("a walk is tracked with files", f"there is none at {path}", "Check the path.")
    tracked = Tracked(model, loads_of(loads), forces, actuators)
    check_loads(tracked)
    engine = OpensimTracked(model, tracked.loads, actuators)
    actuator_forces(tracked, engine.actuators)
    return tracked, engine


def write_tracked_mapping(tracked: Tracked, file: Path) -> None:
    """Write the mapping, with paths that count from its own folder."""

    def beside(path: Path) -> str:
        return quoted(Path(os.path.relpath(path.resolve(), file.resolve().parent)).as_posix())

    paths = (tracked.loads[0], tracked.forces, tracked.actuators, tracked.speeds, tracked.accelerations)
    lines = [f"model = {beside(tracked.model)}", "", "[tracked]"]
    lines += [f"{name} = {beside(path)}" for name, path in zip(FILES, paths, strict=True) if path is not None]
    lines.append(f"lowpass_hz = {tracked.lowpass_hz!r}")
    numbers = {"noise_deg": tracked.noise_deg, "start_s": tracked.start_s, "end_s": tracked.end_s}
    lines += [f"{name} = {value!r}" for name, value in numbers.items() if value is not None and np.isfinite(value)]
    write_whole(file, "\n".join(lines) + "\n")
