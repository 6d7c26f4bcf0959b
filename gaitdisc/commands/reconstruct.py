"""`gaitdisc reconstruct`: models of the full state from a few sensors and their history."""

from dataclasses import replace
from pathlib import Path
from typing import Annotated

import typer

from gaitdisc.commands.options import SOME_REFUSED, Quiet
from gaitdisc.errors import LOG


def reconstruct(  # noqa: PLR0913, PLR0917 these are the options of a command
    study: Annotated[Path, typer.Argument(help="The study file or its folder.")],
    sensors: Annotated[
        list[str] | None, typer.Option("--sensors", "-s", help="Sensor channels, comma-separated; may be repeated.")
    ] = None,
    search: Annotated[
        int,
        typer.Option(
            help="Find the best sets of up to this many sensors; without --sensors, use the smallest sufficient set."
        ),
    ] = 0,
    split: Annotated[
        str, typer.Option(help='Split of the data: temporal, blocked, subject, condition or "random (leaks)".')
    ] = "temporal",
    condition: Annotated[
        str, typer.Option(help="Use walks of this condition only; with --split condition, test on these walks.")
    ] = "",
    targets: Annotated[str, typer.Option(help="Quantity to reconstruct: states, emg, forces or moments.")] = "states",
    ahead: Annotated[float, typer.Option(min=0.0, help="Forecast the states this many seconds ahead.")] = 0.0,
    spacing: Annotated[
        float, typer.Option(min=0.001, help="Sampling interval in a window [s]; a window covers the last second.")
    ] = 0.04,
    kinds: Annotated[
        str, typer.Option(help='Kinds of model; default: "linear,shallow decoder,delay ridge,fourier ridge,shred".')
    ] = "",
    device: Annotated[
        str, typer.Option(help="Device for the networks: cpu, cuda, or auto, which uses a GPU if there is one.")
    ] = "auto",
    out: Annotated[Path | None, typer.Option(help="Folder of the report; by default STUDY/reconstruct.")] = None,
    quiet: Quiet = False,
) -> None:
    """Fit SHRED and simpler models that estimate all states from a few sensors, and test them on held-out walking.

    Each participant's recommended model is saved; `gaitdisc apply` reconstructs a recording with it.
    """
    from rich.console import Console

    from gaitdisc.ingest.study_file import load_study
    from gaitdisc.own_files import claim_folder
    from gaitdisc.reconstruction.model_folder import save_model
    from gaitdisc.reconstruction.page import reconstruction_sentences, reconstruction_text, write_reconstruction_report
    from gaitdisc.reconstruction.reconstruct_study import ReconstructionSettings, reconstruct_study, search_study
    from gaitdisc.reconstruction.reconstruction import enough_sensors
    from gaitdisc.reconstruction.window_model import KINDS
    from gaitdisc.report.figure import file_names

    loaded = load_study(study)
    folder = out or loaded.folder / "reconstruct"
    tables = ("errors.csv", "summary.csv", "curves.csv", "search.csv")
    claim_folder(folder, "reconstruction.json", *tables, "report.html", "models")
    chosen = tuple(kind.strip() for kind in kinds.split(",")) if kinds else tuple(KINDS)
    settings = ReconstructionSettings(
        split=split,
        condition=condition,
        targets=targets,
        spacing_s=spacing,
        ahead_s=ahead,
        kinds=chosen,
        seed=loaded.models.seed,
        device=device,
    )
    names = [name for words in sensors or [] for name in words.replace(",", " ").split()]
    searched = search_study(loaded, search, settings) if search else None
    if searched is not None and not names:
        names = str(searched["names"].iloc[enough_sensors(searched)]).split(", ")
    done, people = reconstruct_study(loaded, names, settings, lambda who, _: None if quiet else LOG.info(f"  {who}"))
    done = replace(done, search=searched)
    done.save(folder)
    page = write_reconstruction_report(done, folder)
    places = file_names([person.participant for person in people])
    for person in people:
        save_model(person.model(done.recommended), folder / "models" / places[person.participant])
    typer.echo(" ".join(reconstruction_sentences(done)))
    Console().print(reconstruction_text(done))
    for refusal in done.refusals:
        who = " ".join(filter(None, (refusal.participant, refusal.condition)))
        LOG.info(f"left out: {who}: {refusal.reason}")
    typer.echo(f"models: {folder / 'models'}, {done.recommended} for each participant")
    typer.echo(f"report: {page}")
    if done.refusals:
        raise typer.Exit(SOME_REFUSED)
