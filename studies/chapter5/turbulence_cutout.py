"""Cut-outs of the Johns Hopkins turbulence database, as its cut-out service writes them."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gaitdisc.errors import ReadError, ShapeError
from gaitdisc.ingest.hdf5 import data_set, hdf5_file, member_names
from gaitdisc.ingest.raw_file import file_sha256
from gaitdisc.recording import Axis, Field, Source

NAMES = {"velocity": ("u", "v", "w"), "pressure": ("p",)}
COORDINATES = ("zcoor", "ycoor", "xcoor")


def read_cutout(paths: Sequence[Path], step_s: float, quantity: str = "velocity") -> Field:
    """Read HDF5 cut-outs, one or several snapshots in each file.

    Source: Li et al. 2008, A public turbulence database cluster and applications to study Lagrangian evolution of
        velocity increments in turbulence. The layout is that of the service's files in public use, not of a stated
        standard.
    """
    if quantity not in NAMES:
        raise ReadError(f"a cut-out holds {' or '.join(NAMES)}", f"requested: {quantity!r}", "Name one of them.")
    snapshots: dict[int, NDArray[Any]] = {}
    grid: list[NDArray[Any]] = []
    for path in paths:
        with hdf5_file(path) as file:
            numbers = _numbers(file, path, quantity)
            coordinates = _coordinates(file, path)
            grid = grid or coordinates
            if any(not np.array_equal(a, b) for a, b in zip(grid, coordinates, strict=True)):
                raise ShapeError("cut-outs are needed of one volume", f"{path.name} has other coordinates than "
                                 f"{paths[0].name}", "Cut all snapshots alike.")  # fmt: skip
            for number, name in numbers.items():
                if number in snapshots:
                    raise ReadError("each snapshot is needed once", f"{path.name} holds {name} again", "Leave one out.")
                snapshots[number] = _values(data_set(file, name, path), path, coordinates, quantity)
    if not snapshots:
        raise ReadError("a cut-out is needed", "no file was named", "Name at least one file.")
    order = sorted(snapshots)
    axes = tuple(Axis(name[0], each) for name, each in zip(COORDINATES, grid, strict=True))
    mask = np.ones([len(each) for each in grid], bool)
    values = np.stack([snapshots[number] for number in order])
    time = np.array(order) * step_s
    digest = file_sha256(paths[0]) if len(paths) == 1 else ""
    source = Source(paths[0].name if len(paths) == 1 else f"{len(paths)} cut-outs", digest, "JHTDB cut-out")
    names = NAMES[quantity]
    return Field(time - time[0], values, axes, mask, names, ("1",) * len(names), "s", source)


def _numbers(file: Any, path: Path, quantity: str) -> dict[int, str]:
    pattern = re.compile(rf"{quantity}_(\d+)", re.IGNORECASE)
    there = member_names(file, path)
    found = {int(match.group(1)): name for name in there if (match := pattern.fullmatch(name))}
    if not found:
        raise ReadError(
            f"a cut-out needs data sets {quantity.capitalize()}_0001, ...",
            f"{path.name} has {', '.join(there) or 'none'}",
            f"Request from the service {quantity}, or name the quantity that the file has.",
        )
    return found


def _coordinates(file: Any, path: Path) -> list[NDArray[Any]]:
    there = member_names(file, path)
    absent = [name for name in COORDINATES if name not in there]
    if absent:
        raise ReadError(
            f"a cut-out needs its coordinates {', '.join(COORDINATES)}",
            f"{path.name} lacks {', '.join(absent)}",
            "Fetch it anew from the cut-out service.",
        )
    return [np.ravel(data_set(file, name, path)).astype(float) for name in COORDINATES]


def _values(held: NDArray[Any], path: Path, grid: list[NDArray[Any]], quantity: str) -> NDArray[np.float32]:
    wanted = (*(len(each) for each in grid), len(NAMES[quantity]))
    if held.shape != wanted:
        raise ShapeError(
            f"{quantity} is needed as (z, y, x, component), here {wanted}",
            f"{path.name} has {held.shape}",
            "Fetch it anew from the cut-out service.",
        )
    return held.reshape(-1, wanted[-1]).astype(np.float32)
