"""A folder of recordings that is looked at until somebody stops it: files count once they stand still."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from time import monotonic, sleep

from gaitdisc.ingest.new_study import read_stamp, recording_files

STILL_S = 5.0
LOOKS = 5  # in the time for which a file has to stand still


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
