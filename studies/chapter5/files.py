"""Files of fields: sea-surface temperature, monthly stand-ins, cut-outs of the turbulence database."""

from __future__ import annotations

import re
import zipfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gaitdisc.errors import ReadError, ShapeError, UnitError
from gaitdisc.ingest.hdf5 import SIGNATURE, attributes, data_set, hdf5_file
from gaitdisc.recording import Source
from gaitdisc.recording.field import Axis, Field
from gaitdisc.regular_file import check_regular, file_sha256

ATTRIBUTES = ("units", "scale_factor", "add_offset", "missing_value", "_FillValue")
WEEK_DAYS, DAYS = 7.0, {"days": 1.0, "day": 1.0, "hours": 1 / 24, "hour": 1 / 24}
CELSIUS = ("degc", "c", "celsius", "degree_c", "degrees_c", "deg c", "degrees celsius")
MAT_GRID = (180, 360)  # one degree, first row the northernmost, from the meridian of Greenwich eastwards
NAMES = {"velocity": ("u", "v", "w"), "pressure": ("p",)}
COORDINATES = ("zcoor", "ycoor", "xcoor")


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
        scale, offset = (
            np.float32(np.ravel(self.attributes.get(name, without))[0])
            for name, without in (("scale_factor", 1.0), ("add_offset", 0.0))
        )
        return values * scale + offset


def read_head(path: Path) -> bytes:
    """First bytes of a file, which show what it is."""
    try:
        check_regular(path)
        with path.open("rb") as file:
            return file.read(20)
    except OSError as error:
        raise ReadError(f"{path.name} cannot be read", str(error.strerror), "Correct the path.") from error


def read_variables(path: Path, names: tuple[str, ...]) -> dict[str, Variable]:
    """Read variables of a netCDF file."""
    if read_head(path).startswith(SIGNATURE):
        with hdf5_file(path) as file:
            _refuse_absent(path, names, tuple(map(str, file)))
            held = ((name, data_set(file, name, path)) for name in names)
            return {name: Variable(values, attributes(file, name, path, ATTRIBUTES)) for name, values in held}
    from scipy.io import netcdf_file

    try:
        with netcdf_file(path, mmap=False) as file:
            _refuse_absent(path, names, tuple(file.variables))
            found = {name: (np.asarray(file.variables[name].data), file.variables[name]._attributes) for name in names}
            native = {name: values.astype(values.dtype.newbyteorder("=")) for name, (values, _) in found.items()}
            return {name: Variable(native[name], dict(own)) for name, (_, own) in found.items()}
    except (TypeError, ValueError, IndexError, KeyError) as error:
        if isinstance(error, ReadError):
            raise
        needed = f"{path.name} is to be read as netCDF"
        raise ReadError(needed, f"it cannot be: {error}", "Fetch the file again, whole.") from error


def _refuse_absent(path: Path, names: tuple[str, ...], there: tuple[str, ...]) -> None:
    absent = [name for name in names if name not in there]
    if absent:
        lacks = f"it lacks {', '.join(absent)}; it has {', '.join(there) or 'none'}"
        raise ReadError(f"{path.name} needs the variables {', '.join(names)}", lacks, "Name the file that holds them.")


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
    of_time = found["time"].units
    days = np.asarray(found["time"].stored, float) * DAYS.get(of_time.split(" ", maxsplit=1)[0].lower(), np.nan)
    if np.isnan(days).any():
        raise UnitError("time is needed in days or hours", f"{path.name} states {of_time!r}", "Correct the attribute.")
    if sst.shape != (len(days), len(lat), len(lon)):
        raise ShapeError("`sst` is needed as (time, lat, lon)", f"{path.name} has {sst.shape}", "Reorder the file.")
    sea = np.asarray(np.isfinite(sst).all(axis=0))
    if mask is not None:
        marks = np.squeeze(read_variables(mask, ("mask",))["mask"].stored)
        if marks.shape != sea.shape:
            needed = f"a land mask of the grid of the temperature is needed, {sea.shape}"
            raise ShapeError(needed, f"{mask.name} has {marks.shape}", "Name the mask that belongs to the file.")
        sea &= marks == 1
    weeks, source = (days - days[0]) / WEEK_DAYS if len(days) else days, Source(path.name, file_sha256(path), "netCDF")
    return Field(weeks, sst[:, sea][:, :, None], _globe(lat, lon), sea, ("sst",), ("degC",), "week", source)


