"""A periodic box of 2 pi in wavenumbers: what every computation on it needs."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from gaitdisc.errors import ShapeError

LEAST_NODES = 8


@dataclass(frozen=True)
class Box:
    """A cube with so many nodes along each side, in the half of all wavenumbers that a real field needs."""

    nodes: int  # along each side; even, at least 8

    def __post_init__(self) -> None:
        """Refuse a box that is too coarse."""
        if self.nodes < LEAST_NODES or self.nodes % 2:
            raise ShapeError(
                f"a box of turbulence needs an even number of nodes, {LEAST_NODES} or more",
                f"requested: {self.nodes}",
                "Take 32, 48 or 64.",
            )

    @property
    def largest(self) -> int:
        """Largest wavenumber along an axis that is kept: two thirds of what the nodes resolve (no aliasing)."""
        return (self.nodes - 1) // 3

    @cached_property
    def k(self) -> NDArray[np.float32]:
        """Wavenumbers along x, y, z at every mode, (3, x, y, z)."""
        whole = np.fft.fftfreq(self.nodes, 1 / self.nodes).astype(np.float32)
        half = np.arange(self.nodes // 2 + 1, dtype=np.float32)
        return np.stack(np.meshgrid(whole, whole, half, indexing="ij"))

    @cached_property
    def squared(self) -> NDArray[np.float32]:
        """Square of the length of the wavenumber, (x, y, z)."""
        return (self.k**2).sum(axis=0)

    @cached_property
    def inverse(self) -> NDArray[np.float32]:
        """One over `squared`, 0 where that is 0."""
        return (1 / np.where(self.squared > 0, self.squared, np.inf)).astype(np.float32)

    @cached_property
    def kept(self) -> NDArray[np.bool_]:
        """True at modes that are computed: below the aliased ones, without the mean."""
        return (np.abs(self.k) <= self.largest).all(axis=0) & (self.squared > 0)

    @cached_property
    def weight(self) -> NDArray[np.float32]:
        """How many modes of the whole space each mode stands for: 2, or 1 on the plane that is its own mirror."""
        weight = np.full(self.squared.shape, 2.0, np.float32)
        weight[..., 0] = weight[..., -1] = 1.0
        return weight

    def to_modes(self, velocity: NDArray[np.floating]) -> NDArray[np.complexfloating]:
        """Fourier coefficients of a velocity, (3, x, y, z), as amplitudes: not times the number of nodes."""
        from scipy.fft import rfftn

        return np.asarray(rfftn(velocity, axes=(1, 2, 3), norm="forward"))

    def to_nodes(self, modes: NDArray[np.complexfloating]) -> NDArray[np.floating]:
        """Values at the nodes, (3, x, y, z)."""
        from scipy.fft import irfftn

        return np.asarray(irfftn(modes, s=(self.nodes,) * 3, axes=(1, 2, 3), norm="forward"))

    def projected(self, modes: NDArray[np.complexfloating]) -> NDArray[np.complexfloating]:
        """Take away the part that is a gradient, and the modes that are not computed: what is left has no divergence."""
        along = (self.k * modes).sum(axis=0) * self.inverse
        return np.where(self.kept, modes - self.k * along, 0)

    def energy(self, modes: NDArray[np.complexfloating]) -> NDArray[np.float32]:
        """Kinetic energy per mass in every mode, (x, y, z), such that the sum is the mean over the box."""
        return 0.5 * self.weight * (modes.real**2 + modes.imag**2).sum(axis=0)
