"""Windows of what sensors on a route read, each to reconstruct the whole field at its last reading."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from gaitdisc.errors import SamplingError
from gaitdisc.recording import Field, Samples
from gaitdisc.sensing.windows import Lags

from .routes import Route


def reading_names(field: Field, route: Route, positions: bool = False) -> tuple[str, ...]:
    """Names of what one window holds for each of its times."""
    given = field.quantities + (tuple(axis.name for axis in field.axes) if positions else ())
    return tuple(f"{name} of sensor {k + 1}" for k in range(route.sensors) for name in given)


def field_windows(field: Field, route: Route, lags: Lags, positions: bool = False) -> Samples:
    """Every window along a field's whole time, still without outputs: those are modes of the part that is fitted."""
    if len(field) <= lags.reach + lags.ahead:
        forth = f" and {lags.ahead} ahead" if lags.ahead else ""
        raise SamplingError(
            f"a window reaches back {lags.reach} snapshots{forth}",
            f"{field.source.file or 'the field'} has {len(field)}",
            "Take fewer lags, or a longer field.",
        )
    readings = route.readings(field)
    if positions:
        readings = np.concatenate([readings, route.places(field)], axis=2)
    readings = readings.reshape(len(field), -1)
    last = np.arange(lags.reach, len(field) - lags.ahead)
    rows = last[:, None] + (np.arange(lags.count) - lags.count + 1) * lags.spacing
    names = reading_names(field, route, positions)
    inputs = tuple(
        name if ago == 0 else f"{name} {ago * lags.spacing} {field.time_unit} ago"
        for ago in range(lags.count - 1, -1, -1)
        for name in names
    )
    x, none = readings[rows].reshape(len(last), -1), np.zeros((len(last), 0))
    return Samples(x, none, inputs, (), (last + lags.ahead).astype(float), np.zeros(len(last)))


def snapshots_of(windows: Samples) -> NDArray[np.intp]:
    """Number of the snapshot that each window reconstructs, (window,)."""
    return np.rint(windows.time).astype(int)


def with_coefficients(windows: Samples, coefficients: NDArray[np.float64], names: Sequence[str]) -> Samples:
    """Windows with the modes' coefficients of their snapshots as outputs."""
    return replace(windows, y=coefficients[snapshots_of(windows)], outputs=tuple(names))
