"""`gaitdisc angles`: joint angles of a trial from its markers and a static trial."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer


def angles(
    trial: Annotated[Path, typer.Argument(help="Markers of the trial: .c3d or .trc.")],
    static: Annotated[Path, typer.Option("--static", help="Markers of the same person standing: .c3d or .trc.")],
    out: Annotated[Path, typer.Option("--out", help="File to write: .csv, .tsv, .parquet, .mot, .sto.")],
    marker_set: Annotated[
        str, typer.Option(help="plug_in_gait, oxford_foot, ..., or a .toml file; recognised by the labels by default.")
    ] = "",
    joints: Annotated[str, typer.Option(help="free, held or planar; as the marker set says by default.")] = "",
    forward: Annotated[
        tuple[float, float, float] | None, typer.Option(help="Direction of walking in the laboratory's axes.")
    ] = None,
    widths: Annotated[
        tuple[float, float, float, float] | None,
        typer.Option(help="Left and right knee, left and right ankle [m], where the static file has none."),
    ] = None,
) -> None:
    """Joint angles from markers, with the package's signs; widths are taken from the static C3D where it has them."""
    from dataclasses import replace

    from gaitdisc.ingest.c3d_measures import body_measures_in
    from gaitdisc.ingest.reading import read_trial
    from gaitdisc.ingest.storage import write_storage
    from gaitdisc.ingest.table import write_table
    from gaitdisc.kinematics.motion import moved_body

    walk, stood = (read_trial(file) for file in (trial, static))
    markers, standing = walk.stream("markers"), stood.stream("markers")
    measures = body_measures_in(static)
    if widths is not None:
        knees, ankles = (dict(zip("lr", pair, strict=True)) for pair in (widths[:2], widths[2:]))
        measures = replace(measures, knee_width_m=knees, ankle_width_m=ankles)
    found = moved_body(markers, standing, marker_set or None, measures, forward, joints or None).motion
    write = write_storage if out.suffix.lower() in (".mot", ".sto") else write_table
    write(found.angles, out)
    for finding in dict.fromkeys((*stood.findings, *walk.findings, *found.findings)):
        typer.echo(finding.line())
    typer.echo(f"{out}: {len(found.angles.names)} channels, {len(found.angles.time)} samples")