def read_sst_mat(path: Path) -> Field:
    """Read the `SST_data.mat` that comes with SHRED's code: 1,400 weeks on a grid of one degree.

    The file has no coordinates and no time. They are taken as in NOAA's weekly files, from which it was made: rows
    from 89.5 degrees north to 89.5 south, columns from 0.5 to 359.5 degrees east. Land is 0 in every week.

    Source: Williams, Zahn and Kutz 2024, Sensing with shallow recurrent decoder networks (its public code).
    """
    from scipy.io import loadmat

    needed = f"{path.name} is to be read as SHRED's SST_data.mat"
    head = read_head(path)
    if head.startswith(SIGNATURE):
        raise ReadError(needed, "it is a MATLAB file of version 7.3", "Save it anew with `save -v7`.")
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
    weeks, source = np.arange(len(values), dtype=float), Source(path.name, file_sha256(path), "mat")
    mask = np.reshape(sea, MAT_GRID)
    return Field(weeks, values[:, sea, None], _globe(lat, lon), mask, ("sst",), ("degC",), "week", source)


def _globe(lat: NDArray[Any], lon: NDArray[Any]) -> tuple[Axis, Axis]:
    return Axis("latitude", lat, "deg"), Axis("longitude", lon, "deg")


def read_sst_pacific(path: Path) -> Field:
    """Read 399 months of temperature anomalies of the tropical Pacific, 2 degrees apart; times from January 1970 on."""
    held = _arrays(path, ("sst", "landmask", "lon", "lat"))
    lat, lon = np.unique(held["lat"]), np.unique(held["lon"])
    sea = held["landmask"] == 0
    rows, columns = np.searchsorted(lat, held["lat"]), np.searchsorted(lon, held["lon"])
    if len(sea) != len(lat) * len(lon) or (np.diff(rows * len(lon) + columns) != 1).any():
        needed = "Pacific temperatures are needed on a whole grid, longitude fastest"
        found = f"{path.name} has {len(sea)} cells, {len(lat)} latitudes and {len(lon)} longitudes"
        raise ReadError(needed, found, "Name the file as it was published.")
    months, mask = np.arange(len(held["sst"]), dtype=float), sea.reshape(len(lat), len(lon))
    values, source = held["sst"][:, sea, None], Source(path.name, file_sha256(path), "npz")
    return Field(months, values, _globe(lat, lon), mask, ("sst",), ("degC",), "month", source)


def read_navy_winds(path: Path) -> Field:
    """Read 132 months of winds of the whole globe, 2.5 degrees apart; times are months since January 1970."""
    held = _arrays(path, ("u", "v", "lon", "lat"))
    lat, lon = (np.asarray(held[name], float) for name in ("lat", "lon"))
    if held["u"].shape[1:] != (len(lat), len(lon)) or held["v"].shape != held["u"].shape:
        needed = "winds are needed as u and v of shape (month, lat, lon)"
        shapes = f"{path.name} has {held['u'].shape} and {held['v'].shape}"
        found = f"{shapes} for {len(lat)} latitudes, {len(lon)} longitudes"
        raise ReadError(needed, found, "Name the file as it was published.")
    months = 144.0 + np.arange(len(held["u"]), dtype=float)  # the file begins in January 1982
    values = np.stack([held[name].reshape(len(months), -1) for name in ("u", "v")], axis=-1)
    everywhere, source = np.ones((len(lat), len(lon)), bool), Source(path.name, file_sha256(path), "npz")
    return Field(months, values, _globe(lat, lon), everywhere, ("u", "v"), ("m/s", "m/s"), "month", source)


