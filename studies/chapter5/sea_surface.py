"""Sea-surface temperature: NOAA's weekly optimum interpolation, and the file that SHRED was published with."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from gaitdisc.errors import ReadError, ShapeError, UnitError
from gaitdisc.ingest.hdf5 import is_hdf5
from gaitdisc.ingest.raw_file import file_sha256
from gaitdisc.recording import Axis, Field, Source

from .netcdf import read_variables

WEEK_DAYS = 7.0
CELSIUS = ("degc", "c", "celsius", "degree_c", "degrees_c", "deg c", "degrees celsius")
MAT_GRID = (180, 360)  # one degree, first row the northernmost, from the meridian of Greenwich eastwards


def read_oisst(path: Path, mask: Path | None = None) -> Field:
    """Read NOAA's weekly sea-surface temperature (`sst.wkmean.1990-present.nc`).

    NOAA's file holds a number on land too, filled in from the sea around: `lsmask.nc` marks what is sea. A cell that
    misses a value in any week is left out as well.

    Source: Reynolds et al. 2002, An improved in situ and satellite SST analysis for climate.
    """
    found = read_variables(path, ("sst", "lat", "lon", "time"))
    unit = found["sst"].units
    if unit.lower() not in CELSIUS:
        raise UnitError("sea-surface temperature is needed in degrees Celsius", f"{path.name} states {unit!r}",
                        "Convert the file, or correct its attribute `units`.")  # fmt: skip
    sst = found["sst"].unpacked()
    lat, lon = (np.asarray(found[name].stored, np.float64) for name in ("lat", "lon"))
    days = np.asarray(found["time"].stored, float) * _days(found["time"].units, path)
    if sst.shape != (len(days), len(lat), len(lon)):
        raise ShapeError("`sst` is needed as (time, lat, lon)", f"{path.name} has {sst.shape}", "Reorder the file.")
    sea = np.asarray(np.isfinite(sst).all(axis=0))
    if mask is not None:
        sea &= _sea(mask, sea.shape)
    axes = (Axis("lat", lat, "deg"), Axis("lon", lon, "deg"))
    source = Source(path.name, file_sha256(path), "netCDF")
    weeks = (days - days[0]) / WEEK_DAYS if len(days) else days
    return Field(weeks, sst[:, sea][:, :, None], axes, sea, ("sst",), ("degC",), "week", source)


def read_sst_mat(path: Path) -> Field:
    """Read the `SST_data.mat` that comes with SHRED's code: 1,400 weeks on a grid of one degree.

    The file has no coordinates and no time. They are taken as in NOAA's weekly files, from which it was made: rows
    from 89.5 degrees north to 89.5 south, columns from 0.5 to 359.5 degrees east. Land is 0 in every week.

    Source: Williams, Zahn and Kutz 2024, Sensing with shallow recurrent decoder networks (its public code).
    """
    from scipy.io import loadmat

    needed = f"{path.name} is to be read as SHRED's SST_data.mat"
    if is_hdf5(path):
        raise ReadError(needed, "it is a MATLAB file of version 7.3", "Save it anew with `save -v7`.")
    with path.open("rb") as file:
        head = file.read(20)
    if head.startswith(b"version https://git"):
        raise ReadError(needed, "it is a pointer of Git LFS, not the file", "Fetch it with `git lfs pull`.")
    try:
        held = loadmat(path)
    except (ValueError, TypeError, OSError, NotImplementedError, EOFError) as error:
        raise ReadError(needed, f"it cannot be: {error}", "Fetch the file again, whole.") from error
    cells = int(np.prod(MAT_GRID))
    z = held.get("Z")
    if z is None or z.ndim != 2 or z.shape[0] != cells:
        there = ", ".join(f"{k} {np.shape(v)}" for k, v in held.items() if not k.startswith("__"))
        raise ReadError(f"{needed}, with Z of shape ({cells}, weeks)", f"it holds {there or 'nothing'}",
                        "Name the file that SHRED's code reads.")  # fmt: skip
    values = np.asarray(z.T, np.float32)
    sea = (values != 0).any(axis=0)
    lat, lon = np.linspace(89.5, -89.5, MAT_GRID[0]), np.linspace(0.5, 359.5, MAT_GRID[1])
    axes = (Axis("lat", lat, "deg"), Axis("lon", lon, "deg"))
    source = Source(path.name, file_sha256(path), "mat")
    weeks = np.arange(len(values), dtype=float)
    return Field(weeks, values[:, sea, None], axes, np.reshape(sea, MAT_GRID), ("sst",), ("degC",), "week", source)


def _days(unit: str, path: Path) -> float:
    word = unit.split(" ", maxsplit=1)[0].lower()
    if word not in ("days", "day", "hours", "hour"):
        raise UnitError("time is needed in days or hours", f"{path.name} states {unit!r}", "Correct the attribute.")
    return 1.0 if word.startswith("day") else 1 / 24


def _sea(path: Path, grid: tuple[int, ...]) -> NDArray[np.bool_]:
    found = np.squeeze(read_variables(path, ("mask",))["mask"].stored)
    if found.shape != grid:
        raise ShapeError(
            f"a land mask of the grid of the temperature is needed, {grid}",
            f"{path.name} has {found.shape}",
            "Name the mask that belongs to the file.",
        )
    return found == 1
