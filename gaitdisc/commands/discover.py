"""`gaitdisc discover`: what a simulation lacks against measured data, by name, with its numbers, added and shown."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Annotated

import typer

from gaitdisc.commands.options import Quiet
from gaitdisc.errors import SchemaError


def discover(
    simulation: Annotated[
        Path,
        typer.Argument(
            metavar="SIMULATION",
            help="A simulation file (TOML), a model (.xml of MuJoCo, .osim), or a study folder with --participant.",
        ),
    ],
    measured: Annotated[
        Path | None, typer.Argument(metavar="MEASURED", help="Measured trials (CSV, Parquet; .mot of a model).")
    ] = None,
    out: Annotated[Path, typer.Option(help="Folder of what was found.")] = Path("found"),
    participant: Annotated[
        str,
        typer.Option(help="Of a study: the Nominal walk's model is the simulation, the device walk what is measured."),
    ] = "",
    catalogue: Annotated[Path | None, typer.Option(help="Effects of your own, beside those that come along.")] = None,
    draw: Annotated[bool, typer.Option("--report/--no-report", help="Write report.html too.")] = True,
    quiet: Quiet = False,
) -> None:
    """Find what the simulation lacks, name it, add it, and show the gap shrink on data that were held out."""
    if measured is None and not participant:
        raise SchemaError(
            "a discovery needs a simulation file and measured trials, or a study and one of its participants",
            f"only {simulation.name} is given",
            "Name the measured table after it: gaitdisc discover SIMULATION.toml MEASURED.csv. "
            "Of a study, add --participant.",
        )
    from gaitdisc.batch.discover_files import discover_files, discover_study
    from gaitdisc.engines.mapping import names_engine
    from gaitdisc.results.discovery_folder import save_discovery
    from gaitdisc.simulation.writing import write_simulation

    began, notes = time.perf_counter(), ()

    def told(step: str) -> None:
        if not quiet:
            typer.echo(f"{time.perf_counter() - began:6.1f} s  {step}", err=True)

    if measured is None:
        found, augmented = discover_study(simulation, participant, catalogue, told)
        write_simulation(augmented, out / "augmented.toml")
    elif names_engine(simulation):
        from gaitdisc.batch.discover_engine import discover_model_file, write_answer

        answer = discover_model_file(simulation, measured, catalogue, told)
        write_answer(answer, out)
        found, notes = answer.found, (*answer.written.notes, answer.runs.said)
    else:
        found, augmented = discover_files(simulation, measured, catalogue, told)
        write_simulation(augmented, out / "augmented.toml")
    place = save_discovery(found, out)
    if draw:
        from gaitdisc.report.discovery_page import write_discovery_report

        told("drawing the report")
        place = write_discovery_report(found, out)
    typer.echo("\n".join([found.sentence, *notes]))
    for finding in found.findings:
        if finding.severity != "note":
            typer.echo(finding.line(), err=True)
    typer.echo(f"{'report' if draw else 'found'}: {place}")
