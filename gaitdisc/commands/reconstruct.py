"""`gaitdisc reconstruct`: the full state from a few sensors and their history."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from gaitdisc.commands.exit_codes import SOME_REFUSED
from gaitdisc.commands.options import Quiet
from gaitdisc.errors import SchemaError

if TYPE_CHECKING:
    from gaitdisc.results.reconstruction import Reconstruction

OF_A_STUDY = ("sensors", "search", "split", "condition", "targets", "ahead", "kinds", "device")
OF_A_RECORDING = ("calibrate", "missing")


def reconstruct(  # noqa: PLR0913, PLR0917 these are the options of a command
    context: typer.Context,
    study: Annotated[Path, typer.Argument(help="The study file or its folder; with --model one recording.")],
    sensors: Annotated[
        list[str] | None, typer.Option("--sensors", "-s", help="Channels that are read: a,b,c or repeated.")
    ] = None,
    search: Annotated[
        int,
        typer.Option(help="Search the best sets of up to so many sensors; without --sensors the smallest that does."),
    ] = 0,
    split: Annotated[
        str, typer.Option(help='temporal, blocked, subject, condition (each by the others), or "random (leaks)".')
    ] = "temporal",
    condition: Annotated[
        str, typer.Option(help="Walks of this condition alone; with --split condition those of the test part.")
    ] = "",
    targets: Annotated[str, typer.Option(help="What is reconstructed: states, emg, forces or moments.")] = "states",
    ahead: Annotated[float, typer.Option(min=0.0, help="Forecast the states so many seconds ahead.")] = 0.0,
    kinds: Annotated[str, typer.Option(help='As in "delay ridge,masked shred"; by default five kinds of model.')] = "",
    model: Annotated[
        Path | None,
        typer.Option(help="Folder of a model that this command saved: reconstruct the states of a recording."),
    ] = None,
    calibrate: Annotated[
        Path | None, typer.Option(help="With --model: a walk of the same person with all states, to correct it by.")
    ] = None,
    missing: Annotated[
        str, typer.Option(help="With --model: what stands for a missing reading: none, mean or last.")
    ] = "none",
    device: Annotated[
        str, typer.Option(help="That networks are fitted on: cpu, cuda, or auto, the GPU where there is one.")
    ] = "auto",
    out: Annotated[Path | None, typer.Option(help="Folder of the report; by default STUDY/reconstruct.")] = None,
    quiet: Quiet = False,
) -> None:
    """Reconstruct all states from a few sensors, by SHRED and by what it has to beat; tested on unseen walking."""
    from gaitdisc.batch.reconstruct_study import ReconstructionSettings, reconstruct_study
    from gaitdisc.batch.search_study import search_study
    from gaitdisc.ingest.study_file import load_study
    from gaitdisc.report.figure import file_names
    from gaitdisc.report.reconstruction_page import write_reconstruction_report
    from gaitdisc.results.reconstruction import enough_sensors, save_reconstruction
    from gaitdisc.sensing.model_folder import save_model
    from gaitdisc.sensing.reconstructor import KINDS

    _refuse_others(context, model)
    if model is not None:
        _by_model(study, model, out, calibrate, missing)
        return
    loaded = load_study(study)
    folder = out or loaded.folder / "reconstruct"
    chosen = tuple(kind.strip() for kind in kinds.split(",")) if kinds else tuple(KINDS)
    settings = ReconstructionSettings(
        split=split,
        condition=condition,
        targets=targets,
        ahead_s=ahead,
        kinds=chosen,
        seed=loaded.models.seed,
        device=device,
    )
    names = [name for words in sensors or [] for name in words.replace(",", " ").split()]
    found = search_study(loaded, search, settings) if search else None
    if found is not None and not names:
        names = str(found["names"].iloc[enough_sensors(found)]).split(", ")
    done, people = reconstruct_study(
        loaded, names, settings, lambda who, _: None if quiet else typer.echo(f"  {who}", err=True)
    )
    done = replace(done, search=found)
    save_reconstruction(done, folder)
    page = write_reconstruction_report(done, folder)
    places = file_names([person.participant for person in people])
    for person in people:
        save_model(person.model(done.recommended), folder / "models" / places[person.participant])
    _tell(done)
    typer.echo(f"models: {folder / 'models'}, {done.recommended} for each participant")
    typer.echo(f"report: {page}")
    if done.refusals:
        raise typer.Exit(SOME_REFUSED)


def _refuse_others(context: typer.Context, model: Path | None) -> None:
    others = OF_A_STUDY if model is not None else OF_A_RECORDING
    sources = {name: context.get_parameter_source(name) for name in others}
    given = [name for name, source in sources.items() if source is not None and source.name == "COMMANDLINE"]
    if given:
        words = " and ".join(f"--{name}" for name in given)
        told = ("a saved model reads a recording as it was fitted", "Leave them out, or leave --model out.")
        fitted = (
            "these correct what a saved model reconstructs of a recording",
            "Name the model's folder with --model.",
        )
        needed, remedy = told if model is not None else fitted
        raise SchemaError(needed, f"{words} {'with' if model is not None else 'without'} --model", remedy)


def _by_model(recording: Path, model: Path, out: Path | None, calibrate: Path | None, missing: str) -> None:
    from gaitdisc.batch.reconstruct_recording import reconstruct_recording

    file = out or Path(f"{recording.stem}_reconstructed.mot")
    told = reconstruct_recording(recording, model, file, calibration=calibrate, missing=missing)
    for line in told.lines():
        typer.echo(line)


def _tell(done: Reconstruction) -> None:
    from rich.console import Console

    from gaitdisc.report.reconstruction_tables import reconstruction_sentences, reconstruction_text

    typer.echo(" ".join(reconstruction_sentences(done)))
    Console().print(reconstruction_text(done))
    for refusal in done.refusals:
        who = " ".join(filter(None, (refusal.participant, refusal.condition)))
        typer.echo(f"left out: {who}: {refusal.reason}", err=True)
