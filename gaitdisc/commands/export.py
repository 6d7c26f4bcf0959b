"""`gaitdisc export`: the streams of one walk on one time base."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer


def export(
    files: Annotated[list[Path], typer.Argument(help="Files of one walk: angles, forces, EMG.")],
    out: Annotated[Path, typer.Option("--out", help="File to write: .csv, .tsv, .parquet, .mot or .sto.")],
    rate: Annotated[float, typer.Option(min=1.0, help="Samples a second of the result.")] = 100.0,
    stream: Annotated[list[str] | None, typer.Option(help="Only this stream; may be repeated.")] = None,
) -> None:
    """Bring EMG, force and kinematics of one walk to one time base, low-passed where they are faster than it."""
    from gaitdisc.ingest.reading import read_trial
    from gaitdisc.ingest.storage import write_storage
    from gaitdisc.ingest.table import write_table
    from gaitdisc.processing.one_base import on_one_base

    together = on_one_base(read_trial(files), rate, tuple(stream) if stream else None)
    write = write_storage if out.suffix.lower() in (".mot", ".sto") else write_table
    write(together, out)
    typer.echo(f"{out}: {len(together.names)} channels, {len(together.time)} samples at {together.rate_hz:g} Hz")
