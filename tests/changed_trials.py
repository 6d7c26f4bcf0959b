"""Trials of which a stream, a plate or two labels are changed, and markers at known places."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gaitdisc.channel import Channel
from gaitdisc.recording import Recording, Trial


def with_stream(trial: Trial, key: str, recording: Recording) -> Trial:
    """Trial whose stream of this key is another recording."""
    return replace(trial, streams={**trial.streams, key: recording})


def with_column(recording: Recording, name: str, value: ArrayLike, rows: slice | NDArray = slice(None)) -> Recording:
    """Recording in which a channel, or each coordinate of a marker, has another value in some rows."""
    values = np.array(recording.values)
    for column, own in enumerate(recording.names):
        if name in (own, own.rpartition(".")[0]):
            values[rows, column] = value
    return recording.with_values(values)


def gained(trial: Trial, plate: int, gain: float) -> Trial:
    """Trial in which a plate shows so many times its force."""
    forces = trial.stream("forces")
    times = [gain if c.name.startswith(f"plate_{plate}_") and c.name[8] in "fm" else 1.0 for c in forces.channels]
    return with_stream(trial, "forces", forces.with_values(forces.values * times))


def with_labels_exchanged(trial: Trial, pair: tuple[str, str], frames: slice) -> Trial:
    """Trial in which two markers bear each other's label in some frames."""
    markers = trial.stream("markers")
    values = np.array(markers.values)
    for axis in "xyz":
        one, other = (markers.index(f"{label}.{axis}") for label in pair)
        values[frames, [one, other]] = values[frames, [other, one]]
    return with_stream(trial, "markers", markers.with_values(values))


def markers_at(time: NDArray, places: Mapping[str, ArrayLike]) -> Recording:
    """Markers by their names, each (frame, 3) [m]."""
    channels = tuple(Channel(f"{name}.{axis}", "marker", "m") for name in places for axis in "xyz")
    return Recording(time, np.hstack([np.asarray(place, float) for place in places.values()]), channels)
