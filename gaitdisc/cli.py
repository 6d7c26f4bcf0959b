"""The command line: which commands there are, in the order of the help. Each is a file of `gaitdisc/commands/`.

Exit codes: `gaitdisc/commands/options.py`.
"""

import gc
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
from typer.core import TyperGroup

from gaitdisc._version import __version__
from gaitdisc.commands.options import ENDED, REFUSED, Overwrite
from gaitdisc.errors import LOG, GaitdiscError
from gaitdisc.own_files import guard

COMMANDS = (
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
UNGUARDED = ("check", "doctor", "watch")  # two that write nothing, and one that guards each of its runs


def _guard(command: Callable[..., None]) -> Callable[..., None]:
    """The command with `--overwrite`, which replaces no input of it and no file that is not its own."""

    @wraps(command)
    def writing(*, overwrite: bool, **given: Any) -> None:
        values = [value if isinstance(value, list) else [value] for name, value in given.items() if name != "out"]
        paths = [Path(item) for value in values for item in value if isinstance(item, str | Path)]
        with guard(f"gaitdisc {command.__name__}", paths, overwrite):
            command(**given)

    base = signature(command, eval_str=True)
    option = Parameter("overwrite", Parameter.KEYWORD_ONLY, default=False, annotation=Overwrite)
    writing.__signature__ = base.replace(parameters=[*base.parameters.values(), option])  # type: ignore[attr-defined]
    writing.__annotations__ = {**command.__annotations__, "overwrite": Overwrite}
    return writing


class _Commands(TyperGroup):
    """The commands of the list: one is loaded when it is called, all when they are listed."""

    def list_commands(self, ctx: Any) -> list[str]:  # noqa: ARG002 form of the group
        return list(COMMANDS)

    def get_command(self, ctx: Any, cmd_name: str) -> Any:  # noqa: ARG002
        for name in (cmd_name,) if cmd_name in COMMANDS else COMMANDS:  # all, to find the one that is misspelt
            if name not in self.commands:
                command = getattr(import_module(f"gaitdisc.commands.{name}"), name)
                alone = typer.Typer(add_completion=False, rich_markup_mode=None)
                alone.command()(command if name in UNGUARDED else _guard(command))
                self.add_command(typer.main.get_command(alone))
        return self.commands.get(cmd_name)


app = typer.Typer(
    cls=_Commands, add_completion=False, no_args_is_help=True, rich_markup_mode=None, pretty_exceptions_enable=False
)


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
    gc.set_threshold(50_000)  # objects, of 700: libraries are no garbage, and looking through them takes a tenth
    try:
        app()
    except GaitdiscError as error:
        typer.echo(f"{type(error).__name__}: {error} [{error.code}]", err=True)
        sys.exit(REFUSED)
    finally:
        gc.freeze()  # nor is it looked for at the end
