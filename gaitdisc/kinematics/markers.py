"""Markers as arrays; where the person stands stillest; up, forward and right-handedness, from the data."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gaitdisc.errors import ChannelError, ShapeError, StrideError
from gaitdisc.recording import Recording
from gaitdisc.recording.arrays import Values, finite_rows

STILL_S = 0.5
STEP_S = 0.1
PATH_S = 1.0  # about a stride: the sway from step to step cancels over it
TRAVELS_M_PER_S = 0.3  # slower is a treadmill, or standing
STRAIGHT_DEG = 15.0  # a path that turns less has one direction
UPRIGHT = 0.85  # cosine between an axis of the laboratory and the line from feet to pelvis


def marker_labels(markers: Recording) -> list[str]:
    """Names of the markers of a recording, in order."""
    there = set(markers.names)
    labels = [
        name[:-2] for name in markers.names if name.endswith(".x") and {f"{name[:-2]}.y", f"{name[:-2]}.z"} <= there
    ]
    if not labels:
        raise ChannelError(
            "angles must be computed from a recording of markers, with channels <marker>.x, .y, .z",
            f"{markers.source.file or 'the recording'} has {', '.join(markers.names[:4]) or 'no channel'}",
            "Use the stream `markers` of the trial.",
        )
    return labels


def marker_places(markers: Recording, labels: Sequence[str]) -> Values:
    """Positions of markers (frame, marker, 3) [m]; NaN, in all three, where one was not seen."""
    columns = [markers.index(f"{label}.{axis}") for label in labels for axis in "xyz"]
    places = np.array(markers.values[:, columns]).reshape(len(markers.time), len(labels), 3)
    places[~np.isfinite(places).all(axis=2)] = np.nan
    return places


def still_places(markers: Recording, names: Mapping[str, str], needed: Sequence[str]) -> tuple[dict, float, float]:
    """Where each marker is (3,) [m] over the stillest half second in which every needed one is seen.

    A marker missing in it has the median of the trial. Beside: how far the needed ones move, at most, on the mean over
    markers [m], and when the half second begins [s].
    """
    all_places = marker_places(markers, list(names.values()))
    rows = [list(names).index(name) for name in needed]
    length = min(max(round(STILL_S * markers.rate_hz), 1), len(markers.time)) if len(markers.time) > 1 else 1
    step = max(round(STEP_S * markers.rate_hz), 1) if length > 1 else 1
    moved, start = min(
        ((_mean_distance(all_places[first : first + length, rows]), first)
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
    return places, moved if np.isfinite(moved) else _mean_distance(all_places[:, rows]), float(markers.time[start])


def _mean_distance(places: Values) -> float:
    """Largest mean distance of the markers from their median places; infinite where one is never seen."""
    seen = np.isfinite(places[..., 0])
    if not seen.any(axis=0).all():
        return float("inf")
    middle = np.nanmedian(places, axis=0)
    apart = np.where(seen, np.linalg.norm(np.nan_to_num(places - middle), axis=2), 0.0)
    return float((apart.sum(axis=1) / np.maximum(seen.sum(axis=1), 1)).max())


@dataclass(frozen=True, eq=False)
class WalkingFrame:
    """The walker's frame over time: x forward, y up, z to the right."""

    rotation: Values  # (frame, 3, 3), columns are forward, up, right in the laboratory's frame
    how: str  # what up and forward were found from


def up_axis(pelvis: Values, feet: Values, file: str = "") -> Values:
    """Laboratory's axis (3,) along which the pelvis (frame, 3) [m] lies above the feet (frame, 3) [m]; NaN allowed.

    >>> up_axis(np.array([[1.0, 2.0, 0.9]]), np.array([[1.0, 2.1, 0.1]]))
    array([0., 0., 1.])
    """
    lines = finite_rows(pelvis - feet)
    if not len(lines):
        raise ShapeError(
            "a frame must have markers of the pelvis and of a foot, for the upward direction",
            f"{file or 'the recording'} has none",
            "Fill the gaps in the markers, or use another trial.",
        )
    mean = lines.mean(axis=0)
    size = float(np.linalg.norm(mean))
    axis = int(np.argmax(np.abs(mean)))
    if not size > 0 or abs(mean[axis]) < UPRIGHT * size:
        raise ShapeError(
            "the pelvis must lie above the feet along one axis of the laboratory",
            f"in {file or 'the recording'} the mean vector from the feet to the pelvis is "
            f"({', '.join(f'{part:.3g}' for part in mean)}) m, which lies along no axis",
            "Export the markers in a level frame.",
        )
    up = np.zeros(3)
    up[axis] = np.sign(mean[axis])
    return up


