"""Models scored by the share of the gap that they close on data left out of the fit, less a penalty for each.

Where no simulation is exact, the likelihood goes on growing with every explanation that is added. What a
person can use is another question: how much of the disagreement goes, and with how plain a statement.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gaitdisc.discovery.candidate_model import CandidateModel, Part, fit_model
from gaitdisc.discovery.cross_validation import left_out_errors
from gaitdisc.discovery.fitted import Fitted
from gaitdisc.discovery.noise import Noise, white_noise
from gaitdisc.discovery.scored_model import ScoredModel
from gaitdisc.discovery.shooting import Shooting
from gaitdisc.simulation.simulation import Simulation

MODEL_ERROR = 0.01  # of a channel's spread: no simulation of hardware is exact
AGREES = 1.5  # times the root mean square that a simulation that lacks nothing may leave
PER_INDEPENDENT = 20.0  # samples of what a wrong simulation leaves say as much as one independent number
CONVERGED = 1e-4  # of a number's share of the misfit
TURNS, AGAIN = 15, 6


@dataclass(frozen=True)
class GapScale:
    """What a gap is measured against."""

    noise: NDArray[np.float64]  # (channel,), standard deviation of the sensors' noise [the channel's unit]
    spread: NDArray[np.float64]  # (channel,), standard deviation of the measurement [the channel's unit]

    @property
    def size(self) -> NDArray[np.float64]:
        """What a simulation that lacks nothing may leave (channel,): noise, and a model error of a hundredth."""
        return np.sqrt(self.noise**2 + (MODEL_ERROR * self.spread) ** 2)

    @property
    def floor(self) -> float:
        """Mean square that the noise alone leaves, in squares of `size`."""
        return float(np.mean((self.noise / self.size) ** 2))

    @property
    def least(self) -> float:
        """Mean square that a simulation that lacks nothing may leave, in squares of `size`."""
        return float(np.mean((np.maximum(self.noise, MODEL_ERROR * self.spread) / self.size) ** 2))

    def mean_square(self, fit: Fitted) -> float:
        """Mean square of a residual, in squares of `size`."""
        return float(np.nanmean((fit.residual / self.size) ** 2))

    def relative(self, fit: Fitted) -> float:
        """Root mean square of a residual over the spread of its channel."""
        return float(np.sqrt(np.nanmean((fit.residual / self.spread) ** 2)))

    def agrees(self, fit: Fitted) -> bool:
        """Whether a residual is no more than noise and a hundredth of the measurement's spread explain."""
        return self.mean_square(fit) < AGREES**2 * self.least

    def gap_above(self, mean_square: float) -> float:
        """Return the root of a mean square above what the sensors' noise leaves."""
        return float(np.sqrt(max(mean_square - self.floor, 0.0)))

    def error_of(self, fit: Fitted) -> Noise:
        """Return white noise as large as an autocorrelated residual weighs against a prior."""
        return white_noise(self.size * np.sqrt(PER_INDEPENDENT * max(self.mean_square(fit), 1e-12)))


@dataclass(frozen=True, eq=False)
class CrossValidated:
    """A simulation with some explanations in it, and what it leaves of runs that it was not fitted to."""

    model: CandidateModel
    shooting: Shooting
    errors: NDArray[np.float64]  # (piece,), mean squares left out of the fit, in squares of the scale's size
    gap: float  # their root mean square above the sensors' noise

    @property
    def scored(self) -> ScoredModel:
        """The same, scored by its information criterion."""
        return ScoredModel(self.model, self.shooting)


def cross_validated(
    scale: GapScale, shooting: Shooting, base: Simulation, parts: tuple[Part, ...], like: CandidateModel
) -> CrossValidated:
    """Fit a simulation with explanations in it, and measure what it leaves of runs left out of the fit.

    like: of the same segments: where start states and numbers with bounds begin
    """
    enough = CONVERGED * shooting.seen.size / PER_INDEPENDENT
    shooting = shooting.with_noise(scale.error_of(like.fit))
    model = fit_model(shooting, base, parts, like.fit.starts, TURNS, enough, like)
    if not np.isfinite(model.fit.misfit):
        return CrossValidated(model, shooting, np.full(1, np.inf), float("inf"))
    shooting = shooting.with_noise(scale.error_of(model.fit)).with_past(model.fit.states)
    model = fit_model(shooting, base, model.parts, model.fit.starts, AGAIN, enough, model)
    if not np.isfinite(model.fit.misfit):
        return CrossValidated(model, shooting, np.full(1, np.inf), float("inf"))
    square = float(np.mean((shooting.noise.size / scale.size) ** 2))
    errors = left_out_errors(model.fit) * square / shooting.known.mean()
    return CrossValidated(model, shooting, errors, scale.gap_above(float(errors.mean())))
