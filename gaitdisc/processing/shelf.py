"""Recordings that wait on disk until all trials of a session have been seen: memory does not grow with their number."""

from __future__ import annotations

import itertools
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from gaitdisc.channel import Channel
from gaitdisc.recording import Recording


@dataclass(frozen=True, eq=False)
class ShelvedRecordings:
    """Recordings of a trial, on disk or, where that has no room, in memory."""

    kept: tuple[Recording, ...]  # with their samples, or with one sample each where these are on disk
    files: tuple[Path, ...] = ()  # where the samples lie; empty where they are in memory

    @property
    def channels(self) -> tuple[Channel, ...]:
        """Channels of all of them."""
        return tuple(channel for recording in self.kept for channel in recording.channels)

    def recordings(self) -> Iterator[Recording]:
        """Return the recordings with their samples, one after the other."""
        if not self.files:
            yield from self.kept
            return
        for recording, file in zip(self.kept, self.files, strict=True):
            with np.load(file, allow_pickle=False) as held:
                yield replace(recording, **{name: held[name] for name in ("time", "values", "suspect")})


@dataclass(frozen=True)
class Shelf:
    """A folder for samples that are needed later."""

    folder: Path
    _numbers: Iterator[int] = field(default_factory=itertools.count, init=False, repr=False, compare=False)

    def put(self, recordings: Sequence[Recording]) -> ShelvedRecordings:
        """Put recordings away."""
        files = []
        try:
            for one in recordings:
                file = self.folder / f"{next(self._numbers)}.npz"
                np.savez(file, time=one.time, values=one.values, suspect=np.asarray(one.suspect))
                files.append(file)
        except OSError:  # no room on disk
            return ShelvedRecordings(tuple(recordings))
        empty = (
            replace(one, time=one.time[:1].copy(), values=one.values[:1].copy(), suspect=np.array(one.suspect)[:1])
            for one in recordings
        )
        return ShelvedRecordings(tuple(empty), tuple(files))


@contextmanager
def shelf() -> Iterator[Shelf]:
    """Shelf that is cleared at the end."""
    with tempfile.TemporaryDirectory(prefix="gaitdisc_", ignore_cleanup_errors=True) as folder:
        yield Shelf(Path(folder))
