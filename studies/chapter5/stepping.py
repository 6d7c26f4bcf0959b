"""One step of incompressible flow in a periodic box, kept going by power at its largest scales."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from gaitdisc.errors import SamplingError

from .box import Box

FORCED = 2.5  # wavenumbers up to it receive the power
Modes = NDArray[np.complexfloating]


@dataclass(frozen=True)
class Stepper:
    """Navier-Stokes without pressure, by Fourier modes: Heun's method, viscosity exact by an integrating factor.

    The nonlinear term is u x vorticity (rotational form), projected; aliased products are cut off at two thirds of the
    wavenumbers. The force is along the velocity of the modes up to `FORCED`, as large as gives the wanted power
    whatever the flow does.

    Source: Rogallo 1981, Numerical experiments in homogeneous turbulence (integrating factor); Lamorgese, Caughey and
        Pope 2005 (deterministic forcing of constant power). The database's solver holds the energy of two shells
        instead.
    """

    box: Box
    viscosity: float  # kinematic, in units of box and time
    power: float  # energy per mass and time that the force puts in; 0 lets the flow decay
    dt: float

    @cached_property
    def _damping(self) -> NDArray[np.float32]:
        return np.exp(-self.viscosity * self.box.squared * self.dt).astype(np.float32)

    @cached_property
    def _forced(self) -> NDArray[np.bool_]:
        return self.box.kept & (self.box.squared <= FORCED**2)

    def step(self, u: Modes) -> Modes:
        """Return the velocity one step later."""
        first = self.rates(u)
        ahead = self._damping * (u + self.dt * first)
        second = self.rates(ahead)
        later = self._damping * (u + 0.5 * self.dt * first) + 0.5 * self.dt * second
        if not np.isfinite(later[:, 0, 0, 1]).all():
            raise SamplingError(
                "a step of turbulence has to be shorter than the flow needs to pass a node",
                f"with steps of {self.dt:g} the velocity is not finite any more",
                "Take half the step.",
            )
        return later

    def rates(self, u: Modes) -> Modes:
        """Rate of the velocity without viscosity: advection and force."""
        box = self.box
        velocity, vorticity = box.to_nodes(u), box.to_nodes(_curl(box, u))
        product = np.stack([velocity[(i + 1) % 3] * vorticity[(i + 2) % 3]
                            - velocity[(i + 2) % 3] * vorticity[(i + 1) % 3] for i in range(3)])  # fmt: skip
        return box.projected(box.to_modes(product)) + self._force(u)

    def _force(self, u: Modes) -> Modes:
        if not self.power:
            return np.zeros((), u.dtype)
        there = float(self.box.energy(u)[self._forced].sum(dtype=float))
        return np.where(self._forced, u * (self.power / (2 * there)), 0).astype(u.dtype, copy=False)


def _curl(box: Box, u: Modes) -> Modes:
    k = box.k
    curl = [k[(i + 1) % 3] * u[(i + 2) % 3] - k[(i + 2) % 3] * u[(i + 1) % 3] for i in range(3)]
    return np.stack(curl) * u.dtype.type(1j)
