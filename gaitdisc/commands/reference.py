"""`gaitdisc reference`: the laboratory's own controls, processed as everybody else and kept in one file."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from gaitdisc.commands.options import Jobs
from gaitdisc.commands.run_report import claim_run
from gaitdisc.errors import SchemaError

if TYPE_CHECKING:
    from gaitdisc.saved.study_run import StudyRun

PEOPLE_DEG = 2.0  # six young people have 2.9 deg, without their own means 2.4 (studies/results/recordings.md)


def reference(
    controls: Annotated[Path, typer.Argument(help="Study of controls, its run, or normal data (.gcd, .xlsx).")],
    out: Annotated[Path, typer.Option("--out", help="Folder for reference.json.")],
    group: Annotated[str, typer.Option(help="Use only this group of the study, such as control.")] = "",
    people: Annotated[int, typer.Option(min=0, help="Number of people in the normal data (.gcd, .xlsx).")] = 0,
    jobs: Jobs = 1,
) -> None:
    """Process the controls as a study, and save the mean cycles of their legs for `--reference`."""
    from gaitdisc.clinic.clinical_reference import FILE, save_reference
    from gaitdisc.clinic.like_controls import described, list_groups
    from gaitdisc.clinic.normal_data import ENDINGS
    from gaitdisc.clinic.reference import FEWEST, make_reference
    from gaitdisc.own_files import claim_folder
    from gaitdisc.processing.pooled_cycles import CYCLES

    if controls.suffix.lower() in ENDINGS:
        _keep_normal_data(controls, out, people)
        return
    if controls.is_file() and controls.suffix.lower() != ".toml":
        raise SchemaError(
            "controls must be a study, its run, or normal data (.gcd, .xlsx)",
            f"{controls.name} ends in {controls.suffix!r}",
            "Save a workbook as .xlsx. Give a published table (.csv) directly: gaitdisc run STUDY --reference.",
        )
    claim_folder(out, FILE)
    run = _find_run(controls, jobs)
    cycles = tuple(pooled for pooled in run.of(CYCLES) if not group or pooled.group == group)
    if not cycles:
        groups = ", ".join(sorted({pooled.group or "no group" for pooled in run.of(CYCLES)})) or "no cycles"
        raise SchemaError(
            f"a reference must have controls{f' of group {group!r}' if group else ''} with pooled cycles",
            f"{controls} has {groups}",
            "Name a group of the study, or record walks of several trials.",
        )
    norms = make_reference(cycles, run.title, run.provenance)
    path = save_reference(norms, out)
    for word in norms.legs:
        count = norms.people(word)
        few = f"; fewer than {FEWEST} people: bands are drawn, but no deviation is reported" if count < FEWEST else ""
        typer.echo(f"  {word}: {count} people, {len(norms.of(word))} legs{few}")
        for members in list_groups(norms.of(word)):
            typer.echo(f"    group: {described(members)}")
    typer.echo(f"reference: {path}")


def _keep_normal_data(file: Path, out: Path, people: int) -> None:
    """Write normal data as the table of a published reference; no limits follow from it."""
    from gaitdisc.clinic.clinical_reference import PUBLISHED
    from gaitdisc.clinic.normal_data import read_normal_data
    from gaitdisc.own_files import claim_folder
    from gaitdisc.processing.leg_curves import PROFILE
    from gaitdisc.whole_file import write_whole

    if not people:
        remedy = f"Add the number: gaitdisc reference {file} --out {out} --people 30."
        raise SchemaError("the number of people in normal data must be given", "it is missing", remedy)
    claim_folder(out, PUBLISHED)
    table = read_normal_data(file, people)
    text = table.to_csv(index=False, float_format="%.6g")
    path = write_whole(out / PUBLISHED, f"# normal data of {people} people, from {file.name}\n{text}")
    typer.echo(f"  curves: {', '.join(table['variable'].unique()).replace('_', ' ')}")
    angles = table.loc[table["variable"].isin(PROFILE), "sd"]
    if angles.median() < PEOPLE_DEG:
        words = f"  the median standard deviation of the angles is {angles.median():.1f} deg, but people differ by"
        typer.echo(f"{words} more than {PEOPLE_DEG:g} deg: the data may be cycles of one person")
    typer.echo("  bands and profile scores are computed, but no deviations: limits need data of single legs")
    typer.echo(f"reference: {path}. Its first line is printed on each page; state in it who these people are.")


def _find_run(controls: Path, jobs: int) -> StudyRun:
    """Run of a folder, or of a study, which is computed as far as it is not."""
    from gaitdisc.saved.study_run import StudyRun, load_run_as

    if (controls / "run.json").is_file():
        return load_run_as(StudyRun, controls)
    from gaitdisc.run.run_study import run_study
    from gaitdisc.run.workers import Workers

    study, folder = claim_run(controls, None)
    return run_study(study, folder, Workers(jobs))
