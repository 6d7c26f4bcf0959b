"""Markers of a recording as arrays, under the names of a marker set; the stillest part of a static trial."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from gaitdisc.errors import ChannelError
from gaitdisc.recording import Recording

STILL_S = 0.5
STEP_S = 0.1


def marker_labels(markers: Recording) -> list[str]:
    """Names of the markers of a recording, in order."""
    there = set(markers.names)
    labels = [
        name[:-2] for name in markers.names if name.endswith(".x") and {f"{name[:-2]}.y", f"{name[:-2]}.z"} <= there
    ]
    if not labels:
        raise ChannelError(
            "angles from markers need a recording of markers, with channels <marker>.x, .y, .z",
            f"{markers.source.file or 'the recording'} has {', '.join(markers.names[:4]) or 'no channel'}",
            "Give the stream `markers` of the trial.",
        )
    return labels


def marker_places(markers: Recording, labels: Sequence[str]) -> NDArray[np.float64]:
    """Positions of markers (frame, marker, 3) [m]; NaN, in all three, where one was not seen."""
    columns = [markers.index(f"{label}.{axis}") for label in labels for axis in "xyz"]
    places = np.array(markers.values[:, columns]).reshape(len(markers.time), len(labels), 3)
    places[~np.isfinite(places).all(axis=2)] = np.nan
    return places


def still_places(markers: Recording, names: Mapping[str, str], needed: Sequence[str]) -> tuple[dict, float, float]:
    """Where each marker is while the person stands stillest, over half a second in which every needed marker is seen.

    names: name in the marker set -> label in the recording
    needed: markers, by the names of the set, without which no frame can be built
    returns places each (3,) [m]: median over the half second, or over the whole trial for a marker that is missing in
        it; without those that are never seen
    returns moved_m: how far the needed markers are from their places, at most on the mean over markers, in that half
        second [m]
    returns start_s: where it begins [s]
    """
    all_places = marker_places(markers, list(names.values()))
    rows = [list(names).index(name) for name in needed]
    length = min(max(round(STILL_S * markers.rate_hz), 1), len(markers.time)) if len(markers.time) > 1 else 1
    step = max(round(STEP_S * markers.rate_hz), 1) if length > 1 else 1
    moved, start = min(
        ((_moved(all_places[first : first + length, rows]), first)
         for first in range(0, len(all_places) - length + 1, step)),
        key=lambda pair: pair[0],
    )  # fmt: skip
    chosen = slice(start, start + length) if np.isfinite(moved) else slice(None)
    places = {}
    for column, name in enumerate(names):
        for part in (all_places[chosen, column], all_places[:, column]):
            seen = part[np.isfinite(part[:, 0])]
            if len(seen):
                places[name] = np.median(seen, axis=0)
                break
    return places, moved if np.isfinite(moved) else _moved(all_places[:, rows]), float(markers.time[start])


def _moved(places: NDArray[np.float64]) -> float:
    """Largest mean distance of the markers from their median places; infinite where one is never seen."""
    seen = np.isfinite(places[..., 0])
    if not seen.any(axis=0).all():
        return float("inf")
    middle = np.nanmedian(places, axis=0)
    apart = np.where(seen, np.linalg.norm(np.nan_to_num(places - middle), axis=2), 0.0)
    return float((apart.sum(axis=1) / np.maximum(seen.sum(axis=1), 1)).max())