def _arrays(path: Path, names: tuple[str, ...]) -> dict[str, NDArray[Any]]:
    try:
        check_regular(path)
        with np.load(path, allow_pickle=False) as file:
            return {name: file[name] for name in names}
    except (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile) as error:
        needed = f"{path.name} is to be read as an npz file with {', '.join(names)}"
        raise ReadError(needed, f"it cannot be: {error}", "Fetch the file again, whole.") from error


def read_cutout(paths: Sequence[Path], step_s: float, quantity: str = "velocity") -> Field:
    """Read HDF5 cut-outs, one or several snapshots in each file.

    Source: Li et al. 2008, A public turbulence database cluster and applications to study Lagrangian evolution of
        velocity increments in turbulence.
    """
    if quantity not in NAMES:
        raise ReadError(f"a cut-out holds {' or '.join(NAMES)}", f"requested: {quantity!r}", "Name one of them.")
    names = NAMES[quantity]
    snapshots: dict[int, NDArray[Any]] = {}
    grid: list[NDArray[Any]] = []
    for path in paths:
        with hdf5_file(path) as file:
            numbers, coordinates = _cutout_of(file, path, quantity)
            grid = grid or coordinates
            if any(not np.array_equal(a, b) for a, b in zip(grid, coordinates, strict=True)):
                raise ShapeError("cut-outs are needed of one volume", f"{path.name} has other coordinates than "
                                 f"{paths[0].name}", "Cut all snapshots alike.")  # fmt: skip
            for number, name in numbers.items():
                if number in snapshots:
                    raise ReadError("each snapshot is needed once", f"{path.name} holds {name} again", "Leave one out.")
                held, wanted = data_set(file, name, path), (*map(len, coordinates), len(names))
                if held.shape != wanted:
                    needed = f"{quantity} is needed as (z, y, x, component), here {wanted}"
                    raise ShapeError(needed, f"{path.name} has {held.shape}", "Fetch it anew from the cut-out service.")
                snapshots[number] = held.reshape(-1, len(names)).astype(np.float32)
    if not snapshots:
        raise ReadError("a cut-out is needed", "no file was named", "Name at least one file.")
    order = sorted(snapshots)
    axes = tuple(Axis(name[0], each) for name, each in zip(COORDINATES, grid, strict=True))
    mask = np.ones([len(each) for each in grid], bool)
    values = np.stack([snapshots[number] for number in order])
    time = np.array(order) * step_s
    digest = file_sha256(paths[0]) if len(paths) == 1 else ""
    source = Source(paths[0].name if len(paths) == 1 else f"{len(paths)} cut-outs", digest, "JHTDB cut-out")
    return Field(time - time[0], values, axes, mask, names, ("1",) * len(names), "s", source)


def _cutout_of(file: Any, path: Path, quantity: str) -> tuple[dict[int, str], list[NDArray[Any]]]:
    """Names of the snapshots by their number, and coordinates along each axis."""
    pattern, there = re.compile(rf"{quantity}_(\d+)", re.IGNORECASE), tuple(map(str, file))
    found = {int(match.group(1)): name for name in there if (match := pattern.fullmatch(name))}
    if not found:
        needed, has = f"a cut-out needs data sets {quantity.capitalize()}_0001, ...", ", ".join(there) or "none"
        remedy = f"Request from the service {quantity}, or name the quantity that the file has."
        raise ReadError(needed, f"{path.name} has {has}", remedy)
    absent = [name for name in COORDINATES if name not in there]
    if absent:
        needed = f"a cut-out needs its coordinates {', '.join(COORDINATES)}"
        raise ReadError(needed, f"{path.name} lacks {', '.join(absent)}", "Fetch it anew from the cut-out service.")
    return found, [np.ravel(data_set(file, name, path)).astype(float) for name in COORDINATES]
