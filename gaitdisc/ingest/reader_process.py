"""A process of its own in which files are read, so that a crash, a hang or a swollen reader harms nobody else."""

import contextlib
import json
import os
import signal
import subprocess
import sys
import threading
import weakref
from collections.abc import Callable
from pathlib import Path
from typing import IO, Any

import numpy as np

from gaitdisc.recording.arrays import Values

WORKER = Path(__file__).with_name("reader_worker.py")
FILES_A_PROCESS = 100  # ezc3d leaks: a long loop in one process dies (pyomeca/ezc3d#314)
SECONDS_AT_LEAST = 10.0
CLOCK = 6.0  # times the processor time: so long is waited by the clock, for others may use the machine as well
MEBIBYTE = 2**20
Arrays = list[Values]
Answer = tuple[dict[str, Any], Arrays]


def find_limits(size: int) -> dict[str, Any]:
    """Processor time [s] and address space [bytes] for a file of that size: 10 s + 0.2 s/MB, 512 MB + 12 times it."""
    return {"limit_s": SECONDS_AT_LEAST + 0.2 * size / MEBIBYTE, "cap_bytes": 512 * MEBIBYTE + 12 * size}


class ReaderProcess:
    """An isolated reader: started when first used, started anew when it dies and after 100 files."""

    def __init__(self) -> None:
        self._process: subprocess.Popen[bytes] | None = None
        self._end: Callable[[], int | None] = lambda: None
        self._lock = threading.Lock()  # threads may share a reader; they take turns
        self._files = 0

    def read(self, path: Path, reader: str, wanted: tuple[int | str, ...], limit_s: float, cap_bytes: int) -> Answer:
        """Answer of a reader, and its arrays; `said` in it is why there are none. No file makes it raise.

        reader, wanted: "ezc3d", "arrays" or "hdf5 text", and what it takes: see the functions of reader_worker.py
        limit_s: processor time after which the reader is stopped; by the clock it is given `CLOCK` times as long
        cap_bytes: address space that the reader may take, where the system can cap it
        """
        clock_s = CLOCK * limit_s  # ends also what waits for what never comes
        limits = {"limit_s": limit_s, "cap_bytes": cap_bytes, "clock_s": clock_s}
        request = {"path": str(path), "reader": reader, "wanted": wanted, **limits}
        with self._lock:
            process = self._running()
            self._files += 1
            answers: list[Answer] = []

            def converse() -> None:
                assert process.stdin is not None and process.stdout is not None  # both are pipes
                with contextlib.suppress(Exception):  # whatever a dying reader babbles, there is no answer then
                    process.stdin.write(json.dumps(request).encode() + b"\n")
                    process.stdin.flush()
                    head: dict[str, Any] = json.loads(process.stdout.readline())
                    shapes = () if "said" in head else head["shapes"]
                    answers.append((head, [_receive(process.stdout, shape) for shape in shapes]))

            # A pipe cannot be waited on with a time limit on every system; a thread can.
            thread = threading.Thread(target=converse, daemon=True)
            thread.start()
            try:
                thread.join(clock_s)
                if not thread.is_alive() and answers:
                    return answers[0]
                late = thread.is_alive()
            except BaseException:
                self._stop()
                raise
            code = self._stop()
            thread.join(5)
            if late:
                failure = f"it did not finish within {clock_s:.3g} s"
            elif code == -getattr(signal, "SIGXCPU", np.inf):
                failure = f"it did not finish within {limit_s:.3g} s of processor time"
            else:
                failure = f"it crashed (exit code {code})"
            return {"said": failure}, []

    def close(self) -> None:
        """End the process."""
        with self._lock:
            self._stop()

    def _running(self) -> subprocess.Popen[bytes]:
        if self._process is not None and (self._files >= FILES_A_PROCESS or self._process.poll() is not None):
            self._stop()
        if self._process is None:
            environment = os.environ | dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"), "1")
            # -P: no module of this folder may hide a library's
            self._process = subprocess.Popen(
                [sys.executable, "-P", str(WORKER)],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.DEVNULL,
                env=environment,
            )
            self._end = weakref.finalize(self, _end, self._process)
            self._files = 0
        return self._process

    def _stop(self) -> int | None:
        self._process = None
        return self._end()


def _end(process: subprocess.Popen[bytes]) -> int:
    with contextlib.suppress(OSError):
        process.kill()
    code = process.wait()
    for stream in (process.stdin, process.stdout):
        with contextlib.suppress(OSError, ValueError):
            if stream is not None:
                stream.close()
    return code


def _receive(stream: IO[bytes], shape: tuple[int, ...]) -> Values:
    values = np.empty(shape)
    if values.size:
        view = memoryview(values.data).cast("B")
        at = 0
        while at < len(view):
            count = stream.readinto(view[at:])  # type: ignore[attr-defined]
            if not count:
                raise EOFError("the reader ended in the middle of an answer")
            at += count
    return values