def check_right_handed(pelvis: Values, up: Values, file: str = "") -> None:
    """Refuse mirrored frames; pelvis axes (frame, 3, 3): x sacrum forward, z left to right spine; up (3,).

    >>> check_right_handed(np.eye(3)[None], np.array([0.0, -1.0, 0.0]), "a.c3d")  # doctest: +ELLIPSIS
    Traceback (most recent call last):
    ...
    gaitdisc.errors.ShapeError: the laboratory's axes must ... axis points down (cosine -1.00): ...
    """
    upright = float(np.nanmedian(pelvis[:, :, 1] @ up))
    if not upright > 0:
        raise ShapeError(
            "the laboratory's axes must be right-handed, and the names of left and right markers correct",
            f"{file or 'the recording'}: with the right iliac spine on the right and the sacrum behind, the upward "
            f"axis points down (cosine {upright:.2f}): the frame is mirrored, or left and right are exchanged",
            "Correct the axes of the export, or the labels.",
        )


def walking_frame(
    origin: Values, facing: Values, up: Values, rate_hz: float, given: Sequence[float] | None = None
) -> WalkingFrame:
    """Forward, up and right at each frame.

    Forward is, in this order: as given; where the pelvis travels, its path over a second around each frame if the path
    turns by 15 deg or more, its mean path otherwise; where it does not travel (a treadmill, standing), the way that the
    pelvis faces on the mean. Of a person who walks backwards, forward is against the path.

    origin (frame, 3) [m]: the pelvis over time; NaN allowed
    facing (frame, 3): axis of the pelvis that points forward
    """
    if given is not None:
        stated = np.asarray(given, float)
        size = float(np.linalg.norm(stated)) if stated.shape == (3,) else 0.0
        if not size > 0 or not abs(stated @ up) <= 0.5 * size:
            raise StrideError(
                "the direction of walking must be a horizontal vector of three numbers",
                f"it is {tuple(np.ravel(stated).tolist())}, and up is {tuple(up.tolist())}",
                "Write the direction in the laboratory's axes, for example 0 -1 0.",
            )
        return WalkingFrame(_frames(np.tile(_level(stated, up), (len(origin), 1)), up), "forward as given")
    known = np.isfinite(origin).all(axis=1) & np.isfinite(facing).all(axis=1)
    if not known.any():
        raise StrideError("a frame must have the pelvis markers", "none has all of them", "Fill the marker gaps.")
    faced = _level(facing[known].mean(axis=0), up)
    seen = np.flatnonzero(known)
    spread = seen - seen.mean()
    mean = _level_part(spread @ origin[seen] / max(float(spread @ spread), 1e-9) * rate_hz, up)
    headings = _headings(origin, seen, up, rate_hz)
    if headings is None and np.linalg.norm(mean) < TRAVELS_M_PER_S:
        return WalkingFrame(
            _frames(np.tile(faced, (len(origin), 1)), up), "forward is where the pelvis faces, as it stays in place"
        )
    paths = np.tile(_level(mean, up), (len(origin), 1)) if headings is None else headings
    backwards = bool(np.median(np.einsum("fi,fi->f", paths[known], facing[known])) < 0)
    words = "forward is along the path of the pelvis" + ", reversed because the person walks backwards" * backwards
    paths = -paths if backwards else paths
    turned = float(np.degrees(np.ptp(np.unwrap(np.arctan2(paths @ np.cross(up, faced), paths @ faced)))))
    if turned < STRAIGHT_DEG:
        straight = _level(mean, up)
        paths = np.tile(-straight if backwards else straight, (len(origin), 1))
    else:
        words += f"; the path turns by {turned:.0f} deg"
    return WalkingFrame(_frames(paths, up), words)


def _level_part(vector: Values, up: Values) -> Values:
    return vector - np.outer(vector @ up, up).reshape(np.shape(vector))


def _level(vector: Values, up: Values) -> Values:
    level = _level_part(vector, up)
    return level / max(float(np.linalg.norm(level)), 1e-12)


def _frames(forward: Values, up: Values) -> Values:
    upward = np.broadcast_to(up, forward.shape)
    return np.stack([forward, upward, np.cross(forward, upward)], axis=2)


def _headings(origin: Values, seen: NDArray[np.intp], up: Values, rate_hz: float) -> Values | None:
    """Level direction over a whole second around each frame, held where there is none; None where it is mostly slow."""
    samples = np.arange(len(origin))
    path = _level_part(np.stack([np.interp(samples, seen, origin[seen, axis]) for axis in range(3)], axis=1), up)
    half = max(round(PATH_S * rate_hz / 2), 1)
    inner = samples[(samples - half >= seen[0]) & (samples + half <= seen[-1])]
    if not len(inner):
        return None
    velocity = (path[inner + half] - path[inner - half]) / (2 * half) * rate_hz
    speed = np.linalg.norm(velocity, axis=1)
    moving = speed >= TRAVELS_M_PER_S
    if moving.mean() < 0.5:
        return None
    nearest = np.rint(np.interp(samples, inner[moving], np.arange(moving.sum()))).astype(int)
    return (velocity[moving] / speed[moving, None])[nearest]
