"""`gaitdisc discover`: what a simulation lacks against measured data, by name, with its numbers, added and shown."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Annotated

import typer

from gaitdisc.commands.options import Quiet
from gaitdisc.errors import SchemaError


def discover(
    simulation: Annotated[Path, typer.Argument(metavar="SIMULATION", help="A simulation file (TOML).")],
    measured: Annotated[
        Path | None, typer.Argument(metavar="MEASURED", help="Measured trials (CSV or Parquet).")
    ] = None,
    out: Annotated[Path, typer.Option(help="Folder of what was found.")] = Path("found"),
    catalogue: Annotated[Path | None, typer.Option(help="Effects of your own, beside those that come along.")] = None,
    draw: Annotated[bool, typer.Option("--report/--no-report", help="Write report.html too.")] = True,
    quiet: Quiet = False,
) -> None:
    """Find what the simulation lacks, name it, add it, and show the gap shrink on data that were held out."""
    if measured is None:
        raise SchemaError(
            "a discovery needs a simulation file and measured trials",
            f"only {simulation.name} is given",
            "Name the measured table after it: gaitdisc discover SIMULATION.toml MEASURED.csv.",
        )
    from gaitdisc.batch.discover_files import discover_files
    from gaitdisc.results.discovery_folder import save_discovery
    from gaitdisc.simulation.writing import write_simulation

    began = time.perf_counter()

    def told(step: str) -> None:
        if not quiet:
            typer.echo(f"{time.perf_counter() - began:6.1f} s  {step}", err=True)

    found, augmented = discover_files(simulation, measured, catalogue, told)
    write_simulation(augmented, out / "augmented.toml")
    place = save_discovery(found, out)
    if draw:
        from gaitdisc.report.discovery_page import write_discovery_report

        told("drawing the report")
        place = write_discovery_report(found, out)
    typer.echo(found.sentence)
    for finding in found.findings:
        if finding.severity != "note":
            typer.echo(finding.line(), err=True)
    typer.echo(f"{'report' if draw else 'found'}: {place}")
