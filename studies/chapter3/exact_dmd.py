"""Exact dynamic mode decomposition with delays: the linear map from one sample to the next, by least squares."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gaitdisc.recording import Samples

from .dmd import DELAYS, RANK, TIME, Dmd, delayed

SMALLEST = 1e-6  # |eigenvalue| of the map below which a mode dies within a sample: rounding, or noise


def fit_exact_dmd(samples: Samples, delays: int = DELAYS, rank: int = RANK) -> Dmd:
    """Fit modes to the outputs, which are stacked with their delays (Hankel matrix).

    The map of least squares from each column to the next, projected on the first left singular vectors, has the modes
    as eigenvectors. Eigenvalues that are rounding are left out; what grows is held at its size, as in the other
    decompositions here. Amplitudes fit all columns, not the first alone.

    Source: Tu, Rowley, Luchtenburg, Brunton, Kutz 2014, J. Comput. Dyn. 1:391; Eqs. 2.5 to 2.9 of the dissertation.
        Under noise its eigenvalues are biased inwards (Dawson et al. 2016, Exp. Fluids 57:42), which the optimised one
        is not.
    """
    hankel = delayed(samples, delays, rank)
    outputs, dt = len(hankel.size), float(samples.time[1] - samples.time[0])
    before, after = hankel.columns[:, :-1], hankel.columns[:, 1:]
    small = hankel.axes.T @ before
    turn = np.linalg.lstsq(small.T, (hankel.axes.T @ after).T, rcond=None)[0].T
    values, vectors = (np.asarray(each, np.complex128) for each in np.linalg.eig(turn))
    kept = np.abs(values) > SMALLEST
    values, vectors = values[kept], vectors[:, kept]
    exact = after @ np.linalg.pinv(small) @ vectors / values
    found = np.log(values) / dt
    continuous = np.asarray(np.minimum(found.real, 0.0) + 1j * found.imag, np.complex128)
    amplitudes = _amplitudes(hankel.axes.T @ hankel.columns, vectors, continuous, dt)
    modes = (exact[:outputs] * hankel.size[:, None] * amplitudes).T
    return Dmd((TIME,), samples.outputs, modes, continuous, float(samples.time[0]), np.zeros(len(values)))


def _amplitudes(
    columns: NDArray[np.float64], vectors: NDArray[np.complex128], eigenvalues: NDArray[np.complex128], dt: float
) -> NDArray[np.complex128]:
    """Amplitudes that fit all columns best, (mode,) (Jovanovic, Schmid, Nichols 2014, Phys. Fluids 26:024103)."""
    turns = np.exp(np.outer(eigenvalues, dt * np.arange(columns.shape[1])))
    normal = (vectors.conj().T @ vectors) * (turns @ turns.conj().T).conj()
    aim = np.diag(turns @ columns.conj().T @ vectors).conj()
    return np.asarray(np.linalg.lstsq(normal, aim, rcond=None)[0], np.complex128)
