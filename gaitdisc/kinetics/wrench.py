"""A wrench: a force and its moment, held about the laboratory's origin, so that wrenches of one body simply add."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gaitdisc.errors import ShapeError
from gaitdisc.recording.arrays import read_only

LEAST_LOAD_N = 20.0  # below it a centre of pressure is noise divided by noise


@dataclass(frozen=True, eq=False)
class Wrench:
    """Force and moment in the laboratory's frame, sample by sample.

    >>> Wrench.at(np.array([[0.5, 0.0, 0.0]]), np.array([[0.0, 0.0, 700.0]])).moment
    array([[   0., -350.,    0.]])
    """

    force: NDArray[np.float64]  # (sample, 3) [N], of the ground on the foot, where it is a ground reaction
    moment: NDArray[np.float64]  # (sample, 3) [N m], about the origin of the laboratory

    def __post_init__(self) -> None:
        """Check shapes once."""
        force, moment = read_only(self.force), read_only(self.moment)
        if force.ndim != 2 or force.shape[1] != 3 or moment.shape != force.shape:
            raise ShapeError(
                "a wrench needs a force and a moment of shape (sample, 3)",
                f"found {force.shape} and {moment.shape}",
                "Put samples first, the laboratory's axes second.",
            )
        object.__setattr__(self, "force", force)
        object.__setattr__(self, "moment", moment)

    @classmethod
    def at(
        cls, point: NDArray[np.float64], force: NDArray[np.float64], moment: NDArray[np.float64] | float = 0.0
    ) -> Wrench:
        """Wrench of a force (sample, 3) [N] at a point (sample, 3) or (3,) [m], and a moment about it [N m]."""
        return cls(force, np.cross(point, force) + moment)

    def __add__(self, other: Wrench) -> Wrench:
        return Wrench(self.force + other.force, self.moment + other.moment)

    def __sub__(self, other: Wrench) -> Wrench:
        return Wrench(self.force - other.force, self.moment - other.moment)

    def __len__(self) -> int:
        return len(self.force)

    def about(self, point: NDArray[np.float64]) -> NDArray[np.float64]:
        """Moment (sample, 3) [N m] about another point (sample, 3) or (3,) [m] of the laboratory's frame."""
        return self.moment - np.cross(point, self.force)

    def pressure_centre(
        self, point: NDArray[np.float64], up: NDArray[np.float64], least_load_n: float = LEAST_LOAD_N
    ) -> NDArray[np.float64]:
        """Where a force meets a surface of unit normal `up`, (sample, 3) [m]; NaN below `least_load_n` [N] along it.

        >>> step = Wrench.at(np.array([0.2, 0.1, 0.0]), np.array([[30.0, 0.0, 700.0], [0.0, 0.0, 19.0]]))
        >>> step.pressure_centre(np.zeros(3), np.array([0.0, 0.0, 1.0])).round(9)
        array([[0.2, 0.1, 0. ],
               [nan, nan, nan]])
        """
        normal = self.force @ up
        pressed = normal > least_load_n
        centre = np.full(self.force.shape, np.nan)
        centre[pressed] = point + np.cross(up, self.about(point)[pressed]) / normal[pressed, None]
        return centre
