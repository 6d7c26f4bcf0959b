"""What a search has fitted, kept beside its output until the answer stands: a command that was stopped continues.

A search is deterministic: each of its results follows from the model, the data, the code and the results before. A hash
of all these is its key, so that no result stands in for another.
"""

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from contextvars import ContextVar
from dataclasses import dataclass, field
from hashlib import sha256
from pathlib import Path
from typing import Any

from gaitdisc.errors import GaitdiscError
from gaitdisc.processing.kept_parts import FOLDER, hash_content, keep_part, read_part
from gaitdisc.saved.provenance import list_versions
from gaitdisc.whole_file import remove_file
from gaitdisc.words import counted

NAME = "discovery"
SILENT_S = 9.0  # after which a line says how much is done
SAVED_S = 20.0  # between two times that the file is written


@dataclass
class Work:
    """What is fitted so far, and what an earlier run had fitted when it was stopped."""

    folder: Path
    say: Callable[[str], None]
    key: str  # of the code that computes
    known: dict[str, Any]  # of the earlier run, as far as this one may still come to it
    chain: str = ""  # hash of all that the next result follows from
    done: dict[str, Any] = field(default_factory=dict)
    best: str = ""  # what explains the data best so far
    reported_at: float = field(default_factory=time.perf_counter)  # [s]
    saved: float = field(default_factory=time.perf_counter)  # [s]

    def progress(self, step: str) -> None:
        """Say a step."""
        self.reported_at = time.perf_counter()
        self.say(step)

    def add(self, result: Any) -> None:
        """Keep a result; an earlier run that had not come to it has none that follow from it."""
        known = self.chain in self.known
        if known and not self.done:
            self.progress(f"continuing an earlier run: {counted(len(self.known), 'fit')} reused")
        self.done[self.chain] = result
        if not known:
            self.known = {}
            if time.perf_counter() - self.reported_at > SILENT_S:
                self.progress(f"{counted(len(self.done), 'fit')} done{self.best and f'; so far: {self.best}'}")
            if time.perf_counter() - self.saved > SAVED_S:
                self.save()

    def save(self) -> None:
        """Write all results."""
        keep_part(self.folder, NAME, self.key, self.known | self.done, ())
        self.saved = time.perf_counter()

    def drop(self) -> None:
        """Remove what is written."""
        if (self.folder / FOLDER / f"{NAME}.json").exists():
            remove_file(self.folder / FOLDER / f"{NAME}.json")
            with suppress(OSError):  # other parts of a report may lie there
                (self.folder / FOLDER).rmdir()


_WORK: ContextVar[Work | None] = ContextVar("work", default=None)


@contextmanager
def kept_work(folder: Path, say: Callable[[str], None], anew: bool = False) -> Iterator[Work]:
    """Keep in a folder what is fitted within, until it ends well or in a refusal; use what is there, unless anew."""
    key = hash_content((), repr(list_versions()))
    work = Work(folder, say, key, {})
    if anew:
        work.drop()
    work.known = read_part(folder, NAME, key) or {}
    token = _WORK.set(work)
    try:
        yield work
        work.drop()
    except GaitdiscError:
        work.drop()
        raise
    except BaseException as stop:  # a person or the system
        if work.known or work.done:
            work.save()
        if isinstance(stop, KeyboardInterrupt) and work.best:
            raise KeyboardInterrupt(f"So far: {work.best}; held-out data have not confirmed it yet.") from stop
        raise
    finally:
        _WORK.reset(token)


def recall(*keys: str | bytes) -> Any:
    """Return what an earlier run kept of the next result, which follows from what is given and those before."""
    work = _WORK.get()
    if work is None:
        return None
    digest = sha256(work.chain.encode())
    for key in keys:
        digest.update(key.encode() if isinstance(key, str) else key)
    work.chain = digest.hexdigest()
    if work.chain in work.known:
        work.add(work.known[work.chain])
    return work.known.get(work.chain)


def keep(result: Any) -> None:
    """Keep a result that JSON can hold."""
    work = _WORK.get()
    if work is not None:
        work.add(result)


@contextmanager
def outside_work() -> Iterator[None]:
    """Keep nothing of what is fitted within."""
    token = _WORK.set(None)
    try:
        yield
    finally:
        _WORK.reset(token)


def note_found(words: str) -> None:
    """Note what explains the data best so far."""
    work = _WORK.get()
    if work is not None:
        work.best = words
