"""HDF5 files, netCDF-4 among them: the library is an extra, needed where such a file is read."""

from collections.abc import Collection, Iterator
from contextlib import closing, contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gaitdisc.errors import GaitdiscError, ReadError
from gaitdisc.ingest.reader_process import ReaderProcess, find_limits
from gaitdisc.regular_file import LARGEST_BYTES, check_regular

TEXT_LIMIT_S = 10.0  # of processor time; a text takes a thousandth of it
SIGNATURE = b"\x89HDF\r\n\x1a\n"


@contextmanager
def hdf5_file(path: Path) -> Iterator[Any]:
    """Open an HDF5 file for reading, and say in words what the library finds wrong with it."""
    try:
        import h5py
    except ImportError as error:
        raise ReadError(
            f"{path.name} is an HDF5 file, which requires the library h5py",
            f"h5py cannot be imported ({error})",
            "Install the extra: pip install 'gaitdisc[fields]'.",
        ) from error
    try:
        check_regular(path)
        with h5py.File(path, "r") as file:
            yield file
    except GaitdiscError:
        raise
    except Exception as error:  # its errors have no common ancestor
        reason = " ".join(str(error).split())[:200] or type(error).__name__
        raise ReadError(
            f"{path.name} must be an HDF5 file",
            f"it cannot be read: {reason}",
            "Download or copy the file again. It may be incomplete.",
        ) from error


def data_set(file: Any, name: str, path: Path) -> NDArray[Any]:
    """Numbers of one data set."""
    held = file[name]
    kind = getattr(getattr(held, "dtype", None), "kind", "")
    if kind not in tuple("iuf"):
        raise ReadError(
            f"{path.name}: {name!r} must be a data set of numbers",
            f"it is {'of another type' if kind else 'missing'}",
            "Download or copy the file again. It may be damaged.",
        )
    if held.nbytes > LARGEST_BYTES:
        raise ReadError(
            f"{path.name}: a data set may have at most {LARGEST_BYTES} bytes",
            f"{name!r} claims {held.nbytes} bytes",
            "Extract a part of it, or download the file again. It may be damaged.",
        )
    return np.asarray(held[()])


def attributes(file: Any, name: str, path: Path, keys: Collection[str]) -> dict[str, Any]:
    """Attributes of one data set, as far as it has them.

    A text of variable length is read by another process under a time limit: where its heap is damaged the library
    runs in a circle, and nothing can stop it from within.
    """
    values = {}
    held = file[name].attrs
    for key in (key for key in keys if key in held):
        if held.get_id(key).dtype.kind != "O":
            values[key] = held[key]
            continue
        limits = {**find_limits(check_regular(path)), "limit_s": TEXT_LIMIT_S}
        with closing(ReaderProcess()) as process:
            answer, _ = process.read(path, "hdf5 text", (name, key), **limits)
        if "text" not in answer:
            raise ReadError(
                f"{path.name} must be an HDF5 file",
                f"attribute {key!r} of {name!r} cannot be read: {answer['said']}",
                "Download or copy the file again. It is damaged.",
            )
        values[key] = str(answer["text"])
    return values
