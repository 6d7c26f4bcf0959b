"""`gaitdisc angles`: joint angles of a trial from its markers and a static trial."""

from pathlib import Path
from typing import Annotated

import typer


def angles(
    trial: Annotated[Path, typer.Argument(help="Markers of the trial (.c3d, .trc), or segments of Theia3D (.c3d).")],
    out: Annotated[Path, typer.Option("--out", help="File to write: .csv, .tsv, .parquet, .mot, .sto.")],
    static: Annotated[
        Path | None,
        typer.Option("--static", help="Static trial of the same person (.c3d, .trc); not needed for segments."),
    ] = None,
    marker_set: Annotated[
        str, typer.Option(help="Marker set such as plug_in_gait, or its .toml file; by default found from the labels.")
    ] = "",
    joints: Annotated[
        str, typer.Option(help="Type of joints: free, held (at joint centres), planar; default: that of the marker set")
    ] = "",
    forward: Annotated[
        tuple[float, float, float] | None, typer.Option(help="Walking direction x y z; default: along the pelvis path.")
    ] = None,
    widths: Annotated[
        tuple[float, float, float, float] | None,
        typer.Option(help="Widths of left knee, right knee, left ankle, right ankle [m], if the static file has none."),
    ] = None,
) -> None:
    """Compute joint angles from markers or segments; by default, joint widths come from the static C3D file."""
    from dataclasses import replace

    from gaitdisc.ingest.c3d_parameters import read_body_measures
    from gaitdisc.ingest.reading import read_trial, write_recording
    from gaitdisc.kinematics.motion import move_body, segment_angles
    from gaitdisc.own_files import claim_file
    from gaitdisc.recording.trial import BodyMeasures

    claim_file(out)
    walk = read_trial(trial)
    seen = [*walk.findings]
    if static is None and "segments" in walk.streams:
        recording, made = segment_angles(walk.stream("segments"))
    else:
        stood = read_trial(static) if static is not None else None
        measures = read_body_measures(static) if static is not None else BodyMeasures()
        if widths is not None:
            knees, ankles = (dict(zip("lr", pair, strict=True)) for pair in (widths[:2], widths[2:]))
            measures = replace(measures, knee_width_m=knees, ankle_width_m=ankles)
        standing = stood.stream("markers") if stood is not None else None
        moved = move_body(walk.stream("markers"), standing, marker_set or None, measures, forward, joints or None)
        recording, made = moved.angles, moved.findings
        seen = [*(stood.findings if stood is not None else ()), *seen]
    write_recording(recording, out)
    for finding in dict.fromkeys((*seen, *made)):
        typer.echo(finding.line())
    typer.echo(f"{out}: {len(recording.names)} channels, {len(recording.time)} samples")
