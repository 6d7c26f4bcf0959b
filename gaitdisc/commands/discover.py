"""`gaitdisc discover`: what a simulation lacks against measured data, by name, with its numbers, added and shown."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from gaitdisc.commands.options import REFUSED, SOME_REFUSED, Quiet
from gaitdisc.commands.run_report import stoppable
from gaitdisc.errors import LOG, SchemaError
from gaitdisc.own_files import claim_folder

if TYPE_CHECKING:
    from gaitdisc.discovery.catalogue import Request
    from gaitdisc.discovery.result import Discovery
    from gaitdisc.simulation.simulation import Simulation

EVERYONE, ANKLE = "all", "ankle_angle"
FILES = ("discovery.json", "held_out.csv", "augmented.toml", "report.html")
PLANNED = 10  # records of each size
KEPT = "kept"  # folder of what is fitted, until the answer stands


def discover(  # noqa: PLR0913, PLR0917 these are the options of a command
    simulation: Annotated[
        Path,
        typer.Argument(
            metavar="SIMULATION",
            help="A simulation file (TOML), a model (.xml of MuJoCo, .osim), or a study folder with --participant.",
        ),
    ],
    measured: Annotated[
        Path | None, typer.Argument(metavar="MEASURED", help="Measured trials: .csv, .parquet; for a model also .mot.")
    ] = None,
    out: Annotated[Path, typer.Option(help="Folder for the results.")] = Path("found"),
    participant: Annotated[
        str, typer.Option(help="In a study: participant (W01 or W01:knee_angle) whose device walk is searched, or all.")
    ] = "",
    catalogue: Annotated[Path | None, typer.Option(help="Your own effects (TOML), added to the included ones.")] = None,
    effects: Annotated[
        str, typer.Option(help="Fit exactly these effects without a search: effect@place, separated by commas.")
    ] = "",
    alpha: Annotated[float, typer.Option(help="Maximum false-positive rate.")] = 0.05,
    twins: Annotated[
        int,
        typer.Option(help="Number of records like yours to simulate and search, with and without the effect.", min=0),
    ] = 0,
    plan: Annotated[
        bool, typer.Option("--plan", help="Before a measurement: report how large --effects must be to be found.")
    ] = False,
    draw: Annotated[bool, typer.Option("--report/--no-report", help="Also write report.html.")] = True,
    quiet: Quiet = False,
) -> None:
    """Identify the effect that the simulation lacks, add it, and report the error on held-out data."""
    if measured is None and not participant:
        raise SchemaError(
            "discover must be given a simulation file and measured trials, or a study and a participant",
            f"only {simulation.name} is given",
            "Name the measured table after it: gaitdisc discover SIMULATION.toml MEASURED.csv. For a study, add "
            "--participant.",
        )
    everyone = measured is None and participant.partition(":")[0] == EVERYONE
    anew = claim_folder(out, *(("people.csv",) if everyone else ("plan.csv",) if plan else FILES), mended=(KEPT,))
    began = time.perf_counter()

    def say(step: str) -> None:
        if not quiet:
            LOG.info("%6.1f s  %s", time.perf_counter() - began, step)

    def write(
        result: Discovery, models: Callable[[Path], list[str]], notes: Sequence[str] = (), folder: Path = out
    ) -> Discovery:
        """Write what was found together with the augmented model, and say it."""
        with write_together():
            place = save_discovery(result, folder, models(folder))
        if draw:
            from gaitdisc.discovery.page import write_discovery_report

            say("drawing the report")
            place = write_discovery_report(result, folder)
        answer = [result.public.sentence, result.chance, *notes] if result.twins is None else [result.twins.sentence]
        typer.echo("\n".join(filter(None, answer)))
        for finding in result.public.findings if result.twins is None else ():
            if finding.severity != "note":
                LOG.info(finding.line())
        typer.echo(f"{'report' if draw else 'found'}: {place}")
        return result

    def with_model(discovery: Discovery, augmented: Simulation, folder: Path = out) -> Discovery:
        return write(discovery, lambda to: [write_simulation(augmented, to / "augmented.toml").name], folder=folder)

    with stoppable(f"the same command{' without --overwrite' * anew}"):
        from gaitdisc.discovery.catalogue import Request
        from gaitdisc.discovery.discover_files import discover_files
        from gaitdisc.discovery.folder import save_discovery
        from gaitdisc.discovery.kept_work import kept_work
        from gaitdisc.discovery.twins import refuse_twins
        from gaitdisc.simulation.simulation_file import names_engine
        from gaitdisc.simulation.writing import write_simulation
        from gaitdisc.whole_file import write_together

        named = tuple(name.strip() for name in effects.split(",") if name.strip())
        with kept_work(out, say, anew) as work:
            request = Request.read(catalogue, named, alpha, work.progress, twins)
            if (twins or plan) and (measured is None or names_engine(simulation)):
                refuse_twins(simulation.name)
            if measured is None:
                _of_study(simulation, participant, request, out, with_model)
            elif names_engine(simulation):
                _of_engine(simulation, measured, request, write)
            elif plan:
                _plan(simulation, measured, replace(request, twins=twins or PLANNED), out)
            else:
                with_model(*discover_files(simulation, measured, replace(request, answered=with_model)))


def _plan(simulation: Path, measured: Path, request: Request, out: Path) -> None:
    """Say from which size on each given effect is found, and write in how many records of each size it was."""
    from gaitdisc.discovery.power import find_power, tabulate_power
    from gaitdisc.simulation.measured_table import read_measured
    from gaitdisc.simulation.simulation_file import read_simulation
    from gaitdisc.spreadsheet import write_csv

    model = read_simulation(simulation)
    powers = find_power(model, read_measured(measured, model), request)
    write_csv(tabulate_power(powers), out / "plan.csv", "%.6g")
    typer.echo("\n".join([*(power.sentence for power in powers), f"plan: {out / 'plan.csv'}"]))


def _of_engine(model: Path, measured: Path, request: Request, write: Callable[..., Discovery]) -> None:
    """Search a model of an engine, or a walk that is tracked in one."""
    from gaitdisc.discovery.discover_engine import discover_model_file, write_answer
    from gaitdisc.engines.tracked_mapping import read_tracked

    if (walk := read_tracked(model)) is not None:
        from gaitdisc.discovery.discover_tracked import discover_tracked, write_tracked

        answered = discover_tracked(walk, measured, request)
        write(answered.found, partial(write_tracked, answered), (*answered.written.notes, *answered.said))
        return
    answer = discover_model_file(model, measured, request)
    write(answer.found, partial(write_answer, answer), (*answer.written.notes, answer.runs.sentence))


def _of_study(
    path: Path, participant: str, request: Request, out: Path, write: Callable[[Discovery, Simulation, Path], Discovery]
) -> None:
    """Compare each condition of a participant, or of all, with the Nominal walk."""
    from gaitdisc.discovery.discover_device import discover_study
    from gaitdisc.ingest.study_file import load_study
    from gaitdisc.saved.unit_folder import unit_name

    whose, _, joint = participant.partition(":")
    study = load_study(path)
    device, others = study.conditions.device or "", study.conditions.others

    def discovered(person: str, folder: Path) -> dict[str, Discovery]:
        places = {device: folder, **{word: folder / unit_name(person, word) for word in others}}
        for place in places.values():
            if place != out:  # which is held already
                claim_folder(place, *FILES)
        answers = discover_study(path, person, request, joint or ANKLE)
        for word, (discovery, augmented) in answers.items():
            if others:
                typer.echo(f"{word}:")
            write(discovery, augmented, places[word])
        for condition in next(iter(answers.values()))[0].conditions:
            if not condition.verdict:
                LOG.info(f"{condition.condition}: refused: {condition.sentence}")
        return {word: discovery for word, (discovery, _) in answers.items()}

    if whose == EVERYONE:
        _everyone([person.id for person in study.participants], out, discovered)
    else:
        discovered(whose, out)


def _everyone(people: Sequence[str], out: Path, discovered: Callable[[str, Path], dict[str, Discovery]]) -> None:
    """Search each participant in turn, each into a folder; who cannot be searched costs nobody else."""
    from gaitdisc.discovery.discover_device import lines, over_conditions
    from gaitdisc.errors import GaitdiscError
    from gaitdisc.spreadsheet import write_csv

    discoveries: dict[str, dict[str, Discovery]] = {}
    for person in people:
        typer.echo(f"{person}:")
        try:
            discoveries[person] = discovered(person, out / person)
        except GaitdiscError as error:
            LOG.info(f"refused: {error}")
    table = over_conditions(discoveries)
    write_csv(table, out / "people.csv", "%.6g")
    for line in lines(table):
        typer.echo(line)
    if len(discoveries) < len(people):
        raise typer.Exit(SOME_REFUSED if discoveries else REFUSED)
