"""HDF5 files, netCDF-4 among them: the library is an extra, asked for where such a file is read."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from gaitdisc.errors import ReadError

SIGNATURE = b"\x89HDF\r\n\x1a\n"


def is_hdf5(path: Path) -> bool:
    """Tell whether a file begins as HDF5 does.

    Parameters
    ----------
    path : Path
        The file.

    Raises
    ------
    ReadError
        If it cannot be opened.
    """
    try:
        with path.open("rb") as file:
            return file.read(len(SIGNATURE)) == SIGNATURE
    except OSError as error:
        raise ReadError(f"{path.name} is to be read", str(error.strerror), "Correct the path.") from error


@contextmanager
def hdf5_file(path: Path) -> Iterator[Any]:
    """Open an HDF5 file for reading.

    Parameters
    ----------
    path : Path
        The file.

    Yields
    ------
    h5py.File

    Raises
    ------
    ReadError
        If h5py is not installed, or the file is damaged; the latter also where a data set cannot be decoded.
    """
    try:
        import h5py
    except ImportError as error:
        raise ReadError(
            f"{path.name} is HDF5, which needs the library h5py",
            f"it cannot be imported ({error})",
            "Install the extra: pip install 'gaitdisc[fields]'.",
        ) from error
    try:
        with h5py.File(path, "r") as file:
            yield file
    except OSError as error:
        raise ReadError(
            f"{path.name} is to be read as HDF5", f"it cannot be: {error}", "Fetch the file again; it may be cut short."
        ) from error
