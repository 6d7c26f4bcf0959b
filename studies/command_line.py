"""The command line of a study or a benchmark, read before its slow imports so that `--help` is quick."""

from __future__ import annotations

import argparse
import os
import sys
from pathlib import Path
from typing import Any, NamedTuple

SHARED = Path(os.environ.get("GAITDISC_DATA", Path(__file__).parents[2] / "shared" / "data"))


class Argument(NamedTuple):
    """An argument by position, or with dashes an option, and what argparse is given for it."""

    name: str
    settings: dict[str, Any]


def argument(name: str, meaning: str, default: Any = None, **settings: Any) -> Argument:
    """An argument; the kind of its default decides how it is read, and without one it must be given."""
    if default is False:
        return Argument(name, {"help": meaning, "action": "store_true"})
    if isinstance(default, list):
        settings = {"nargs": "+", "type": type(default[0]), **settings}
    elif default is not None:
        settings = {"type": Path if isinstance(default, Path) else type(default), **settings}
    if not name.startswith("-") and (default is not None or "default" in settings):
        settings = {"nargs": "?", **settings}
    if default is not None:
        shown = " ".join(map(str, default)) if isinstance(default, list) else str(default)
        meaning = f"{meaning} (default: {shown})"
    return Argument(name, {"help": meaning.replace("%", "%%"), "default": default, **settings})


GAIT = argument("data", "folder of the real gait recordings", SHARED / "gait")
RECORDINGS = argument("data", "folder of the real recordings", SHARED)
QUICK = argument("--quick", "a small part of the study, as its test runs it", False)
KEPT = "where recordings, results and the pages go; what is there is not computed again"


def command_line(module: str, description: str | None, *arguments: Argument) -> argparse.Namespace:
    """What was typed; nothing where the file is imported and not run."""
    if module != "__main__":
        return argparse.Namespace()
    script = Path(sys.argv[0])
    parser = argparse.ArgumentParser(
        prog=f"python {script.resolve().parent.name}/{script.name}",
        description=description,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    for name, settings in arguments:
        parser.add_argument(name, **settings)
    return parser.parse_args()


def tables_line(
    module: str, description: str | None, folder: str, tables: tuple[str, ...], further: Argument = QUICK
) -> argparse.Namespace:
    """The command line of a study whose tables are computed one by one, kept beside it and printed again."""
    return command_line(
        module,
        description,
        argument("folder", "where what was computed is kept, recordings and figures", Path(folder)),
        argument("--tables", "which of them are computed", list(tables)),
        argument("--keep", f"write studies/{folder}.csv as well", False),
        argument("--print", "compute nothing; print this table", "", metavar="TABLE"),
        further,
    )
