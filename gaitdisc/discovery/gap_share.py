"""Models scored by the share of the gap that they close on data left out of the fit, less a penalty for each.

Where no simulation is exact, the likelihood goes on growing with every explanation that is added. What a
person can use is another question: how much of the disagreement goes, and with how plain a statement.
"""

import math
from dataclasses import dataclass, field, replace

import numpy as np

from gaitdisc.discovery.criteria import CRITERIA
from gaitdisc.discovery.fitted import Fitted
from gaitdisc.discovery.noise import Noise, white_noise
from gaitdisc.discovery.paired_test import errors_rise_p
from gaitdisc.discovery.scored_model import Part, ScoredModel
from gaitdisc.recording.arrays import Values

CONVERGED = 1e-4  # of a number's share of the misfit
TURNS, AGAIN = 15, 6  # Gauss-Newton turns of a fit, and again with the noise of its residual
FOLDS = 6  # groups of runs that are left out in turn
FEWEST_RUNS = 3  # of which whole runs can be left out; of fewer, pieces of a run
PIECES = 10  # at least, that the left-out errors are given for
SHORT_RUN = 100  # numbers, of which a run is cut into few pieces
FEW, MANY = 6, 12  # pieces of all runs together, where these are short and otherwise
WEAK = 1e-11  # share of the largest singular value, below which a direction is not estimated


@dataclass(frozen=True)
class GapScale:
    """What a gap is measured against."""

    noise: Values  # (channel,), standard deviation of the sensors' noise [the channel's unit]
    spread: Values  # (channel,), standard deviation of the measurement [the channel's unit]

    @property
    def size(self) -> Values:
        """What a simulation that lacks nothing may leave (channel,): noise, and a model error of a hundredth."""
        return np.sqrt(self.noise**2 + (CRITERIA.model_error * self.spread) ** 2)

    @property
    def floor(self) -> float:
        """Mean square that the noise alone leaves, in squares of `size`."""
        return float(np.mean((self.noise / self.size) ** 2))

    @property
    def least(self) -> float:
        """Mean square that a simulation that lacks nothing may leave, in squares of `size`."""
        return float(np.mean((np.maximum(self.noise, CRITERIA.model_error * self.spread) / self.size) ** 2))

    def mean_square(self, fit: Fitted) -> float:
        """Mean square of a residual, in squares of `size`."""
        return float(np.nanmean((fit.residual / self.size) ** 2))

    def relative(self, fit: Fitted) -> float:
        """Root mean square of a residual over the spread of its channel."""
        return float(np.sqrt(np.nanmean((fit.residual / self.spread) ** 2)))

    def excess(self, fit: Fitted) -> float:
        """Root mean square of a residual above the sensors' noise, over the spread of its channel."""
        return float(np.sqrt(max(self.relative(fit) ** 2 - np.mean((self.noise / self.spread) ** 2), 0.0)))

    def agrees(self, fit: Fitted) -> bool:
        """Whether a residual is no more than noise and a hundredth of the measurement's spread explain."""
        return self.mean_square(fit) < CRITERIA.agrees**2 * self.least

    def gap_above(self, mean_square: float) -> float:
        """Return the root of a mean square above what the sensors' noise leaves."""
        return float(np.sqrt(max(mean_square - self.floor, 0.0)))

    def white_error(self, fit: Fitted) -> Noise:
        """Return white noise as large as an autocorrelated residual weighs against a prior."""
        return white_noise(self.size * np.sqrt(CRITERIA.independent * max(self.mean_square(fit), 1e-12)))


@dataclass(frozen=True, eq=False)
class CrossValidated(ScoredModel):
    """A simulation with some explanations in it, and what it leaves of runs that it was not fitted to."""

    # (piece,), mean squares left out of the fit, in squares of the scale's size; infinite where it failed
    errors: Values = field(default_factory=lambda: np.full(1, np.inf))
    gap: float = np.inf  # their root mean square above the sensors' noise


def cross_validated(scale: GapScale, begun: ScoredModel, parts: tuple[Part, ...]) -> CrossValidated:
    """Fit a simulation with explanations, from a fit of the same runs, and measure what it leaves of runs left out."""
    enough = CONVERGED * begun.shooting.seen.size / CRITERIA.independent
    model = begun.refitted(begun.shooting.with_noise(scale.white_error(begun.fit)), parts, turns=TURNS, enough=enough)
    if np.isfinite(model.fit.misfit):
        shooting = model.with_own_past().shooting.with_noise(scale.white_error(model.fit))
        model = model.refitted(shooting, turns=AGAIN, enough=enough)
    if not np.isfinite(model.fit.misfit):
        return CrossValidated(**vars(model))
    square = float(np.mean((model.noise.size / scale.size) ** 2))
    errors = errors_left_out(model.fit) * square / model.shooting.known.mean()
    return CrossValidated(**vars(model), errors=errors, gap=scale.gap_above(float(errors.mean())))


def errs_more(model: CrossValidated, other: CrossValidated) -> float:
    """Chance of so much greater left-out errors of one set if it were no worse than another (Wilcoxon, one-sided)."""
    if not np.isfinite(model.errors).all() or len(model.errors) != len(other.errors):
        return 0.0
    return errors_rise_p(np.sqrt(other.errors), np.sqrt(model.errors))


def errors_left_out(fit: Fitted) -> Values:
    """Return the mean squares of whitened residuals that the constants were estimated without (piece,).

    The fit is linear in its constants and start states around where it ended. Where whole runs are left out, their own
    start states are found, nothing else.
    """
    if len(fit.starts) >= FEWEST_RUNS:
        return _without_runs(fit)
    return _without_pieces(fit)


def _without_runs(fit: Fitted) -> Values:
    residual, slopes = fit.projected
    runs = len(residual)
    folds = min(FOLDS, runs)
    fold = np.arange(runs) * folds // runs
    errors = []
    for number in range(folds):
        moved = _estimate(fit.among(np.flatnonzero(fold != number)))
        for run in np.flatnonzero(fold == number):
            pieces = np.array_split(residual[run] - slopes[run] @ moved, math.ceil(PIECES / runs))
            errors += [float(np.mean(piece**2)) for piece in pieces]
    return np.array(errors)


def _without_pieces(fit: Fitted) -> Values:
    """As above with one or two runs: pieces are left out, never the first of a run, which determines its start."""
    (runs, rows), known = fit.white.shape, fit.starts.shape[1]
    pieces = math.ceil((FEW if fit.white.size < SHORT_RUN * runs else MANY) / runs)
    errors = []
    for run in range(runs):
        for piece in np.array_split(np.arange(rows), pieces + 1)[1:]:
            white, slopes = fit.white.copy(), fit.slopes.copy()
            white[run, piece], slopes[run, piece] = 0.0, 0.0
            moved = _estimate(replace(fit, white=white, slopes=slopes))
            residual = white[run] - slopes[run, :, known:] @ moved
            start = np.linalg.lstsq(slopes[run, :, :known], residual, rcond=None)[0]
            error = fit.white[run, piece] - fit.slopes[run, piece] @ np.concatenate([start, moved])
            errors.append(float(np.mean(error**2)))
    return np.array(errors)


def _estimate(fit: Fitted) -> Values:
    """By how much the constants of least misfit differ from a fit's (free,)."""
    residual, slopes = fit.stacked
    if not fit.free:
        return np.zeros(0)
    normal = slopes.T @ slopes
    size = np.sqrt(np.maximum(np.diag(normal), 1e-300))
    return np.linalg.lstsq(normal / np.outer(size, size), slopes.T @ residual / size, rcond=WEAK)[0] / size
