"""`gaitdisc apply`: a recording's states by a model that `gaitdisc reconstruct` saved."""

from pathlib import Path
from typing import Annotated

import typer

from gaitdisc.errors import SchemaError


def apply(
    model: Annotated[Path, typer.Argument(help="Folder of a model that `gaitdisc reconstruct` saved.")],
    recording: Annotated[Path, typer.Argument(help="Recording with the model's sensors.")],
    calibrate: Annotated[
        Path | None, typer.Option(help="Walk of the same person with all states, used to correct the model.")
    ] = None,
    missing: Annotated[str, typer.Option(help="Replacement for a missing reading: none, mean or last.")] = "none",
    out: Annotated[
        Path | None, typer.Option(help="File to write; by default RECORDING_reconstructed.mot in the current folder.")
    ] = None,
) -> None:
    """Reconstruct the states of a recording with a saved model; report errors if the states were recorded."""
    from gaitdisc.own_files import claim_file
    from gaitdisc.reconstruction.reconstruct_study import reconstruct_recording

    if model.is_file():
        raise SchemaError(
            "a model must be a folder that `gaitdisc reconstruct` saved",
            f"{model.name} is a file",
            "Name the model first: gaitdisc apply MODEL RECORDING.",
        )
    file = out or Path(f"{recording.stem}_reconstructed.mot")
    claim_file(file)
    for line in reconstruct_recording(recording, model, file, calibration=calibrate, missing=missing).lines():
        typer.echo(line)
