"""`gaitdisc report`: the report of a run, drawn again."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer


def report(run_folder: Annotated[Path, typer.Argument(metavar="RUN", help="Folder of a run.")]) -> None:
    """Draw the report of a run again, without fitting."""
    from gaitdisc.report.response_page import write_report
    from gaitdisc.results.run_store import load_run

    page = write_report(load_run(run_folder), run_folder / "report")
    typer.echo(f"report: {page}")
