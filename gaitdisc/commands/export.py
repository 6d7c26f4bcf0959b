"""`gaitdisc export`: streams of one walk on one time base; cycles of a run as tidy tables; a saved model as ONNX."""

from pathlib import Path
from typing import Annotated

import typer

from gaitdisc.errors import LOG, SchemaError


def export(
    files: Annotated[
        list[Path],
        typer.Argument(help="Files of one walk (angles, forces, EMG), the folder of a run, or the folder of a model."),
    ],
    out: Annotated[
        Path,
        typer.Option(
            "--out", help="File to write: .csv, .tsv, .parquet, .mot, .sto; .onnx for a model; a folder for a run."
        ),
    ],
    rate: Annotated[float, typer.Option(min=1.0, help="Sampling rate of the result [samples per second].")] = 100.0,
    stream: Annotated[list[str] | None, typer.Option(help="Only this stream, such as emg; may be repeated.")] = None,
    labels: Annotated[
        bool, typer.Option("--labels", help="Keep labels that are not in the vocabulary; default: numbered names.")
    ] = False,
    parquet: Annotated[bool, typer.Option("--parquet", help="Write tables of a run as Parquet, not CSV.")] = False,
    mot: Annotated[
        bool, typer.Option("--mot", help="For a run, also write the mean cycle of each foot as .mot.")
    ] = False,
) -> None:
    """Resample EMG, force and kinematics of one walk to one time base, with a low-pass for faster signals.

    For a run with pooled cycles, write cycles, curves, means and spatiotemporal values, each as one tidy table.
    """
    from gaitdisc.own_files import claim_file

    if len(files) == 1 and (files[0] / "run.json").is_file():
        _cycles(files[0], out, parquet, mot)
        return
    claim_file(out)
    if out.suffix.lower() == ".onnx":
        from gaitdisc.reconstruction.model_folder import load_model
        from gaitdisc.reconstruction.onnx_file import write_onnx

        if len(files) != 1:
            raise SchemaError("an .onnx file must contain one model", f"found {len(files)}", "Name one model folder.")
        model = load_model(files[0])
        write_onnx(model, out)
        what = model.reconstructor.sensing
        typer.echo(f"{out}: {model.reconstructor.kind}, {', '.join(what.sensors)} to {len(what.states)} states")
        return
    from gaitdisc.ingest.public_words import with_public_labels
    from gaitdisc.ingest.reading import read_trial, write_recording
    from gaitdisc.processing.process import on_one_base

    together = on_one_base(read_trial(files), rate, tuple(stream) if stream else None)
    if not labels:
        together, count = with_public_labels(together)
        if count:
            LOG.info(f"Labels outside the vocabulary were replaced by numbered names ({count}); see --labels.")
    write_recording(together, out)
    typer.echo(f"{out}: {len(together.names)} channels, {len(together.time)} samples at {together.rate_hz:g} Hz")


def _cycles(run_folder: Path, out: Path, parquet: bool, mot: bool) -> None:
    from gaitdisc.ingest.storage import write_storage
    from gaitdisc.own_files import claim_folder
    from gaitdisc.processing.tables import all_curves, all_cycles, all_means, all_spatiotemporal, mean_recordings
    from gaitdisc.response.participant_response import load_run
    from gaitdisc.spreadsheet import write_csv
    from gaitdisc.whole_file import whole_file

    run = load_run(run_folder)
    if not run.cycles:
        raise SchemaError(
            "tables of cycles must come from a run with pooled cycles",
            f"{run_folder.name} contains walks with fitted models",
            "Use the tables of these walks in report/tables.",
        )
    tables = {
        "cycles": all_cycles(run.cycles),
        "curves": all_curves(run.cycles),
        "means": all_means(run.cycles),
        "spatiotemporal": all_spatiotemporal(run.cycles),
    }
    claim_folder(out, *(f"{name}.{'parquet' if parquet else 'csv'}" for name in tables))
    for name, table in tables.items():
        if parquet:
            with whole_file(out / f"{name}.parquet") as part:
                table.to_parquet(part, index=False)
        else:
            write_csv(table, out / f"{name}.csv")
    for name, recording in mean_recordings(run.cycles).items() if mot else ():
        write_storage(recording, out / f"{name}.mot")
        typer.echo(f"{out / name}.mot: {len(recording.names)} channels")
    counts = ", ".join(f"{name} {len(table)}" for name, table in tables.items())
    typer.echo(f"{out}: rows of {counts}")
