"""What describes a turbulent flow: its spectrum, dissipation and Reynolds number."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .box import Box


@dataclass(frozen=True)
class FlowNumbers:
    """Numbers of one instant, per mass, in units of box and time."""

    energy: float
    dissipation: float
    re_lambda: float
    kmax_eta: float  # largest wavenumber times Kolmogorov's length: 1 or more resolves the dissipation
    integral_length: float  # Longitudinal integral length, and its time: length over root mean square velocity
    turnover: float  # Longitudinal integral length, and its time: length over root mean square velocity


def energy_spectrum(box: Box, u: NDArray[np.complexfloating]) -> NDArray[np.float64]:
    """Energy in shells of unit width around each whole wavenumber from 0; the sum is the energy."""
    shell = np.rint(np.sqrt(box.squared)).astype(int).ravel()
    return np.bincount(shell, weights=box.energy(u).astype(float).ravel()).astype(float)


def flow_numbers(box: Box, u: NDArray[np.complexfloating], viscosity: float) -> FlowNumbers:
    """Energy, dissipation, and what follows from them for isotropic turbulence.

    Source: Pope 2000, Turbulent flows, section 6: lambda^2 = 15 viscosity u'^2 / dissipation, eta = (viscosity^3 /
        dissipation)^(1/4), L = pi / (2 u'^2) times the integral of E(k) / k.
    """
    each = box.energy(u).astype(float)
    energy = float(each.sum())
    dissipation = float(2 * viscosity * (box.squared * each).sum())
    speed = np.sqrt(2 * energy / 3)
    taylor = np.sqrt(15 * viscosity / dissipation) * speed
    eta = (viscosity**3 / dissipation) ** 0.25
    spectrum = energy_spectrum(box, u)
    k = np.arange(1, len(spectrum))
    length = float(np.pi / (2 * speed**2) * np.sum(spectrum[1:] / k))
    return FlowNumbers(
        energy, dissipation, float(speed * taylor / viscosity), float(box.largest * eta), length, length / float(speed)
    )
