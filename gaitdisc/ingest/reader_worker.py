"""What runs in the isolated process: read one file, hand the numbers back as raw bytes.

ezc3d, scipy and HDF5 crash or hang on some corrupted files, and no `try` catches that; so they run here, under a memory
cap and a watchdog, and never in the process of the user. This file is run as a script; it imports nothing of gaitdisc.

A request is one line of JSON on standard input, an answer one line of JSON on standard output, followed by its arrays
as float64: of a C3D file the points (frame, 3 * point) and the analog values (sample, channel), time first.
"""

import contextlib
import faulthandler
import json
import math
import os
import struct
import sys
import time
import warnings
import zipfile
import zlib
from collections.abc import Iterator
from importlib.metadata import version
from pathlib import Path
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray

from gaitdisc.recording.arrays import Values

ROWS_AT_ONCE = 16384


def points_in_rows(points: Values, residuals: Values) -> Values:
    """Points (3 or 4, point, frame) of ezc3d as (frame, 3 * point), NaN where the residual is negative.

    >>> points_in_rows(np.ones((4, 1, 2)), np.array([[0.0, -1.0]]))
    array([[ 1.,  1.,  1.],
           [nan, nan, nan]])
    """
    _, count, frames = points.shape
    rows = np.ascontiguousarray(points[:3].transpose(2, 1, 0))
    rows[residuals.T < 0] = np.nan
    return rows.reshape(frames, 3 * count)


def read_with_ezc3d(path: str) -> tuple[Values, Values, object]:
    """Points (frame, 3 * point) and analog values (channel, sample) as ezc3d reads them, in the file's units.

    The file itself comes with them: to take its frames apart takes ezc3d a tenth of the time of reading, which can
    wait until the answer is on its way.
    """
    from ezc3d import ezc3d

    file = ezc3d.c3d(path)
    points, residuals, analog = file.get_points(), file.get_point_residuals(), file.get_analogs()
    return points_in_rows(points, residuals[0]), analog[0], file


