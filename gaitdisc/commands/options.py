"""Options and arguments that several commands share, and what their exit codes say; 0 is done, 2 is wrong usage."""

from pathlib import Path
from typing import Annotated

import typer

StudyPlace = Annotated[Path, typer.Argument(help="The study file or its folder.")]
Json = Annotated[bool, typer.Option("--json", help="Print JSON instead of tables.")]
Quiet = Annotated[bool, typer.Option("--quiet", "-q", help="Do not show progress.")]
Jobs = Annotated[int, typer.Option("--jobs", "-j", min=1, help="Number of participants computed in parallel.")]
Overwrite = Annotated[bool, typer.Option("--overwrite", help="Replace files that this command did not write.")]
Cluster = Annotated[str, typer.Option(help="Address of a Dask scheduler, such as tcp://host:8786.")]
RunPlace = Annotated[Path | None, typer.Option("--out", help="Folder of the run; by default STUDY/run.")]
REFUSED = 1  # a sentence says what was needed, what was found and what to do
SOME_REFUSED = 3  # done, but some trials or participants were refused and are listed
ENDED = 143  # by the system (SIGTERM)
STOPPED = 130  # by the person at the keyboard; the same command goes on
