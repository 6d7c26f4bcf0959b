"""`gaitdisc chapter`: the tables and figures of chapters 3, 4 and 5, computed anew."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from gaitdisc.batch.chapter_parts import Part, costs, parts_of
from gaitdisc.commands.exit_codes import SOME_REFUSED, STOPPED
from gaitdisc.commands.options import Quiet

if TYPE_CHECKING:
    from collections.abc import Callable

NEARLY = 0.97  # of the time that a part is expected to take, as far as the bar goes before it is done


def chapter(
    number: Annotated[int, typer.Argument(metavar="3|4|5", help="The chapter.")],
    out: Annotated[Path, typer.Argument(help="Folder to write; each part has a folder of its own in it.")],
    part: Annotated[str, typer.Option(help="This part alone.")] = "",
    quick: Annotated[bool, typer.Option("--quick", help="A small part of each study, as its test runs it.")] = False,
    data: Annotated[
        Path | None, typer.Option(help="Folder of real recordings, gait/ and fields/; by default GAITDISC_DATA.")
    ] = None,
    quiet: Quiet = False,
) -> None:
    """Compute a chapter's tables."""
    from gaitdisc.batch.chapter_run import lack_of, run_part

    parts = parts_of(number, part)
    lacks = {one: lack_of(one, data) for one in parts}
    possible = [one for one in parts if part or lacks[one] is None]
    with _progress(possible, quick, quiet) as begun:
        try:
            for one in possible:
                made = run_part(one, out, quick, data, begun(one))
                typer.echo(f"{one.name}: {'kept as it stands' if made.kept else 'done'}: {made.folder}")
        except KeyboardInterrupt:
            typer.echo("Stopped. What was finished is kept; the same command goes on from there.", err=True)
            raise typer.Exit(STOPPED) from None
    for one in parts:
        if one not in possible:
            typer.echo(f"left out: {lacks[one]}", err=True)
    if len(possible) < len(parts):
        raise typer.Exit(SOME_REFUSED)


chapter.__doc__ = f"""Compute the tables and figures of chapter 3, 4 or 5 anew, by the studies behind the pages.

What is finished is kept; the same command goes on from where it was stopped. Each part writes its page or tables, and
`printed.md` with what it prints. Minutes are of one core, roughly; in brackets with --quick.

\b
{costs()}
"""


@contextmanager
def _progress(parts: list[Part], quick: bool, quiet: bool) -> Iterator[Callable[[Part], Callable[[float], None]]]:
    """Says which part has begun and about how long the rest takes; a bar where somebody looks on."""
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

    seconds = {one: 60 * (one.quick_minutes if quick else one.minutes) for one in parts}
    columns = (
        TextColumn("{task.description}", markup=False),
        BarColumn(),
        TimeElapsedColumn(),
        TextColumn("left", markup=False),
        TimeRemainingColumn(),
    )
    screen = Console(stderr=True)
    with Progress(*columns, console=screen, transient=True, disable=quiet or not screen.is_terminal) as bar:
        task = bar.add_task("", total=sum(seconds.values()))

        def begun(one: Part) -> Callable[[float], None]:
            before = sum(seconds[other] for other in parts[: parts.index(one)])
            words = f"{one.name}, {parts.index(one) + 1} of {len(parts)}"
            if not quiet:
                left = (sum(seconds.values()) - before) / 60
                typer.echo(f"{words}: about {left:.1f} min of one core left in all", err=True)
            return lambda spent: bar.update(
                task, completed=before + min(spent, NEARLY * seconds[one]), description=words
            )

        yield begun
