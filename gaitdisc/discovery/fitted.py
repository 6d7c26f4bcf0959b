"""A simulation fitted to segments, what starts and random effects explain of its residual, and the file's prior.

Source: Patterson and Thompson 1971, Biometrika 58, 545 (restricted likelihood).
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from gaitdisc.recording.arrays import Values
from gaitdisc.simulation.parts import Parameter
from gaitdisc.simulation.simulation import Simulation

OF_SEGMENTS = ("starts", "states", "residual", "white", "slopes")  # of a fit, one row for each segment


@dataclass(frozen=True)
class Prior:
    """Normal distributions of parameters around the file's values, cut off at the file's bounds.

    Half the width between the bounds is two standard deviations.
    """

    names: tuple[str, ...] = ()
    # (number,), where they stand among the parameters
    places: NDArray[np.intp] = field(default_factory=lambda: np.zeros(0, dtype=np.intp))
    # (number,) each, as in the file [each parameter's unit]
    value: Values = field(default_factory=lambda: np.zeros(0))
    low: Values = field(default_factory=lambda: np.zeros(0))
    high: Values = field(default_factory=lambda: np.zeros(0))

    @property
    def sd(self) -> Values:
        """Standard deviations (number,)."""
        return (self.high - self.low) / 4

    def left(self, values: Values) -> Values:
        """Return how far numbers are from the file's, in standard deviations (number,): file minus number."""
        return (self.value - values[self.places]) / self.sd

    def among(self, free: tuple[str, ...]) -> Prior:
        """Return the prior of those of its parameters that are fitted."""
        kept = np.array([name in free for name in self.names], bool)
        names = tuple(name for name in self.names if name in free)
        return Prior(names, self.places[kept], self.value[kept], self.low[kept], self.high[kept])

    def within(self, values: Values) -> Values:
        """Return parameters (parameter,) with those that have bounds put inside them."""
        inside = values.copy()
        inside[self.places] = np.clip(values[self.places], self.low, self.high)
        return inside


@dataclass(frozen=True)
class RandomEffects:
    """A residual and the slopes of constants, along the principal axes of independent random effects."""

    products: Values  # (1 + free, 1 + free), of the residual and the slopes, those of the prior among them
    along: Values  # (segment, effect, 1 + free), their products with each principal effect
    strength: Values  # (segment, effect), sum of squares that a principal effect of unit size adds

    def likelihood(self, variance: float, numbers: int, least: float = 0.0) -> tuple[float, float]:
        """Return minus twice the log likelihood, up to a constant, and the residual's variance that is likeliest.

        variance: of each effect, over the residual's
        numbers: independent ones in the residual
        least: that the residual's variance is known to have
        """
        weights = variance / (1 + variance * self.strength)
        normal = self.products - np.einsum("seb,se,sec->bc", self.along, weights, self.along)
        constants = np.linalg.lstsq(normal[1:, 1:], normal[1:, 0], rcond=1e-12)[0]
        squares = float(normal[0, 0] - normal[0, 1:] @ constants)
        level = max(squares / numbers, least)
        volume = np.log1p(variance * self.strength).sum()
        return float(volume + numbers * np.log(level) + squares / level), level


