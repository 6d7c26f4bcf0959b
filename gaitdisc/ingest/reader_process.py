"""A process of its own in which files are read, so that a crash, a hang or a swollen reader harms nobody else."""

from __future__ import annotations

import contextlib
import json
import os
import signal
import subprocess
import sys
import threading
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray

WORKER = Path(__file__).with_name("c3d_worker.py")
FILES_A_PROCESS = 100  # ezc3d leaks: a long loop in one process dies (pyomeca/ezc3d#314)
SECONDS_AT_LEAST = 10.0
CLOCK = 6.0  # times the processor time: so long is waited by the clock, for others may use the machine as well
MEBIBYTE = 2**20


@dataclass(frozen=True)
class ReadRequest:
    """One file for one reader.

    >>> ReadRequest.of_size("walk.c3d", "ezc3d", (100, 10, 2, 2000), 50 * 2**20).limit_s
    20.0
    """

    path: str
    reader: str
    frames: int  # counts that the file's header promises; `samples` are those of one analog channel
    points: int  # counts that the file's header promises; `samples` are those of one analog channel
    channels: int  # counts that the file's header promises; `samples` are those of one analog channel
    samples: int  # counts that the file's header promises; `samples` are those of one analog channel
    limit_s: float  # processor time after which the reader is stopped; by the clock it is given `CLOCK` times as long
    cap_bytes: int  # address space that the reader may take, where the system can cap it

    @property
    def clock_s(self) -> float:
        """Seconds by the clock after which the reader is stopped, also one that waits for what never comes."""
        return CLOCK * self.limit_s

    @classmethod
    def of_size(cls, path: str, reader: str, counts: tuple[int, int, int, int], size: int) -> ReadRequest:
        """Request with the limits for a file of that size: 10 s + 0.2 s/MB, 512 MB + 12 times the file.

        size: length of the file [bytes]
        """
        limit_s = SECONDS_AT_LEAST + 0.2 * size / MEBIBYTE
        return cls(path, reader, *counts, limit_s=limit_s, cap_bytes=512 * MEBIBYTE + 12 * size)


@dataclass(frozen=True, eq=False)
class RawTrial:
    """Numbers of a C3D file in its own units, time first, or why there are none."""

    points: NDArray[np.float64]  # (frame, 3 * point), NaN where a point was not seen
    analog: NDArray[np.float64]  # (sample, channel), scaled as the file says
    reader: str = ""  # name and version of the reader; empty if it did not read the file
    said: str = ""  # why there are no numbers, empty where there are


_NOTHING = np.empty((0, 0))


class ReaderProcess:
    """An isolated reader: started when first used, started anew when it dies and after 100 files."""

    def __init__(self) -> None:
        self._process: subprocess.Popen[bytes] | None = None
        self._files = 0

    def read(self, request: ReadRequest) -> RawTrial:
        """Numbers of one file, or why the reader could not give them; it never raises for what the file is."""
        process = self._running()
        self._files += 1
        answers: list[RawTrial] = []
        # A pipe cannot be waited on with a time limit on every system; a thread can.
        thread = threading.Thread(target=_converse, args=(process, request, answers), daemon=True)
        thread.start()
        try:
            thread.join(request.clock_s)
            if not thread.is_alive() and answers:
                return answers[0]
            late = thread.is_alive()
        except BaseException:
            self._stop()
            raise
        code = self._stop()
        thread.join(5)
        if late:
            said = f"it had not finished after {request.clock_s:.3g} s"
        elif code == -getattr(signal, "SIGXCPU", np.inf):
            said = f"it had not finished after {request.limit_s:.3g} s of processor time"
        else:
            said = f"it crashed (exit code {code})"
        return RawTrial(_NOTHING, _NOTHING, said=said)

    def close(self) -> None:
        """End the process."""
        self._stop()

    def _running(self) -> subprocess.Popen[bytes]:
        if self._process is not None and (self._files >= FILES_A_PROCESS or self._process.poll() is not None):
            self._stop()
        if self._process is None:
            environment = os.environ | dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"), "1")
            # -P: the folder of this package must not hide the library c3d behind our module of that name.
            self._process = subprocess.Popen(
                [sys.executable, "-P", str(WORKER)],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.DEVNULL,
                env=environment,
            )
            self._files = 0
        return self._process

    def _stop(self) -> int | None:
        process, self._process = self._process, None
        if process is None:
            return None
        with contextlib.suppress(OSError):
            process.kill()
        code = process.wait()
        for stream in (process.stdin, process.stdout):
            with contextlib.suppress(OSError, ValueError):
                if stream is not None:
                    stream.close()
        return code


def _converse(process: subprocess.Popen[bytes], request: ReadRequest, answers: list[RawTrial]) -> None:
    assert process.stdin is not None and process.stdout is not None  # both are pipes
    with contextlib.suppress(OSError, ValueError, EOFError):
        process.stdin.write(json.dumps({**asdict(request), "clock_s": request.clock_s}).encode() + b"\n")
        process.stdin.flush()
        head: dict[str, Any] = json.loads(process.stdout.readline())
        if "said" in head:
            answers.append(RawTrial(_NOTHING, _NOTHING, said=head["said"]))
            return
        points = _received(process.stdout, (request.frames if request.points else 0, 3 * request.points))
        analog = _received(process.stdout, (request.samples, request.channels))
        answers.append(RawTrial(points, analog, head["reader"]))


def _received(stream: IO[bytes], shape: tuple[int, int]) -> NDArray[np.float64]:
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
