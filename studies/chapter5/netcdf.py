"""Variables of a netCDF file: classic by scipy, netCDF-4 by the extra `fields`."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gaitdisc.errors import ReadError
from gaitdisc.ingest.hdf5 import attributes, data_set, hdf5_file, is_hdf5, member_names

ATTRIBUTES = ("units", "scale_factor", "add_offset", "missing_value", "_FillValue")


@dataclass(frozen=True, eq=False)
class Variable:
    """One variable as it is stored."""

    stored: NDArray[Any]  # , any shape, packed numbers
    attributes: Mapping[str, Any]

    @property
    def units(self) -> str:
        """Unit as the file states it; empty where it states none."""
        found = self.attributes.get("units", "")
        return found.decode("utf-8", "replace") if isinstance(found, bytes) else str(found)

    def unpacked(self) -> NDArray[np.float32]:
        """Return the numbers that are meant, NaN where the file marks one as missing."""
        values = np.array(self.stored, dtype=np.float32)
        for mark in ("missing_value", "_FillValue"):
            if mark in self.attributes:
                values[self.stored == np.ravel(self.attributes[mark])[0]] = np.nan
        values *= np.float32(_number(self.attributes, "scale_factor", 1.0))
        values += np.float32(_number(self.attributes, "add_offset", 0.0))
        return values


def read_variables(path: Path, names: tuple[str, ...]) -> dict[str, Variable]:
    """Read variables of a netCDF file."""
    if is_hdf5(path):
        with hdf5_file(path) as file:
            _refuse_absent(path, names, member_names(file, path))
            return {
                name: Variable(data_set(file, name, path), attributes(file, name, path, ATTRIBUTES)) for name in names
            }
    from scipy.io import netcdf_file

    try:
        with netcdf_file(path, mmap=False) as file:
            _refuse_absent(path, names, tuple(file.variables))
            found = {name: file.variables[name] for name in names}
            return {name: Variable(_native(each.data), dict(each._attributes)) for name, each in found.items()}
    except (TypeError, ValueError, IndexError, KeyError) as error:
        if isinstance(error, ReadError):
            raise
        raise ReadError(
            f"{path.name} is to be read as netCDF", f"it cannot be: {error}", "Fetch the file again, whole."
        ) from error


def _native(values: NDArray[Any]) -> NDArray[Any]:
    return np.asarray(values).astype(np.asarray(values).dtype.newbyteorder("="))


def _number(attributes: Mapping[str, Any], name: str, without: float) -> float:
    return float(np.ravel(attributes.get(name, without))[0])


def _refuse_absent(path: Path, names: tuple[str, ...], there: tuple[str, ...]) -> None:
    absent = [name for name in names if name not in there]
    if absent:
        raise ReadError(
            f"{path.name} needs the variables {', '.join(names)}",
            f"it lacks {', '.join(absent)}; it has {', '.join(there) or 'none'}",
            "Name the file that holds them.",
        )
