"""A field by few numbers: its proper orthogonal modes, and the course that it takes every year."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from gaitdisc.errors import TrainingError
from gaitdisc.recording.field import Field

ENERGY = 0.99
COLUMNS_AT_ONCE = 20_000
LEAST = 1e-12  # of the largest energy: modes below it are rounding


@dataclass(frozen=True, eq=False)
class Modes:
    """An orthonormal basis of a field's fluctuations.

    The basis spans the leading proper orthogonal modes, and is turned within their span so that every coefficient has
    the same variance in training. A fit that scales each of its outputs, as all fits here do, then weighs errors by
    their energy; on the modes themselves it would take the last, faintest one for as important as the first.
    """

    mean: NDArray[np.float32]  # (point, quantity) [each quantity's unit], of the training snapshots
    # (quantity,) [each quantity's unit], root mean square fluctuation over points and training snapshots; energies of
    # quantities are compared by it
    spread: NDArray[np.float32]
    basis: NDArray[np.float32]  # (point * quantity, mode), orthonormal
    # (snapshot,), share of the energy in each proper orthogonal mode, all of them, decreasing
    energies: NDArray[np.float64]

    @property
    def count(self) -> int:
        """Modes that are kept."""
        return self.basis.shape[1]

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the coefficients."""
        return tuple(f"mode {k + 1}" for k in range(self.count))

    def coefficients(self, values: NDArray[np.floating]) -> NDArray[np.float64]:
        """Coefficients of snapshots, (snapshot, mode)."""
        scaled = (values - self.mean) / self.spread
        return (scaled.reshape(len(values), -1) @ self.basis).astype(float)

    def fields(self, coefficients: NDArray[np.floating]) -> NDArray[np.float32]:
        """Snapshots from coefficients, (snapshot, point, quantity) [each quantity's unit]."""
        scaled = coefficients.astype(np.float32) @ self.basis.T
        return scaled.reshape(len(coefficients), *self.mean.shape) * self.spread + self.mean


def fit_modes(values: NDArray[np.floating], energy: float = ENERGY, most: int | None = None) -> Modes:
    """Proper orthogonal modes of training snapshots, by their products with each other (method of snapshots).

    Source: Sirovich 1987, Turbulence and the dynamics of coherent structures (method of snapshots).
    """
    if len(values) < 2 or not 0 < energy <= 1:
        raise TrainingError(
            "modes of a field need two snapshots or more, and a share of the energy above 0 and at most 1",
            f"found {len(values)} snapshots, and the share {energy:g}",
            "Give more snapshots, or a share such as 0.99.",
        )
    mean = values.mean(axis=0, dtype=float).astype(np.float32)
    fluctuation = values - mean
    spread = np.sqrt(np.mean(fluctuation**2, axis=(0, 1), dtype=float)).astype(np.float32)
    if not (spread > 0).all():
        raise TrainingError(
            "modes of a field need quantities that vary",
            f"quantity {int(np.argmin(spread)) + 1} is the same in all {len(values)} snapshots",
            "Leave this quantity away.",
        )
    scaled = (fluctuation / spread).reshape(len(values), -1)
    products = np.zeros((len(scaled), len(scaled)))
    for first in range(0, scaled.shape[1], COLUMNS_AT_ONCE):  # in double precision, a part at a time
        part = scaled[:, first : first + COLUMNS_AT_ONCE].astype(float)
        products += part @ part.T
    found, vectors = np.linalg.eigh(products)
    found, vectors = found[::-1], vectors[:, ::-1]
    kept = found > LEAST * found[0]
    shares = np.where(kept, found, 0.0) / found[kept].sum()
    count = min(int(np.searchsorted(np.cumsum(shares), energy - 1e-9)) + 1, int(kept.sum()), most or len(found))
    weights = vectors[:, :count] / np.sqrt(found[:count]) @ evening_rotation(found[:count])
    return Modes(mean, spread, scaled.T @ weights.astype(np.float32), shares)


def evening_rotation(variances: NDArray[np.float64]) -> NDArray[np.float64]:
    """Rotation after which uncorrelated coefficients of these variances all have their mean variance.

    Each plane rotation sets one diagonal element of the covariance to the mean; there is one that does, as long as one
    element lies above the mean and one below.

    Source: Horn 1954, Doubly stochastic matrices and the diagonal of a rotation matrix.
    """
    count, mean = len(variances), float(np.mean(variances))
    covariance, turn, left = np.diag(variances.astype(float)), np.eye(count), list(range(count))
    for _ in range(count - 1):
        diagonal = covariance[left, left]
        i, j = left[int(diagonal.argmax())], left[int(diagonal.argmin())]
        above, below, between = covariance[i, i] - mean, covariance[j, j] - mean, covariance[i, j]
        if above <= 1e-12 * mean or below >= -1e-12 * mean:
            break
        tangent = (-between - np.sqrt(between**2 - above * below)) / below
        cosine = 1 / np.hypot(1.0, tangent)
        plane, pair = np.array([[cosine, -tangent * cosine], [tangent * cosine, cosine]]), [i, j]
        covariance[:, pair] = covariance[:, pair] @ plane
        covariance[pair] = plane.T @ covariance[pair]
        turn[:, pair] = turn[:, pair] @ plane
        left.remove(i)
    return turn


@dataclass(frozen=True, eq=False)
class Season:
    """Mean field of every time of the year."""

    # (time of the year, point, quantity) [each quantity's unit], one time of the year where the field has no season:
    # its mean
    course: NDArray[np.float32]

    def at(self, snapshots: NDArray[np.intp]) -> NDArray[np.float32]:
        """Mean field at the time of year of snapshots, (snapshot, point, quantity) [each quantity's unit]."""
        return self.course[snapshots % len(self.course)]

    def departures(self, field: Field) -> Field:
        """Departures of every snapshot from the mean of its time of year."""
        return replace(field, values=field.values - self.at(np.arange(len(field))))


def season_of(field: Field, snapshots: NDArray[np.intp], period: int) -> Season:
    """Mean of every time of the year over some snapshots; their mean of all where a time of year is not among them."""
    mean = field.values[snapshots].mean(axis=0, dtype=float)
    if not period:
        return Season(mean[None].astype(np.float32))
    of_year = [field.values[snapshots[snapshots % period == k]] for k in range(period)]
    course = np.stack([part.mean(axis=0, dtype=float) if len(part) else mean for part in of_year])
    return Season(course.astype(np.float32))
