"""`gaitdisc discover`: what a simulation lacks against measured data, by name, with its numbers, added and shown."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from gaitdisc.commands.options import Quiet
from gaitdisc.errors import LOG, SchemaError
from gaitdisc.own_files import claim_folder

if TYPE_CHECKING:
    from gaitdisc.discovery.result import Discovery
    from gaitdisc.simulation.simulation import Simulation

EVERYONE, ANKLE = "all", "ankle_angle"
FILES = ("discovery.json", "held_out.csv", "augmented.toml", "report.html")


def discover(  # noqa: PLR0913, PLR0917 these are the options of a command
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
    out: Annotated[Path, typer.Option(help="Folder for the results.")] = Path("found"),
    participant: Annotated[
        str,
        typer.Option(
            help="In a study: W01, W01:knee_angle, or all. The Nominal walk calibrates; the device walk is searched."
        ),
    ] = "",
    catalogue: Annotated[Path | None, typer.Option(help="Your own effects, in addition to the included ones.")] = None,
    effects: Annotated[
        str, typer.Option(help="Fit exactly these effects without a search: effect@place, separated by commas.")
    ] = "",
    alpha: Annotated[float, typer.Option(help="Maximum false-positive rate.")] = 0.05,
    draw: Annotated[bool, typer.Option("--report/--no-report", help="Write report.html as well.")] = True,
    quiet: Quiet = False,
) -> None:
    """Identify the effect that the simulation lacks, add it, and report the error on held-out data."""
    if measured is None and not participant:
        raise SchemaError(
            "a discovery needs a simulation file and measured trials, or a study and a participant",
            f"only {simulation.name} is given",
            "Name the measured table after it: gaitdisc discover SIMULATION.toml MEASURED.csv. For a study, add "
            "--participant.",
        )
    if measured is not None:
        claim_folder(out, *FILES)
    began = time.perf_counter()

    def progress(step: str) -> None:
        if not quiet:
            LOG.info("%6.1f s  %s", time.perf_counter() - began, step)

    from gaitdisc.discovery.catalogue import Request
    from gaitdisc.discovery.discover_files import discover_files, discover_study
    from gaitdisc.simulation.simulation_file import names_engine
    from gaitdisc.simulation.writing import write_simulation

    given = tuple(one.strip() for one in effects.split(",") if one.strip())
    request = Request.read(catalogue, given, alpha, progress)
    if measured is not None and names_engine(simulation):
        from gaitdisc.discovery.discover_engine import discover_model_file, write_answer
        from gaitdisc.engines.tracked_mapping import read_tracked

        walk = read_tracked(simulation)
        if walk is not None:
            from gaitdisc.discovery.discover_tracked import discover_tracked, write_tracked

            answered = discover_tracked(walk, measured, request)
            said = (*answered.written.notes, *answered.said)
            _write(answered.found, out, draw, progress, lambda: write_tracked(answered, out), said)
            return
        answer = discover_model_file(simulation, measured, request)
        said = (*answer.written.notes, answer.runs.said)
        _write(answer.found, out, draw, progress, lambda: write_answer(answer, out), said)
        return

    def with_model(found: Discovery, augmented: Simulation, folder: Path) -> None:
        _write(found, folder, draw, progress, lambda: [write_simulation(augmented, folder / "augmented.toml").name])

    if measured is not None:
        with_model(*discover_files(simulation, measured, request), out)
        return
    whose, _, joint = participant.partition(":")

    def discovered(person: str, folder: Path) -> Discovery:
        claim_folder(folder, *FILES)
        found, augmented = discover_study(simulation, person, request, joint or ANKLE)
        with_model(found, augmented, folder)
        return found

    if whose == EVERYONE:
        _everyone(simulation, out, discovered)
    else:
        discovered(whose, out)


def _write(
    found: Discovery,
    out: Path,
    draw: bool,
    progress: Callable[[str], None],
    models: Callable[[], list[str]],
    notes: Sequence[str] = (),
) -> None:
    """Write what was found together with the augmented model, and say it."""
    from gaitdisc.discovery.folder import save_discovery
    from gaitdisc.whole_file import written_together

    with written_together():
        place = save_discovery(found, out, models())
    if draw:
        from gaitdisc.discovery.page import write_discovery_report

        progress("drawing the report")
        place = write_discovery_report(found, out)
    found = found.public
    typer.echo("\n".join([found.sentence, *notes]))
    for finding in found.findings:
        if finding.severity != "note":
            LOG.info(finding.line())
    typer.echo(f"{'report' if draw else 'found'}: {place}")


def _everyone(study: Path, out: Path, discovered: Callable[[str, Path], Discovery]) -> None:
    """Search each participant in turn, each into a folder; who cannot be searched costs nobody else."""
    from gaitdisc.discovery.device_study import lines, over_people
    from gaitdisc.errors import GaitdiscError
    from gaitdisc.ingest.study_file import load_study
    from gaitdisc.spreadsheet import write_csv

    claim_folder(out, "people.csv")
    found: dict[str, Discovery] = {}
    for person in load_study(study).participants:
        typer.echo(f"{person.id}:")
        try:
            found[person.id] = discovered(person.id, out / person.id)
        except GaitdiscError as error:
            LOG.info(f"refused: {error}")
    table = over_people(found)
    write_csv(table, out / "people.csv", "%.6g")
    for line in lines(table):
        typer.echo(line)
