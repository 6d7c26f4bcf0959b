"""`gaitdisc new`: a study file from a folder of recordings, or the mapping file of a model."""

from pathlib import Path
from typing import Annotated

import typer

from gaitdisc.errors import SchemaError
from gaitdisc.own_files import claim_file


def new(
    out: Annotated[
        Path, typer.Argument(metavar="STUDY", help="Folder of the new study; for a model, its mapping file (.toml).")
    ],
    recordings: Annotated[
        Path, typer.Option("--from", help="Folder of recordings, or a MuJoCo or OpenSim model; it is not changed.")
    ],
    degrees: Annotated[bool, typer.Option("--degrees", help="For a model: recorded angles are in degrees.")] = False,
    external_loads: Annotated[
        Path | None, typer.Option(help="For an .osim model: recorded ground forces (.xml, ExternalLoads).")
    ] = None,
    forces: Annotated[Path | None, typer.Option(help="For an .osim model: muscle forces, net moments (.sto).")] = None,
    actuators: Annotated[
        Path | None, typer.Option(help="For an .osim model: reserve and residual actuators of the forces (.xml).")
    ] = None,
) -> None:
    """Write a study file from the recordings in a folder, or the mapping file of a model."""
    from gaitdisc.simulation.simulation_file import is_model

    if external_loads or forces or actuators:
        _write_tracked(out, recordings, external_loads, forces, actuators)
        return
    if is_model(recordings):
        _write_mapping(out, recordings, degrees)
        return
    from gaitdisc.commands.run_report import progress_bar
    from gaitdisc.ingest.new_study import draft_study
    from gaitdisc.ingest.study_file import write_study
    from gaitdisc.words import counted

    file = out / "study.toml"
    claim_file(file)
    with progress_bar(quiet=False) as bar:
        task = bar.add_task("reading")
        draft, notes = draft_study(
            recordings, out, progress=lambda done, count: bar.update(task, completed=done, total=count)
        )
    write_study(draft, file)
    for note in notes:
        typer.echo(f"  {note}")
    people = counted(len(draft.participants), "participant")
    typer.echo(f"{file} written: {people}. Read it, then run: gaitdisc check {out}")


def _claim_mapping(file: Path, model: Path) -> None:
    if file.suffix != ".toml":
        raise SchemaError(
            "the mapping of a model must be a file that ends in .toml",
            f"{file.name} does not",
            f"Name it {model.with_suffix('.toml').name}: next to the model, this file is found automatically.",
        )
    claim_file(file)


def _write_mapping(file: Path, model: Path, degrees: bool) -> None:
    from gaitdisc.engines.engine import read_model
    from gaitdisc.engines.mapping import write_mapping

    _claim_mapping(file, model)
    mapping = write_mapping(read_model(model), file, degrees)
    columns = [name for name, _ in mapping.observations] + [signal.name for signal in mapping.inputs]
    typer.echo(f"{file} written: columns {', '.join(columns)}. Read it, then run: gaitdisc discover {model} MEASURED")
    if model.suffix.lower() == ".osim":
        typer.echo("For a walk with recorded ground forces, add --external-loads, --forces and --actuators.")


def _write_tracked(file: Path, model: Path, loads: Path | None, forces: Path | None, actuators: Path | None) -> None:
    from gaitdisc.engines.tracked_files import draft_tracked
    from gaitdisc.engines.tracked_mapping import write_tracked_mapping
    from gaitdisc.words import counted

    _claim_mapping(file, model)
    tracked, engine, columns = draft_tracked(model, loads, forces, actuators)
    write_tracked_mapping(tracked, file)
    stated = f"forces in {counted(len(columns), 'column')}" if tracked.forces else "no muscle forces"
    typer.echo(
        f"{file} written: {engine.mass_kg:.1f} kg, {counted(len(engine.coordinates), 'free coordinate')}, {stated}. "
        f"Read it, then run: gaitdisc discover {file} KINEMATICS.mot"
    )
    if not tracked.forces:
        typer.echo("Without muscle forces or net moments (--forces), only residuals can be reported.")
