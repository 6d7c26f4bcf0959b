"""A force plate: where it lies, and how the numbers of its channels make a force and a moment."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gaitdisc.recording import Surface
from gaitdisc.units import convert, inner_unit

LEAST_LOAD_N = 20.0  # below it a centre of pressure is noise divided by noise


@dataclass(frozen=True, eq=False)
class ForcePlate:
    """Where a plate lies and how its channels make a force.

    >>> corners = np.array([[0.5, 0.4, 0], [0, 0.4, 0], [0, 0, 0], [0.5, 0, 0]])
    >>> ForcePlate(1, 2, (0, 1, 2, 3, 4, 5), corners, np.zeros(3), np.empty((0, 0))).axes
    array([[1., 0., 0.],
           [0., 1., 0.],
           [0., 0., 1.]])
    """

    number: int
    # 1: force, centre of pressure and free moment; 2: force and moment; 3: eight forces of four pillars; 4: as 2,
    # through a calibration matrix
    kind: int
    columns: tuple[int, ...]
    # (4, 3) [m], in the laboratory's axes; the first lies towards the plate's +x and +y, the second towards -x and +y
    corners: NDArray[np.float64]
    # (3,) [m], from the origin of the sensors to the centre of the surface, in the plate's axes; type 3: half the
    # distances between the pillars, and the depth of the sensors
    origin: NDArray[np.float64]
    calibration: NDArray[np.float64]  # (6, 6) or (0, 0), type 4 only; gives N and N times the file's unit of length

    @property
    def surface(self) -> Surface:
        """What a foot can step on, under the first part of its channels' names."""
        return Surface(f"plate_{self.number}", self.corners)

    @property
    def centre(self) -> NDArray[np.float64]:
        """Centre of the surface, (3,) [m], in the laboratory's axes."""
        return self.corners.mean(axis=0)

    @property
    def axes(self) -> NDArray[np.float64]:
        """The plate's axes as columns, (3, 3), in the laboratory's axes; NaN where the corners span no surface."""
        first, second, third, fourth = self.corners
        x = first + fourth - second - third
        z = np.cross(x, first + second - third - fourth)
        with np.errstate(all="ignore"):
            x, z = x / np.linalg.norm(x), z / np.linalg.norm(z)
        return np.asarray(np.column_stack([x, np.cross(z, x), z]), float)

    @property
    def vertical(self) -> int:
        """Which of the laboratory's axes, 0 to 2, is nearest to the plate's normal."""
        return int(np.argmax(np.abs(self.axes[:, 2])))

    def wrench(
        self, values: NDArray[np.float64], units: tuple[str, ...]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Force [N] and moment about the centre of the surface [N m], each (sample, 3), in the plate's axes.

        values (sample, channel): the plate's channels in the file's units
        units: units of the channels; of what the matrix gives for type 4
        """
        if self.kind == 4:
            values = values @ self.calibration.T
        columns = [convert(values[:, i], unit, inner_unit(unit)) for i, unit in enumerate(units)]
        values = np.asarray(np.column_stack(columns), float)
        if self.kind == 3:
            return _of_pillars(values, self.origin)
        force = values[:, :3]
        if self.kind == 1:
            point = np.column_stack([values[:, 3:5], np.zeros(len(values))])
            free = np.column_stack([np.zeros((len(values), 2)), values[:, 5]])
            return force, np.cross(point, force) + free
        return force, values[:, 3:6] + np.cross(force, self.origin)


def _of_pillars(values: NDArray[np.float64], origin: NDArray[np.float64]) -> tuple[NDArray, NDArray]:
    """Type 3, Kistler: x12, x34, y14, y23, z1 to z4; pillar 1 stands at (+a, +b), 2 at (-a, +b), as the corners do."""
    x12, x34, y14, y23, z1, z2, z3, z4 = values.T
    a, b = np.abs(origin[:2])
    force = np.column_stack([x12 + x34, y14 + y23, z1 + z2 + z3 + z4])
    moment = np.column_stack([b * (z1 + z2 - z3 - z4), a * (z2 + z3 - z1 - z4), b * (x34 - x12) + a * (y14 - y23)])
    return force, moment + np.cross(force, [0, 0, origin[2]])


def centre_of_pressure(force: NDArray[np.float64], moment: NDArray[np.float64]) -> NDArray[np.float64]:
    """Centre of pressure on the surface, in the plate's axes, NaN below 20 N.

    force (sample, 3) [N]: in the plate's axes
    moment (sample, 3) [N m]: about the centre of the surface
    returns (sample, 3) [m]

    >>> centre_of_pressure(np.array([[0, 0, -500.0], [0, 0, -1.0]]), np.array([[50.0, 25, 0], [1, 1, 0]]))
    array([[ 0.05, -0.1 ,  0.  ],
           [  nan,   nan,   nan]])
    """
    loaded = np.abs(force[:, 2]) > LEAST_LOAD_N
    pressure = np.full_like(force, np.nan)
    normal = force[loaded, 2]
    pressure[loaded] = np.column_stack([-moment[loaded, 1] / normal, moment[loaded, 0] / normal, np.zeros(len(normal))])
    return pressure
