"""`gaitdisc export`: the streams of one walk on one time base; or a saved model as ONNX."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer


def export(
    files: Annotated[
        list[Path], typer.Argument(help="Files of one walk: angles, forces, EMG; or the folder of a model.")
    ],
    out: Annotated[
        Path, typer.Option("--out", help="File to write: .csv, .tsv, .parquet, .mot, .sto; .onnx of a model.")
    ],
    rate: Annotated[float, typer.Option(min=1.0, help="Samples a second of the result.")] = 100.0,
    stream: Annotated[list[str] | None, typer.Option(help="Only this stream; may be repeated.")] = None,
    labels: Annotated[
        bool,
        typer.Option("--labels", help="Keep labels that are outside the vocabulary; without it they are numbered."),
    ] = False,
) -> None:
    """Bring EMG, force and kinematics of one walk to one time base, low-passed where they are faster than it."""
    if out.suffix.lower() == ".onnx":
        _model(files, out)
        return
    from gaitdisc.batch.public_words import with_public_labels
    from gaitdisc.ingest.reading import read_trial
    from gaitdisc.ingest.storage import write_storage
    from gaitdisc.ingest.table import write_table
    from gaitdisc.processing.one_base import on_one_base

    together = on_one_base(read_trial(files), rate, tuple(stream) if stream else None)
    if not labels:
        together, count = with_public_labels(together)
        if count:
            what = "label is" if count == 1 else "labels are"
            typer.echo(f"{count} {what} outside the vocabulary and numbered; --labels keeps them.", err=True)
    write = write_storage if out.suffix.lower() in (".mot", ".sto") else write_table
    write(together, out)
    typer.echo(f"{out}: {len(together.names)} channels, {len(together.time)} samples at {together.rate_hz:g} Hz")


def _model(folders: list[Path], out: Path) -> None:
    from gaitdisc.errors import SchemaError
    from gaitdisc.sensing.model_folder import load_model
    from gaitdisc.sensing.onnx_file import write_onnx

    if len(folders) != 1:
        raise SchemaError("an .onnx file holds one model", f"{len(folders)} are named", "Name one folder.")
    model = load_model(folders[0])
    write_onnx(model, out)
    what = model.reconstructor.sensing
    typer.echo(f"{out}: {model.reconstructor.kind}, {', '.join(what.sensors)} to {len(what.states)} states")
