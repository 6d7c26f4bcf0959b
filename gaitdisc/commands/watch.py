"""`gaitdisc watch`: the study grows by what is saved into a folder of recordings, once it stands still, and is run."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from time import monotonic, sleep
from typing import TYPE_CHECKING, Annotated

import typer

from gaitdisc.commands.options import REFUSED, STOPPED, Jobs, Overwrite, Quiet
from gaitdisc.commands.run import run
from gaitdisc.errors import LOG, GaitdiscError, ReadError
from gaitdisc.own_files import guard

if TYPE_CHECKING:
    from gaitdisc.ingest.new_study import Looked

STILL_S = 5.0
LOOKS = 5  # in the time for which a file has to stand still


def watch(
    study: Annotated[Path, typer.Argument(help="The study file or its folder; a draft is written if there is none.")],
    recordings: Annotated[Path, typer.Option("--from", help="Folder of recordings; it is not changed.")],
    reference: Annotated[Path | None, typer.Option(help="Folder from `gaitdisc reference`: bands and scores.")] = None,
    still: Annotated[float, typer.Option(min=0.1, help="Time without a change before a file is used [s].")] = STILL_S,
    jobs: Jobs = 1,
    quiet: Quiet = False,
    overwrite: Overwrite = False,
) -> None:
    """Add new trials as they are saved, and run the study each time, until Ctrl-C; nothing is computed twice.

    A file is used when its size and time no longer change. An unreadable file may be incomplete: it is reported and
    read again later. Pseudonyms of the study are kept; trials are only added. The exit code is that of the last run.
    """
    if not recordings.is_dir():
        raise ReadError("the path must be a folder of recordings", f"{recordings} is not a folder", "Create it.")
    file = study if study.suffix == ".toml" else study / "study.toml"
    looked: Looked = {}
    printed: set[str] = set()
    code = 0
    LOG.info(f"Watching {recordings}; press Ctrl-C to end.")
    try:
        for files in WatchedFolder(recordings, file.parent / "run", still).changes():
            if not files:
                continue
            try:
                notes = _grow_study(file, recordings, files, looked)
                for note in (note for note in notes if note not in printed):
                    typer.echo(f"  {note}")
                printed.update(notes)
                with guard("gaitdisc run", [file, *(recordings / path for path in files)], overwrite):
                    run(file, out=None, participant=None, jobs=jobs, cluster="", reference=reference, quiet=quiet)
                code = 0
            except typer.Exit as ended:
                if ended.exit_code == STOPPED:
                    raise
                code = ended.exit_code
            except GaitdiscError as error:
                LOG.info(f"{error} [{error.code}]")
                code = REFUSED
    except KeyboardInterrupt:
        LOG.info("Stopped.")
    raise typer.Exit(code)


def _grow_study(file: Path, recordings: Path, files: list[Path], looked: Looked) -> list[str]:
    """Write the study with what came; what cannot be read yet is not in it, and said in the notes."""
    from gaitdisc.ingest.new_study import draft_study
    from gaitdisc.ingest.study_file import grow_study, load_study, write_study

    draft, notes = draft_study(recordings, file.parent, files, looked)
    if not file.is_file():
        write_study(draft, file)
        return notes
    study = load_study(file)
    grown = grow_study(study, draft)
    if grown != study:
        write_study(grown, file)
    return [note for note in notes if note.startswith("left out")]


class WatchedFolder:
    """Which recordings of a folder stand still, looked at by the clock; no service of the system is needed.

    without: a folder inside of it that is left out: that of the run
    still_s: for how long size and time of a file have to be the same [s]
    """

    def __init__(self, folder: Path, without: Path, still_s: float = STILL_S) -> None:
        self._folder, self._without, self._still_s = folder, without.resolve(), still_s
        self._seen: dict[Path, tuple[tuple[int, int], float]] = {}

    def settled(self) -> dict[Path, tuple[int, int]]:
        """Files that stand still, with size and time; an empty file is one that is not yet written."""
        from gaitdisc.ingest.new_study import read_stamp, recording_files

        now, before = monotonic(), self._seen
        self._seen = {}
        for file in recording_files(self._folder):
            if self._without in (self._folder / file).resolve().parents:
                continue
            stamp = read_stamp(self._folder / file)
            same = before.get(file, (None, now))
            self._seen[file] = (stamp, same[1] if same[0] == stamp else now)
        return {file: stamp for file, (stamp, since) in self._seen.items() if stamp[0] and now - since >= self._still_s}

    def changes(self) -> Iterator[list[Path]]:
        """All files that stand still, each time there are others than before; not while one that counted changes."""
        last: dict[Path, tuple[int, int]] = {}
        while True:
            settled = self.settled()
            if settled != last and not [file for file in last if file in self._seen and file not in settled]:
                last = settled
                yield list(settled)
            else:
                sleep(self._still_s / LOOKS)
