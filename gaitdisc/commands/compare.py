"""`gaitdisc compare`: where a simulated and a measured walk, or two conditions, disagree over the stride."""

from pathlib import Path
from typing import Annotated

import typer

from gaitdisc.commands.options import SOME_REFUSED
from gaitdisc.errors import LOG, SchemaError


def compare(  # noqa: PLR0913, PLR0917 these are the options of a command
    first: Annotated[Path, typer.Argument(metavar="SIM", help="File of the first (simulated) walk, or a study.")],
    second: Annotated[
        Path | None, typer.Argument(metavar="MEASURED", help="File of the second (measured) walk.")
    ] = None,
    out: Annotated[
        Path | None, typer.Option(help="Folder of the report; by default ./compare, or STUDY/compare.")
    ] = None,
    participant: Annotated[
        str, typer.Option(help="In a study: compare the strides of this participant; default: a paired test of all.")
    ] = "",
    channel: Annotated[list[str] | None, typer.Option(help="Compare only this channel; may be repeated.")] = None,
    cutoff: Annotated[float, typer.Option(min=1.0, help="For two files: low-pass of angles and moments [Hz].")] = 6.0,
    detector: Annotated[
        str, typer.Option(help="For two files: detector of initial contact (auto, force, events, markers or angles).")
    ] = "auto",
    smallest_angle: Annotated[float, typer.Option(min=0.0, help="Smallest angle difference to report [deg].")] = 2.0,
    smallest_moment: Annotated[float, typer.Option(min=0.0, help="Smallest moment difference to name [N m/kg].")] = 0.1,
    smallest_share: Annotated[
        float, typer.Option(min=0.0, help="Smallest other difference to report, as a fraction of the curve's range.")
    ] = 0.05,
    body_weight: Annotated[
        float | None, typer.Option(min=1.0, help="Body weight [N]; for forces, the fraction refers to it.")
    ] = None,
) -> None:
    """Compare two walks over the stride: where they differ, by how much, and whether significantly."""
    from rich.console import Console

    from gaitdisc.comparison.compare_recordings import compare_files, compare_study
    from gaitdisc.comparison.mismatch import Smallest
    from gaitdisc.comparison.page import mismatch_text, write_mismatch_report
    from gaitdisc.comparison.sentences import mismatch_sentences
    from gaitdisc.ingest.study_file import load_study
    from gaitdisc.own_files import claim_folder

    folder = out or (Path() if second else first.parent if first.is_file() else first) / "compare"
    claim_folder(folder, "mismatch.json", "regions.csv", "summary.csv", "arrays.npz", "report.html")
    channels = tuple(channel or ())
    smallest = Smallest(smallest_angle, smallest_moment, smallest_share, body_weight)
    if second is not None and participant:
        raise typer.BadParameter("--participant requires a study; two files are given")
    if second is not None:
        mismatch = compare_files(first, second, channels, cutoff, detector, smallest)
    elif first.is_file() and first.suffix.lower() != ".toml":
        raise SchemaError(
            "a comparison must have two recordings, or a study",
            f"{first.name} is one recording",
            "Name the measured walk after it: gaitdisc compare SIM MEASURED.",
        )
    else:
        mismatch = compare_study(load_study(first), participant, channels, smallest)
    mismatch.save(folder)
    page = write_mismatch_report(mismatch, folder)
    typer.echo(" ".join(mismatch_sentences(mismatch)))
    Console().print(mismatch_text(mismatch))
    for finding in mismatch.findings:
        if finding.severity != "note":
            LOG.info(finding.line())
    typer.echo(f"report: {page}")
    if any(finding.severity == "refused" for finding in mismatch.findings):
        raise typer.Exit(SOME_REFUSED)
