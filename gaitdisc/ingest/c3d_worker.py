"""What runs in the isolated process: read one C3D file, hand the numbers back as raw bytes.

ezc3d crashes or hangs on some corrupted files, and no `try` catches that; so it runs here, under a memory cap and a
watchdog, and never in the process of the user. This file is run as a script and imports nothing of the package.

A request is one line of JSON on standard input, an answer one line of JSON on standard output, followed, where the
file was read, by the points (frame, 3 * point) and the analog values (sample, channel) as float64, time first.
"""

from __future__ import annotations

import contextlib
import faulthandler
import json
import math
import os
import sys
import time
import warnings
from importlib.metadata import version
from pathlib import Path
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray

ROWS_AT_ONCE = 16384


def points_in_rows(points: NDArray[np.float64], residuals: NDArray[np.float64]) -> NDArray[np.float64]:
    """Coordinates with time first, NaN where the residual says that a point was not seen.

    points (3 or 4, point, frame): as ezc3d gives them
    residuals (point, frame): negative where a point is invalid
    returns (frame, 3 * point)

    >>> points_in_rows(np.ones((4, 1, 2)), np.array([[0.0, -1.0]]))
    array([[ 1.,  1.,  1.],
           [nan, nan, nan]])
    """
    _, count, frames = points.shape
    rows = np.ascontiguousarray(points[:3].transpose(2, 1, 0))
    rows[residuals.T < 0] = np.nan
    return rows.reshape(frames, 3 * count)


def read_with_ezc3d(path: str) -> tuple[NDArray[np.float64], NDArray[np.float64], object]:
    """Points (frame, 3 * point) and analog values (channel, sample) as ezc3d reads them, in the file's units.

    The file itself comes with them: to take its frames apart takes ezc3d a tenth of the time of reading, which can
    wait until the answer is on its way.
    """
    from ezc3d import ezc3d

    file = ezc3d.c3d(path)
    points, residuals, analog = file.get_points(), file.get_point_residuals(), file.get_analogs()
    return points_in_rows(points, residuals[0]), analog[0], file


def read_with_c3d(path: str) -> tuple[NDArray[np.float64], NDArray[np.float64], object]:
    """Points (frame, 3 * point) and analog values (channel, sample) as the pure-Python reader c3d sees them."""
    import c3d

    with Path(path).open("rb") as handle:
        reader = c3d.Reader(handle)
        frames = [(points, analog) for _, points, analog in reader.read_frames(check_nan=False)]
    if not frames:
        return np.empty((0, 0)), np.empty((0, 0)), None
    points = np.stack([points for points, _ in frames]).astype(float)
    rows = points[:, :, :3]
    rows[points[:, :, 3] < 0] = np.nan
    analog = [analog for _, analog in frames]
    joined = np.concatenate(analog, axis=1) if analog[0].size else np.empty((0, 0))
    return rows.reshape(len(frames), -1), joined, None


READERS = {"ezc3d": read_with_ezc3d, "c3d": read_with_c3d}


def answer(request: dict[str, Any]) -> tuple[dict[str, Any], tuple[Any, ...]]:
    """Answer one request: the numbers if the reader finds the counts that the header promises, or what it said.

    request: `path`, `reader` (`ezc3d` or `c3d`), and the expected `frames`, `points`, `channels` and `samples`
    """
    reader = request["reader"]
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            points, analog, file = READERS[reader](request["path"])
    except MemoryError:
        return {"said": "it ran out of the memory that a file of this size may take"}, ()
    except Exception as error:  # whatever a reader raises is its opinion of the file
        return {"said": f"it stopped with {type(error).__name__}: {error}"}, ()
    found = (
        len(points),
        points.shape[1] // 3,
        analog.shape[1] if analog.size else 0,
        len(analog) if analog.size else 0,
    )
    expected = tuple(request[name] for name in ("frames", "points", "samples", "channels"))
    # A file without points has no frames of points to count.
    if found[1:] != expected[1:] or (expected[1] and found[0] != expected[0]):
        frames, count, samples, channels = found
        said = f"it finds {frames} frames of {count} points and {samples} samples of {channels} analog channels"
        return {"said": said}, ()
    return {"reader": f"{reader} {version(reader)}"}, (points, analog, file)


def serve(requests: IO[bytes], answers: IO[bytes]) -> None:
    """Answer requests until there are no more.

    requests, answers: lines of JSON; arrays follow an answer as raw float64
    """
    for line in iter(requests.readline, b""):
        request = json.loads(line)
        _limit(request["cap_bytes"], request["limit_s"])
        with Path(os.devnull).open("w") as nowhere:
            # If the parent is gone there is nobody to stop a reader that waits for ever but this.
            faulthandler.dump_traceback_later(request["clock_s"] + 5, exit=True, file=nowhere)
            head, arrays = answer(request)
            _send(head, arrays[:2], answers)
            del arrays
            faulthandler.cancel_dump_traceback_later()


def _limit(cap_bytes: int, limit_s: float) -> None:
    """Let the system end this process when it takes more memory, or more processor time from now on."""
    with contextlib.suppress(ImportError, ValueError, OSError):  # Windows has no `resource`
        import resource

        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        resource.setrlimit(resource.RLIMIT_AS, (cap_bytes, resource.getrlimit(resource.RLIMIT_AS)[1]))
        until_s = math.ceil(time.process_time() + limit_s)
        resource.setrlimit(resource.RLIMIT_CPU, (until_s, resource.getrlimit(resource.RLIMIT_CPU)[1]))


def _send(head: dict[str, Any], arrays: tuple[NDArray[np.float64], ...], answers: IO[bytes]) -> None:
    answers.write(json.dumps(head).encode() + b"\n")
    if arrays:
        points, analog = arrays
        if points.size:
            answers.write(memoryview(np.ascontiguousarray(points, dtype=np.float64).data).cast("B"))
        for first in range(0, analog.shape[1] if analog.size else 0, ROWS_AT_ONCE):
            block = np.ascontiguousarray(analog[:, first : first + ROWS_AT_ONCE].T, dtype=np.float64)
            answers.write(memoryview(block.data).cast("B"))
    answers.flush()


if __name__ == "__main__":
    answering = os.fdopen(os.dup(1), "wb")
    with Path(os.devnull).open("w") as nothing:
        os.dup2(nothing.fileno(), 1)  # whatever a library prints must not mix with the answers
    serve(sys.stdin.buffer, answering)
