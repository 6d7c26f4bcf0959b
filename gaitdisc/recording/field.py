"""A field over time: one or more quantities at every point of a grid, snapshot after snapshot."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from gaitdisc.errors import ChannelError, SamplingError, ShapeError
from gaitdisc.recording.arrays import Values, freeze, read_only
from gaitdisc.recording.recording import Source

STEP_TOLERANCE = 0.01  # of the usual step; months are not evenly long in every calendar


@dataclass(frozen=True, eq=False)
class Axis:
    """Coordinates along one axis of a grid.

    Parameters
    ----------
    name : str
        Name of the axis, such as `lat`, `lon` or `x`.
    coordinates : ndarray (node,) [unit]
        Coordinates, increasing or decreasing throughout.
    unit : str
        Unit of the coordinates, as shown; it is never converted.

    Raises
    ------
    ShapeError
        If the coordinates neither increase nor decrease throughout.

    Examples
    --------
    >>> Axis("lon", np.array([0.0, 2.0, 4.0]), "deg").step
    2.0
    """

    name: str
    coordinates: Values
    unit: str = "1"

    def __post_init__(self) -> None:
        freeze(self, "coordinates")
        steps = np.diff(self.coordinates)
        if self.coordinates.ndim != 1 or not len(self.coordinates) or not (np.all(steps > 0) or np.all(steps < 0)):
            raise ShapeError(
                "the coordinates of a field's axis must increase or decrease throughout",
                f"axis {self.name!r} has {np.size(self.coordinates)} coordinates that do not",
                "Sort the grid along this axis.",
            )

    @property
    def step(self) -> float:
        """Typical distance between two nodes [unit]; infinite for a single node."""
        return float(np.median(np.abs(np.diff(self.coordinates)))) if len(self.coordinates) > 1 else float("inf")


@dataclass(frozen=True, eq=False)
class Field:
    """Quantities at the points of a grid over time. The arrays are read-only, and time is their first axis.

    Parameters
    ----------
    time : ndarray (time,) [time_unit]
        Times of the snapshots, evenly spaced, increasing.
    values : ndarray (time, point, quantity) [each quantity's unit]
        Values at the points where `mask` is true, in the grid's order (last axis fastest); finite, in single precision.
    axes : tuple of Axis
        Axes of the grid.
    mask : ndarray of bool, shape of the grid
        True at the points of the field, False outside it, as on land.
    quantities, units : tuple of str
        Measured quantities and their units.
    time_unit : str
        Unit of time, such as `month`, `week` or `s`.
    source : Source
        File, hash and reader.

    Raises
    ------
    ShapeError
        If the arrays do not match, the mask is empty, or a value is missing.
    SamplingError
        If time is not evenly spaced (a step differs from the median by more than 1 %).

    Examples
    --------
    >>> axes = (Axis("lat", np.array([0.0, 1.0])), Axis("lon", np.array([5.0, 6.0])))
    >>> mask = np.array([[True, False], [True, True]])
    >>> sea = Field(np.arange(4.0), np.ones((4, 3, 1)), axes, mask, ("sst",), ("degC",), "week")
    >>> sea.points, sea.places.tolist()
    (3, [[0.0, 5.0], [1.0, 5.0], [1.0, 6.0]])
    """

    time: Values
    values: NDArray[np.float32]
    axes: tuple[Axis, ...]
    mask: NDArray[np.bool_]
    quantities: tuple[str, ...]
    units: tuple[str, ...]
    time_unit: str = "s"
    source: Source = field(default_factory=Source)

    def __post_init__(self) -> None:
        time, values, mask = (read_only(self.time), read_only(self.values, np.float32), read_only(self.mask, bool))
        grid = tuple(len(axis.coordinates) for axis in self.axes)
        if mask.shape != grid or not mask.any():
            raise ShapeError(
                f"the mask of a field must have the shape of its grid, {grid}, and at least one True value",
                f"the mask has shape {mask.shape} and {int(mask.sum())} True values",
                "Give one boolean for each grid point: True where the field has values.",
            )
        wanted = (len(time), int(mask.sum()), len(self.quantities))
        if values.shape != wanted or len(self.units) != len(self.quantities):
            raise ShapeError(
                f"a field must have values of shape (time, point, quantity), here {wanted}, and one unit for each "
                "quantity",
                f"the values have shape {values.shape}, with {len(self.units)} units",
                "Put time first, then the points of the mask, then the quantities.",
            )
        steps = np.diff(time)
        usual = float(np.median(steps)) if len(steps) else 1.0
        uneven = (steps <= 0) | (np.abs(steps - usual) > STEP_TOLERANCE * usual)
        if uneven.any():
            first = int(np.argmax(uneven))
            raise SamplingError(
                "the snapshots of a field must be evenly spaced in time",
                f"{self.source.file or 'the field'}: snapshot {first + 2} follows the previous one after "
                f"{steps[first]:g} {self.time_unit}; the usual step is {usual:g}",
                "Sort the snapshots, or fill in the missing ones.",
            )
        for name, value in (("time", time), ("values", values), ("mask", mask)):
            object.__setattr__(self, name, value)
        missing = np.count_nonzero(~np.isfinite(self.values))
        if missing:
            snapshot, point, quantity = (int(k) for k in np.argwhere(~np.isfinite(self.values))[0])
            raise ShapeError(
                "a field must have a finite value at each of its points",
                f"{self.source.file or 'the field'} lacks {missing} values; the first is "
                f"{self.quantities[quantity]} at {self.place_words(point)} in snapshot {snapshot + 1}",
                "Mask the points that are not always measured, or fill them in.",
            )

    def __len__(self) -> int:
        return len(self.time)

    @property
    def points(self) -> int:
        """Number of grid points that belong to the field."""
        return int(self.mask.sum())

    @property
    def nodes(self) -> NDArray[np.intp]:
        """Grid indices of every point of the field, shape (point, axis), counted from 0."""
        return np.argwhere(self.mask)

    @property
    def places(self) -> Values:
        """Coordinates of every point, (point, axis) [each axis's unit]."""
        nodes = self.nodes
        return np.column_stack([axis.coordinates[nodes[:, k]] for k, axis in enumerate(self.axes)])

    @property
    def number_at(self) -> NDArray[np.intp]:
        """Number of the point at every node of the grid, -1 outside the field."""
        numbers = np.full(self.mask.shape, -1)
        numbers[self.mask] = np.arange(self.points)
        return numbers

    def place_words(self, point: int) -> str:
        """Coordinates of a point in words.

        Parameters
        ----------
        point : int            Number of the point.
        """
        place = self.places[point]
        return ", ".join(f"{axis.name} {value:g} {axis.unit}" for axis, value in zip(self.axes, place, strict=True))

    def snapshots(self, chosen: slice | NDArray[np.intp]) -> Field:
        """Keep some snapshots.

        Parameters
        ----------
        chosen : slice or ndarray of int
            Snapshots to keep, in chronological order.
        """
        return replace(self, time=self.time[chosen], values=self.values[chosen])

    def selected(self, quantities: Sequence[str]) -> Field:
        """Field of some quantities only, in the order requested.

        Parameters
        ----------
        quantities : sequence of str
            Names of the quantities.

        Raises
        ------
        ChannelError
            If the field lacks a quantity.
        """
        absent = [name for name in quantities if name not in self.quantities]
        if absent or not quantities:
            raise ChannelError(
                f"the quantities must be among {', '.join(self.quantities)}",
                f"requested: {', '.join(absent) or 'none'}",
                "Name one or more of these.",
            )
        columns = [self.quantities.index(name) for name in quantities]
        units = tuple(self.units[k] for k in columns)
        return replace(self, values=self.values[:, :, columns], quantities=tuple(quantities), units=units)

    def on_grid(self, values: NDArray[np.floating]) -> Values:
        """Values of one snapshot and quantity on the grid, NaN outside the field.

        Parameters
        ----------
        values : ndarray (point,)
            Values of one quantity.
        """
        grid = np.full(self.mask.shape, np.nan)
        grid[self.mask] = values
        return grid
