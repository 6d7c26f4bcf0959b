"""Where a force plate or a belt lies: its four corners in the laboratory's frame."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gaitdisc.errors import ShapeError
from gaitdisc.recording.arrays import read_only


@dataclass(frozen=True, eq=False)
class Surface:
    """A rectangle that a foot can step on.

    >>> plate = Surface("plate_1", np.array([[0.0, 0, 0], [0.4, 0, 0], [0.4, 0.6, 0], [0, 0.6, 0]]))
    >>> plate.outside(np.array([[0.1, 0.1, 0.05], [0.5, 0.3, 0.0]])).round(9).tolist()
    [-0.1, 0.1]
    """

    name: str  # first part of its channels' names: `plate_1`
    corners: NDArray[np.float64]  # (4, 3) [m], in order around it, in the laboratory's frame

    def __post_init__(self) -> None:
        """Check the corners once."""
        corners = read_only(self.corners)
        sound = corners.shape == (4, 3) and np.isfinite(corners).all()
        if not sound or np.linalg.norm(np.cross(corners[2] - corners[0], corners[3] - corners[1])) < 1e-6:
            raise ShapeError(
                "a surface needs four corners (4, 3) that span an area",
                f"{self.name} has {np.array2string(corners, precision=3)}",
                "Correct FORCE_PLATFORM:CORNERS.",
            )
        object.__setattr__(self, "corners", corners)

    @property
    def centre(self) -> NDArray[np.float64]:
        """Its middle, (3,) [m]."""
        return self.corners.mean(axis=0)

    @property
    def normal(self) -> NDArray[np.float64]:
        """Unit vector at right angles to it, (3,), to one side or the other."""
        across = np.cross(self.corners[2] - self.corners[0], self.corners[3] - self.corners[1])
        return across / np.linalg.norm(across)

    def outside(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """How far points lie beyond the nearest edge, seen along the normal, (point,) [m]; negative inside.

        points (point, 3) [m]: in the laboratory's frame
        """
        towards = np.roll(self.corners, -1, axis=0) - self.corners
        outwards = np.cross(towards, self.normal)
        outwards /= np.linalg.norm(outwards, axis=1, keepdims=True)
        outwards *= np.sign(np.einsum("ex,ex->e", outwards, self.corners - self.centre))[:, None]
        return np.einsum("pex,ex->pe", points[:, None] - self.corners, outwards).max(axis=1)
