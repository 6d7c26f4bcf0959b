"""`gaitdisc chapter`: the tables and figures of chapters 3, 4 and 5, computed anew."""

from pathlib import Path
from typing import Annotated

import typer

from gaitdisc.commands.options import SOME_REFUSED, Quiet
from gaitdisc.commands.run_report import stoppable_bar
from gaitdisc.errors import LOG
from gaitdisc.run.chapter_parts import Part, costs, list_parts

NEARLY = 0.97  # of the time that a part is expected to take, as far as the bar goes before it is done


def chapter(
    number: Annotated[int, typer.Argument(metavar="3|4|5", help="Number of the chapter: 3, 4 or 5.")],
    out: Annotated[Path, typer.Argument(help="Folder for the results; each part has its own folder.")],
    part: Annotated[str, typer.Option(help="Compute only this part of the chapter.")] = "",
    quick: Annotated[bool, typer.Option("--quick", help="Compute only a small part of each study as a check.")] = False,
    data: Annotated[
        Path | None, typer.Option(help="Folder that contains gait/ and fields/; by default $GAITDISC_DATA.")
    ] = None,
    quiet: Quiet = False,
) -> None:
    """Compute the tables of a chapter."""
    from gaitdisc.run.chapter_run import find_lack, run_part

    parts = list_parts(number, part)
    lacks = {p: find_lack(p, data) for p in parts}
    possible = [p for p in parts if part or lacks[p] is None]
    seconds = {p: 60 * (p.quick_minutes if quick else p.minutes) for p in possible}
    remaining_s = sum(seconds.values())
    with stoppable_bar(quiet) as bar:
        task = bar.add_task("", total=remaining_s)
        for place, current in enumerate(possible, 1):
            before, words = sum(seconds.values()) - remaining_s, f"{current.name}, {place} of {len(possible)}"
            if not quiet:
                LOG.info(f"{words}: the remaining parts take about {remaining_s / 60:.1f} min on one core")
            remaining_s -= seconds[current]

            def ticked(spent: float, current: Part = current, before: float = before, words: str = words) -> None:
                bar.update(task, completed=before + min(spent, NEARLY * seconds[current]), description=words)

            made = run_part(current, out, quick, data, ticked)
            typer.echo(f"{current.name}: {'kept as it stands' if made.kept else 'done'}: {made.folder}")
    for current in parts:
        if current not in possible:
            LOG.info(f"left out: {lacks[current]}")
    if len(possible) < len(parts):
        raise typer.Exit(SOME_REFUSED)


chapter.__doc__ = f"""Compute the tables, figures and studies of chapter 3, 4 or 5 again.

Finished parts are kept; the same command continues after an interruption. Each part writes its page or tables, and
saves what it prints as `printed.md`. Times are approximate minutes on one core, in brackets with --quick.

\b
{costs()}
"""
