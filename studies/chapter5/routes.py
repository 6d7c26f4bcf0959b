"""Where sensors are at each snapshot of a field: fixed, carried along a path, or walking at random (Eq. 5.7)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gaitdisc.errors import ChannelError
from gaitdisc.recording.arrays import read_only
from gaitdisc.recording.field import Field

STEP_EVERY = 3  # snapshots from one step of a random walk to the next (section 5.3.1)
REACH = 0.5 + 1e-6  # of a step along each axis: a place belongs to the node whose cell it lies in


@dataclass(frozen=True, eq=False)
class Route:
    """Points of a field that sensors are at; it stands for the matrices C_t, whose rows are rows of the identity."""

    name: str
    points: NDArray[np.intp]  # (time, sensor), number of the point that each sensor reads at each snapshot

    def __post_init__(self) -> None:
        """Freeze the numbers."""
        object.__setattr__(self, "points", read_only(self.points, np.intp))

    @property
    def sensors(self) -> int:
        """Sensors that move, or stand, on their own."""
        return self.points.shape[1]

    def readings(self, field: Field) -> NDArray[np.float64]:
        """y_t = C_t x_t: what the sensors read, (time, sensor, quantity) [each quantity's unit]."""
        return field.values[np.arange(len(field))[:, None], self.points].astype(float)

    def places(self, field: Field) -> NDArray[np.float64]:
        """Where the sensors are, (time, sensor, axis) [each axis's unit]."""
        return field.places[self.points]


def fixed(field: Field, points: Sequence[int], name: str = "fixed") -> Route:
    """Sensors that stay where they are."""
    chosen = np.asarray(points, int)
    outside = (chosen < 0) | (chosen >= field.points)
    if not len(chosen) or outside.any():
        found = f"requested: {', '.join(str(k) for k in chosen[outside]) or 'none'}"
        needed = f"sensors need points of the field, 0 to {field.points - 1}"
        raise ChannelError(needed, found, "Name points of the field.")
    return Route(name, np.tile(chosen, (len(field), 1)))


def fixed_at_random(field: Field, sensors: int, seed: int) -> Route:
    """Sensors at points drawn at random, no two alike, that stay there."""
    drawn = np.random.default_rng(seed).choice(field.points, sensors, replace=False)
    return fixed(field, drawn.tolist(), f"{sensors} fixed")


def along(field: Field, places: ArrayLike, name: str) -> Route:
    """One sensor carried along a given path; at each snapshot it reads the node whose cell it is in."""
    path = np.asarray(places, float)
    if path.shape != (len(field), len(field.axes)):
        needed = f"the path {name!r} needs a place for each of {len(field)} snapshots along {len(field.axes)} axes"
        raise ChannelError(needed, f"found an array of shape {path.shape}", "Give one row a snapshot.")
    nodes, inside = np.empty(path.shape, int), np.ones(len(path), bool)
    for k, axis in enumerate(field.axes):
        away = np.abs(path[:, k, None] - axis.coordinates)
        nodes[:, k] = away.argmin(axis=1)
        inside &= away.min(axis=1) <= REACH * axis.step
    points = np.where(inside, field.number_at[tuple(nodes.T)], -1)
    if (points < 0).any():
        first = int(np.argmax(points < 0))
        words = ", ".join(f"{a.name} {v:g} {a.unit}" for a, v in zip(field.axes, path[first], strict=True))
        raise ChannelError(
            f"the path {name!r} has to stay inside the field",
            f"it is outside in {int((points < 0).sum())} of {len(points)} snapshots, first in snapshot {first + 1} at "
            f"{words}" + (", which the field's mask leaves out" if inside[first] else ""),
            "Move its stops onto points of the field.",
        )
    return Route(name, points[:, None])


def circuit(field: Field, stops: ArrayLike, period: int, name: str) -> Route:
    """One sensor that goes round a closed path at an even pace, again and again."""
    corners = np.asarray(stops, float)
    corners = np.vstack([corners, corners[:1]])
    gone = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(corners, axis=0), axis=1))])
    now = (np.arange(len(field)) % period) / period * gone[-1]
    return along(field, np.column_stack([np.interp(now, gone, column) for column in corners.T]), name)


def random_walk(field: Field, seed: int, start: int | None = None) -> Route:
    """One sensor that walks: every third snapshot one node along one axis, each direction equally likely.

    The dissertation starts each walk at the centre, and does not say what happens at the border: here a step that
    would leave the field is taken the other way, and not at all where that leaves it too.

    Source: Ebers 2023, section 5.3.1.
    """
    rng = np.random.default_rng(seed)
    number_at, shape = field.number_at, field.mask.shape
    if start is None:  # the centre
        away = (field.nodes - (np.array(shape) - 1) / 2) / np.array(shape)
        start = int(np.argmin((away**2).sum(axis=1)))
    node, points = field.nodes[fixed(field, [start]).points[0, 0]].copy(), np.empty(len(field), int)
    for snapshot in range(len(field)):
        if snapshot and snapshot % STEP_EVERY == 0:
            step = np.zeros(len(shape), int)
            step[rng.integers(len(shape))] = rng.choice([-1, 1])
            for moved in (node + step, node - step):
                if (moved >= 0).all() and (moved < shape).all() and number_at[tuple(moved)] >= 0:
                    node = moved
                    break
        points[snapshot] = number_at[tuple(node)]
    return Route("random walk", points[:, None])


def joined(routes: Sequence[Route]) -> Route:
    """Sensors of several routes side by side."""
    return Route(" + ".join(route.name for route in routes), np.hstack([route.points for route in routes]))
