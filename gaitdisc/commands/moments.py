"""`gaitdisc moments`: joint moments and powers of a trial from its markers, its force platforms and a static trial."""

from pathlib import Path
from typing import Annotated

import typer


def moments(
    trial: Annotated[list[Path], typer.Argument(help="Files of one walk: a .c3d, or a .trc and a .mot.")],
    static: Annotated[Path, typer.Option("--static", help="Static trial of the same person: .c3d or .trc.")],
    out: Annotated[Path, typer.Option("--out", help="File to write: .csv, .tsv, .parquet, .mot, .sto.")],
    mass: Annotated[float | None, typer.Option(help="Body mass [kg], if the static trial does not state it.")] = None,
    sex: Annotated[str, typer.Option(help="Sex for the segments' inertia, f or m; by default the mean of both.")] = "",
    marker_set: Annotated[
        str, typer.Option(help="Marker set such as plug_in_gait, or its .toml file; by default found from the labels.")
    ] = "",
    force_hz: Annotated[
        float, typer.Option(help="Low-pass cut-off of the ground force [Hz]; the markers' cut-off is 6 Hz.")
    ] = 20.0,
) -> None:
    """Compute internal joint moments [N m/kg] and powers [W/kg]; frames in which a foot's load is unknown are empty."""
    from gaitdisc.ingest.c3d_parameters import read_body_measures
    from gaitdisc.ingest.reading import read_trial, write_recording
    from gaitdisc.kinematics.motion import move_body
    from gaitdisc.kinetics.body_inertia import Person
    from gaitdisc.kinetics.joint_moments import KineticsSettings
    from gaitdisc.kinetics.trial_kinetics import trial_kinetics
    from gaitdisc.own_files import claim_file
    from gaitdisc.processing.markers_to_moments import find_foot_paths
    from gaitdisc.processing.side_checks import check_weight, standing_weight_n

    claim_file(out)
    walk, stood = read_trial(trial), read_trial(static)
    standing, measures = stood.stream("markers"), read_body_measures(static)
    weighed_n = standing_weight_n(stood)
    person = Person(measures.mass_kg if mass is None else mass, sex, weighed_n)
    weighed = check_weight(weighed_n, person.kg, static.name)
    moved = move_body(walk.stream("markers"), standing, marker_set or None, measures)
    settings = KineticsSettings(force_cutoff_hz=force_hz)
    kinetics = trial_kinetics(walk, moved.poses, find_foot_paths(moved), person, settings)
    write_recording(kinetics.moments, out)
    for finding in dict.fromkeys((*stood.findings, *weighed, *walk.findings, *moved.findings, *kinetics.findings)):
        typer.echo(finding.line())
    for step in (step for step in kinetics.steps if step.clean):
        typer.echo(f"foot '{step.side}' was alone on {step.platform} from {step.start:.2f} to {step.end:.2f} s")
    typer.echo(f"{out}: {len(kinetics.moments.names)} channels, {len(kinetics.moments.time)} samples")
