"""The command line: which commands there are, in the order of the help. Each is a file of `gaitdisc/commands/`.

Exit codes: `gaitdisc/commands/options.py`.
"""

from __future__ import annotations

import logging
import signal
import sys
from collections.abc import Callable
from functools import wraps
from importlib import import_module
from inspect import Parameter, signature
from pathlib import Path
from typing import Annotated, Any

import typer

from gaitdisc._version import __version__
from gaitdisc.commands.options import ENDED, REFUSED, Overwrite
from gaitdisc.errors import LOG, GaitdiscError
from gaitdisc.own_files import guarded

NAMES = (
    "new",
    "check",
    "angles",
    "moments",
    "compare",
    "discover",
    "reconstruct",
    "apply",
    "run",
    "watch",
    "ablate",
    "modalities",
    "sensitivity",
    "reference",
    "report",
    "export",
    "cite",
    "demo",
    "chapter",
    "doctor",
)
COMMANDS: tuple[Callable[..., None], ...] = tuple(
    getattr(import_module(f"gaitdisc.commands.{name}"), name) for name in NAMES
)

app = typer.Typer(add_completion=False, no_args_is_help=True, rich_markup_mode=None, pretty_exceptions_enable=False)
UNGUARDED = ("check", "doctor", "watch")  # two that write nothing, and one that guards each of its runs


def _guarded(command: Callable[..., None]) -> Callable[..., None]:
    """The command with `--overwrite`, which replaces no input of it and no file that is not its own."""

    @wraps(command)
    def writing(*, overwrite: bool, **given: Any) -> None:
        values = [value if isinstance(value, list) else [value] for name, value in given.items() if name != "out"]
        paths = [Path(one) for value in values for one in value if isinstance(one, str | Path)]
        with guarded(f"gaitdisc {command.__name__}", paths, overwrite):
            command(**given)

    own = signature(command, eval_str=True)
    option = Parameter("overwrite", Parameter.KEYWORD_ONLY, default=False, annotation=Overwrite)
    writing.__signature__ = own.replace(parameters=[*own.parameters.values(), option])  # type: ignore[attr-defined]
    writing.__annotations__ = {**command.__annotations__, "overwrite": Overwrite}
    return writing


for _command in COMMANDS:
    app.command()(_command if _command.__name__ in UNGUARDED else _guarded(_command))


def _version(wanted: bool) -> None:  # called at the start of every command
    LOG.handlers[:] = [logging.StreamHandler()]  # the standard error stream of this call
    LOG.setLevel(logging.INFO)
    if wanted:
        typer.echo(f"gaitdisc {__version__}")
        raise typer.Exit


@app.callback()
def _about(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Print the version.")
    ] = False,
) -> None:
    """Where a model of walking and measured gait disagree, and what the difference is."""


def main() -> None:
    """Run the command line; a refusal is printed as its sentence, never as a traceback."""
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(ENDED))  # files that are not whole are cleared away first
    try:
        app()
    except GaitdiscError as error:
        typer.echo(f"{type(error).__name__}: {error} [{error.code}]", err=True)
        sys.exit(REFUSED)
