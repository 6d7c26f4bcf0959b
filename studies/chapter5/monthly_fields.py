"""Monthly fields that stand in for the dissertation's: Pacific temperature anomalies, and winds of the globe."""

from __future__ import annotations

import zipfile
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gaitdisc.errors import ReadError
from gaitdisc.ingest.raw_file import file_sha256
from gaitdisc.recording import Axis, Field, Source
from gaitdisc.regular_file import check_regular


def read_sst_pacific(path: Path) -> Field:
    """Read 399 months of sea-surface temperature anomalies of the tropical Pacific, 2 degrees apart."""
    held = _arrays(path, ("sst", "landmask", "lon", "lat"))
    lat, lon = np.unique(held["lat"]), np.unique(held["lon"])
    sea = held["landmask"] == 0
    rows, columns = np.searchsorted(lat, held["lat"]), np.searchsorted(lon, held["lon"])
    if len(sea) != len(lat) * len(lon) or (np.diff(rows * len(lon) + columns) != 1).any():
        raise ReadError(
            "Pacific temperatures are needed on a whole grid, longitude fastest",
            f"{path.name} has {len(sea)} cells, {len(lat)} latitudes and {len(lon)} longitudes",
            "Name the file as it was published.",
        )
    axes = (Axis("lat", lat, "deg"), Axis("lon", lon, "deg"))
    months = np.arange(len(held["sst"]), dtype=float)
    mask = sea.reshape(len(lat), len(lon))
    return Field(months, held["sst"][:, sea, None], axes, mask, ("sst",), ("degC",), "month", _source(path))


def read_navy_winds(path: Path) -> Field:
    """Read 132 months of winds of the whole globe, 2.5 degrees apart."""
    held = _arrays(path, ("u", "v", "lon", "lat"))
    lat, lon = (np.asarray(held[name], float) for name in ("lat", "lon"))
    if held["u"].shape[1:] != (len(lat), len(lon)) or held["v"].shape != held["u"].shape:
        raise ReadError(
            "winds are needed as u and v of shape (month, lat, lon)",
            f"{path.name} has {held['u'].shape} and {held['v'].shape} for {len(lat)} latitudes, {len(lon)} longitudes",
            "Name the file as it was published.",
        )
    months = np.arange(len(held["u"]), dtype=float)
    values = np.stack([held[name].reshape(len(months), -1) for name in ("u", "v")], axis=-1)
    axes = (Axis("lat", lat, "deg"), Axis("lon", lon, "deg"))
    everywhere = np.ones((len(lat), len(lon)), bool)
    return Field(months, values, axes, everywhere, ("u", "v"), ("m/s", "m/s"), "month", _source(path))


def _source(path: Path) -> Source:
    return Source(path.name, file_sha256(path), "npz")


def _arrays(path: Path, names: tuple[str, ...]) -> dict[str, NDArray[Any]]:
    try:
        check_regular(path)
        with np.load(path, allow_pickle=False) as file:
            return {name: file[name] for name in names}
    except (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile) as error:
        raise ReadError(
            f"{path.name} is to be read as an npz file with {', '.join(names)}",
            f"it cannot be: {error}",
            "Fetch the file again, whole.",
        ) from error