def read_c3d(path: str, *promised: int) -> tuple[dict[str, Any], Any]:
    """Points and analog values of a C3D file, or what was found in place of the promised counts of the header."""
    points, analog, file = read_with_ezc3d(path)
    channels, samples = analog.shape if analog.size else (0, 0)
    counts = (len(points), points.shape[1] // 3, channels, samples)
    # A file without points has no frames of points to count.
    if counts[1:] != promised[1:] or (promised[1] and counts[0] != promised[0]):
        words = f"it finds {counts[0]} frames of {counts[1]} points and {samples} samples of {channels} analog channels"
        return {"said": words}, ()
    shapes = [(promised[0] if promised[1] else 0, 3 * promised[1]), (samples, channels)]
    return {"reader": f"ezc3d {version('ezc3d')}", "shapes": shapes}, (points, analog.T, file)


def read_arrays(path: str, name: str) -> tuple[dict[str, Any], Any]:
    """A `.mat` (to v7) or `.npz` variable as numbers and words; for an empty name all names with claimed bytes."""
    is_packed = path.lower().endswith(".npz")
    if is_packed:
        with zipfile.ZipFile(path) as packed:
            if not name:
                claims = {member.filename.removesuffix(".npy"): member.file_size for member in packed.infolist()}
                return {"claims": claims, "shapes": []}, ()
            with packed.open(f"{name}.npy") as member:
                held = np.lib.format.read_array(member, allow_pickle=False)
    else:
        from scipy.io import loadmat, whosmat

        if not name:
            variables = whosmat(path)
            sizes = [*_element_sizes(path), *[0] * len(variables)]  # a file of v4 has no elements
            claims = {
                name: max(size, math.prod((8, *map(int, shape))))
                for (name, shape, _), size in zip(variables, sizes, strict=False)
            }
            return {"claims": claims, "shapes": []}, ()
        held = loadmat(path, variable_names=[name])[name]
    arrays: list[NDArray[Any]] = []
    return {"tree": _tree(held, arrays), "shapes": [values.shape for values in arrays]}, arrays


def _element_sizes(path: str) -> Iterator[int]:
    """Bytes of each element of a file of v5 to v7, as its tag has them; a packed one's tag is the first unpacked."""
    with Path(path).open("rb") as file:
        order, at = {b"IM": "<", b"MI": ">"}.get(file.read(128)[126:]), 128
        while order and len(tag := file.read(8)) == 8:
            kind, size = struct.unpack(f"{order}II", tag)
            if kind == 15:  # miCOMPRESSED
                yield int(struct.unpack(f"{order}4xI", zlib.decompressobj().decompress(file.read(256), 8))[0])
            else:
                yield size
            at += 8 + size
            file.seek(at)


def _tree(held: Any, arrays: list[NDArray[Any]]) -> Any:
    """Structs as `fields`, cells and arrays of structs as `cells`, arrays of numbers by their place in `arrays`."""
    if not isinstance(held, np.ndarray):
        return type(held).__name__
    if held.dtype.names:
        names = held.dtype.names
        structs = [{"fields": {name: _tree(cell[name], arrays) for name in names}} for cell in held.ravel(order="F")]
        return structs[0] if len(structs) == 1 else {"cells": structs}
    if held.dtype.kind == "O":
        return {"cells": [_tree(cell, arrays) for cell in held.ravel(order="F")]}
    if held.dtype.kind not in "biuf":
        words = {"U": "text", "S": "text", "c": "an array of complex numbers, which a recording cannot contain"}
        return words.get(held.dtype.kind, f"an array of {held.dtype}")
    arrays.append(held)
    return len(arrays) - 1


def read_hdf5_text(path: str, name: str, attribute: str) -> tuple[dict[str, Any], Any]:
    """Text that is an attribute of a data set; where its heap is damaged the library runs in a circle."""
    import h5py

    text = h5py.File(path, "r")[name].attrs[attribute]
    return {"text": text.decode("utf-8", "replace") if isinstance(text, bytes) else str(text), "shapes": []}, ()


READERS = {"ezc3d": read_c3d, "arrays": read_arrays, "hdf5 text": read_hdf5_text}


def answer(request: dict[str, Any]) -> tuple[dict[str, Any], Any]:
    """Answer a request (`path`, `reader`, `wanted`): what the file holds and its arrays, or what the reader said."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            return READERS[request["reader"]](request["path"], *request["wanted"])
    except MemoryError:
        return {"said": "it exceeded the memory limit for a file of this size"}, ()
    except Exception as error:  # whatever a reader raises is its opinion of the file
        return {"said": f"it stopped with {type(error).__name__}: {error}"}, ()


def serve(requests: IO[bytes], answers: IO[bytes]) -> None:
    """Answer requests, lines of JSON, until there are no more; arrays follow an answer as raw float64."""
    for line in iter(requests.readline, b""):
        request = json.loads(line)
        _limit(request["cap_bytes"], request["limit_s"])
        with Path(os.devnull).open("w") as nowhere:
            # If the parent is gone there is nobody to stop a reader that waits for ever but this.
            faulthandler.dump_traceback_later(request["clock_s"] + 5, exit=True, file=nowhere)
            head, arrays = answer(request)
            answers.write(json.dumps(head).encode() + b"\n")
            shapes = head["shapes"] if arrays else ()
            for values, shape in zip(arrays, shapes, strict=False):  # a C3D's file itself comes after its two
                rows = np.atleast_1d(values)
                for first in range(0, len(rows) if math.prod(shape) else 0, ROWS_AT_ONCE):
                    block = np.ascontiguousarray(rows[first : first + ROWS_AT_ONCE], dtype=np.float64)
                    answers.write(memoryview(block.data).cast("B"))
                del values, rows
            answers.flush()
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


if __name__ == "__main__":
    answering = os.fdopen(os.dup(1), "wb")
    with Path(os.devnull).open("w") as nothing:
        os.dup2(nothing.fileno(), 1)  # whatever a library prints must not mix with the answers
    serve(sys.stdin.buffer, answering)