@dataclass(frozen=True)
class Fitted:
    """A simulation fitted to segments."""

    free: tuple[str, ...]
    values: Values  # (parameter,), every parameter of the simulation, fitted or not, in its unit
    starts: Values  # (segment, state), start states
    states: Values  # (segment, sample, state), the run
    residual: Values  # (segment, sample, channel), measured minus run [the channel's unit]
    white: Values  # (segment, sample times channel), the residual as independent numbers of unit variance
    # (segment, sample times channel, state + free), what each start state and each constant would change in `white`;
    # zero where a run failed
    slopes: Values
    prior: Prior = field(default_factory=Prior)  # of those of the constants that have bounds; they stand last in `free`
    # (free, free), covariance of the constants where they were estimated otherwise than by the misfit
    stated: Values | None = None

    @property
    def misfit(self) -> float:
        """Sum of squares of `white` and of the prior: minus twice the log posterior density, up to a constant."""
        if not np.isfinite(self.white).all():
            return np.inf
        return float((self.white**2).sum() + (self.prior.left(self.values) ** 2).sum())

    @property
    def misfits(self) -> Values:
        """The misfit of each segment (segment,); infinite where it failed."""
        squares = (self.white**2).sum(axis=1)
        return np.where(np.isfinite(squares), squares, np.inf)

    def among(self, some: NDArray[np.intp]) -> Fitted:
        """Return the fit of some of the segments, by their numbers."""
        return replace(self, stated=None, **{name: getattr(self, name)[some] for name in OF_SEGMENTS})

    def where(self, better: NDArray[np.bool_], other: Fitted) -> Fitted:
        """Return another fit's segments where these are better, and its constants if all are."""
        if better.all():
            return other
        if not better.any():
            return self
        pairs = {name: (getattr(self, name), getattr(other, name)) for name in OF_SEGMENTS}
        which = {name: better.reshape(-1, *[1] * (mine.ndim - 1)) for name, (mine, _) in pairs.items()}
        parts = {name: np.where(which[name], its, mine) for name, (mine, its) in pairs.items()}
        return replace(self, stated=None, **parts)

    @property
    def start_basis(self) -> Values:
        """Orthonormal basis, segment by segment, of what the start states can explain (segment, number, state)."""
        return find_basis(self.slopes[..., : self.starts.shape[1]])

    @property
    def projected(self) -> tuple[Values, Values]:
        """What the start states cannot explain: of `white` (segment, number), and of the constants' slopes."""
        basis, constants = self.start_basis, self.slopes[..., self.starts.shape[1] :]
        return without(basis, self.white[..., None])[..., 0], without(basis, constants)

    @property
    def stacked(self) -> tuple[Values, Values]:
        """As `projected`, flat, with a row for each number of the prior (row,), (row, free)."""
        left, slopes = self.projected
        rows = np.zeros((len(self.prior.names), len(self.free)))
        rows[:, len(self.free) - len(rows) :] = np.diag(1 / self.prior.sd)
        flat = np.vstack([slopes.reshape(self.white.size, len(self.free)), rows])
        return np.concatenate([left.ravel(), self.prior.left(self.values)]), flat

    def beside(self, effects: Values) -> RandomEffects:
        """Return the residual beside random effects (segment, number, effect): what each changes of `white`."""
        flat = np.column_stack(self.stacked)
        effects = without(self.start_basis, effects)
        strength, axes = np.linalg.eigh(np.swapaxes(effects, 1, 2) @ effects)
        along = np.swapaxes(effects @ axes, 1, 2) @ flat[: self.white.size].reshape(*self.white.shape, -1)
        return RandomEffects(flat.T @ flat, along, np.maximum(strength, 0.0))

    @property
    def covariance(self) -> Values:
        """Covariance of the fitted constants (free, free), from the curvature of the misfit."""
        if self.stated is not None:
            return self.stated
        if not self.free:
            return np.zeros((0, 0))
        flat = self.stacked[1]
        size = np.linalg.norm(flat, axis=0)
        size[size == 0] = 1.0
        return np.linalg.pinv((flat / size).T @ (flat / size), rcond=1e-12) / np.outer(size, size)


def read_prior(simulation: Simulation, exact: frozenset[str] = frozenset()) -> Prior:
    """Read the prior off a simulation's bounds.

    simulation: a parameter with `low` and `high` has a prior; one with a single bound or none is exact

    >>> from gaitdisc.simulation.simulation_file import bundled
    >>> prior = read_prior(bundled("ankle"), frozenset(["b"]))
    >>> prior.names, prior.sd.round(3).tolist()
    (('inertia', 'k'), [0.049, 19.5])
    """
    priors = [
        (place, parameter.name, parameter.value, *find_bounds(parameter))
        for place, parameter in enumerate(simulation.parameters)
        if find_bounds(parameter) and parameter.name not in exact
    ]
    if not priors:
        return Prior()
    places, names, *numbers = zip(*priors, strict=True)
    return Prior(names, np.array(places, dtype=np.intp), *(np.array(each, float) for each in numbers))


def find_bounds(parameter: Parameter) -> tuple[float, ...]:
    """Return a parameter's `low` and `high`, or nothing where it has not both."""
    low, high = parameter.low, parameter.high
    return (low, high) if low is not None and high is not None and low < high else ()


def find_basis(slopes: Values) -> Values:
    """Return an orthonormal basis, segment by segment, of what the start states explain, from their slopes."""
    size = np.linalg.norm(slopes, axis=1, keepdims=True)
    basis, triangle = np.linalg.qr(slopes / np.where(size > 0, size, 1.0))
    weak = np.abs(np.diagonal(triangle, axis1=1, axis2=2)) < 1e-7
    return basis * ~weak[:, None, :]


def without(basis: Values, columns: Values) -> Values:
    """Return whitened columns (segment, number, column) less what a basis of `find_basis` explains of them."""
    return columns - basis @ (np.swapaxes(basis, 1, 2) @ columns)
