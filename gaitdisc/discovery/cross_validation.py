"""Cross-validation of a fit: what it leaves of runs whose numbers were estimated without them, to first order.

Source: Stone 1974, J. R. Stat. Soc. B 36, 111.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from gaitdisc.discovery.fitted import Fitted, start_basis, without

FOLDS = 6
FEWEST_RUNS = 3  # of which whole runs can be left out; of fewer, pieces of a run
PIECES = 10  # at least, that the left-out errors are given for
SHORT_RUN = 100  # numbers, of which a run is cut into few pieces
FEW, MANY = 6, 12
WEAK = 1e-11


def left_out_errors(fit: Fitted) -> NDArray[np.float64]:
    """Return the mean squares of whitened residuals that the constants were estimated without (piece,).

    The fit is linear in its constants and start states around where it ended. Where whole runs are left out, their own
    start states are found, nothing else.
    """
    if len(fit.starts) >= FEWEST_RUNS:
        return _without_runs(fit)
    return _without_pieces(fit)


def _without_runs(fit: Fitted) -> NDArray[np.float64]:
    left, slopes = fit.projected
    normal = np.swapaxes(slopes, 1, 2) @ slopes
    match = np.einsum("srf,sr->sf", slopes, left)
    prior_normal, prior_match = _prior(fit)
    runs = len(left)
    folds = min(FOLDS, runs)
    fold = np.arange(runs) * folds // runs
    errors = []
    for number in range(folds):
        others = fold != number
        moved = _solved(normal[others].sum(axis=0) + prior_normal, match[others].sum(axis=0) + prior_match)
        for run in np.flatnonzero(~others):
            pieces = np.array_split(left[run] - slopes[run] @ moved, math.ceil(PIECES / runs))
            errors += [float(np.mean(piece**2)) for piece in pieces]
    return np.array(errors)


def _without_pieces(fit: Fitted) -> NDArray[np.float64]:
    """As above with one or two runs: pieces are left out, never the first of a run, which determines its start."""
    runs, rows = fit.white.shape
    pieces = math.ceil((FEW if fit.white.size < SHORT_RUN * runs else MANY) / runs)
    errors = []
    for run in range(runs):
        for piece in np.array_split(np.arange(rows), pieces + 1)[1:]:
            kept = np.setdiff1d(np.arange(rows), piece)
            start, moved = _estimated_without(fit, run, kept)
            n = fit.starts.shape[1]
            slopes = fit.slopes[run, piece]
            error = fit.white[run, piece] - slopes[:, :n] @ start - slopes[:, n:] @ moved
            errors.append(float(np.mean(error**2)))
    return np.array(errors)


def _estimated_without(
    fit: Fitted, run: int, kept: NDArray[np.intp]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Start states of one run (state,) and the constants (free,), from its kept rows and all other runs."""
    n = fit.starts.shape[1]
    normal, match = _prior(fit)
    for number in range(len(fit.white)):
        rows = kept if number == run else np.arange(fit.white.shape[1])
        basis = start_basis(fit.slopes[number : number + 1, rows, :n])
        left = without(basis, fit.white[number : number + 1, rows, None])[0, :, 0]
        slopes = without(basis, fit.slopes[number : number + 1, rows, n:])[0]
        normal, match = normal + slopes.T @ slopes, match + slopes.T @ left
    moved = _solved(normal, match)
    own, right = fit.slopes[run, kept], fit.white[run, kept]
    start = np.linalg.lstsq(own[:, :n], right - own[:, n:] @ moved, rcond=None)[0]
    return np.asarray(start, np.float64), moved


def _prior(fit: Fitted) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """What the prior adds to the normal equations (free, free), (free,)."""
    own = len(fit.prior.names)
    normal, match = np.zeros((len(fit.free), len(fit.free))), np.zeros(len(fit.free))
    if own:
        first = len(fit.free) - own
        normal[first:, first:] = np.diag(1 / fit.prior.sd**2)
        match[first:] = fit.prior.left(fit.values) / fit.prior.sd
    return normal, match


def _solved(normal: NDArray[np.float64], match: NDArray[np.float64]) -> NDArray[np.float64]:
    if not len(match):
        return match
    size = np.sqrt(np.maximum(np.diag(normal), 1e-300))
    return np.linalg.lstsq(normal / np.outer(size, size), match / size, rcond=WEAK)[0] / size
