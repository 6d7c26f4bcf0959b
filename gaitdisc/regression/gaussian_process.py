"""Gaussian process regression: exact on records of some thousand samples, on inducing points beyond."""

from __future__ import annotations

import warnings
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gaitdisc.recording import Samples, Scale, scale_of
from gaitdisc.recording.arrays import read_only

MOST_EXACT = 1500  # samples: memory grows with their square, time with their cube
MOST_FOR_LENGTHS = 300  # samples, evenly in time, that the length scales are found on
INDUCING = 300
LEAST_SAMPLES = 20
JITTER = 1e-9  # of the signal's variance, so that a matrix stays positive


@dataclass(frozen=True, eq=False)
class GaussianProcess:
    """Mean of a Gaussian process for each output; a `gaitdisc.model.Model`.

    Parameters
    ----------
    centres : ndarray (centre, input)
        Scaled inputs that the kernel is laid on.
    lengths : ndarray (output, input)
        Length scales of the squared-exponential kernel, of scaled inputs.
    weights : ndarray (centre, output) [output's unit]
        Of the kernels.
    offset : ndarray (output,) [output's unit]
        Mean of the training part.
    noise : ndarray (output,) [output's unit]
        Standard deviation of what the process takes for noise.
    """

    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    scale: Scale
    centres: NDArray[np.float64]
    lengths: NDArray[np.float64]
    weights: NDArray[np.float64]
    offset: NDArray[np.float64]
    noise: NDArray[np.float64]
    exact: bool

    def __post_init__(self) -> None:
        """Freeze the numbers."""
        for name in ("centres", "lengths", "weights", "offset", "noise"):
            object.__setattr__(self, name, read_only(getattr(self, name)))

    def __call__(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """Outputs (sample, output) for inputs (sample, input)."""
        scaled = self.scale.scaled(np.asarray(x, float))
        columns = [
            _kernel(scaled, self.centres, self.lengths[k]) @ self.weights[:, k] for k in range(len(self.outputs))
        ]
        return np.column_stack(columns) + self.offset


def fit_gaussian_process(samples: Samples, most_exact: int = MOST_EXACT, inducing: int = INDUCING) -> GaussianProcess:
    """Fit a Gaussian process with a squared-exponential kernel and white noise to each output.

    Length scales, size and noise maximise the likelihood of at most 400 samples, evenly in time (scikit-learn). Then
    all samples are conditioned on: exactly, or, of long records, by the projected process on inducing points that are
    far apart from each other.

    References
    ----------
    Rasmussen and Williams 2006, Gaussian Processes for Machine Learning, Eqs. 2.25, 5.9, 8.26. The published code uses
    MATLAB's `fitrgp` with one length scale for all inputs; here each input has its own.

    Examples
    --------
    >>> t = np.arange(100) / 10
    >>> s = Samples(t[:, None], np.sin(t)[:, None], ("a",), ("b",), t, t)
    >>> bool(abs(fit_gaussian_process(s)(np.array([[2.05]]))[0, 0] - np.sin(2.05)) < 1e-4)
    True
    """
    samples.trainable(LEAST_SAMPLES)
    scale, offset = scale_of(samples.x), samples.y.mean(axis=0)
    size = samples.y.std(axis=0)
    x, y = scale.scaled(samples.x), (samples.y - offset) / size
    some = np.unique(np.linspace(0, len(x) - 1, min(MOST_FOR_LENGTHS, len(x))).astype(int))
    exact = len(x) <= most_exact
    centres = x if exact else x[far_apart(x, inducing)]
    found = [_likeliest(x[some], y[some, k]) for k in range(y.shape[1])]
    solve = _exact_weights if exact else _projected_weights
    weights = np.column_stack([solve(x, y[:, k], centres, each) for k, each in enumerate(found)]) * size
    lengths, noise = np.array([each[1] for each in found]), np.sqrt([each[2] for each in found]) * size
    return GaussianProcess(samples.inputs, samples.outputs, scale, centres, lengths, weights, offset, noise, exact)


def far_apart(x: NDArray[np.float64], count: int) -> NDArray[np.int64]:
    """Numbers of points that are far apart from each other: each next one is the farthest from those before.

    Parameters
    ----------
    x : ndarray (point, input)
        Scaled.

    Examples
    --------
    >>> far_apart(np.array([[0.0], [0.1], [3.0], [1.0]]), 3).tolist()
    [0, 2, 3]
    """
    chosen, distance = [0], np.full(len(x), np.inf)
    while len(chosen) < min(count, len(x)):
        distance = np.minimum(distance, np.sum((x - x[chosen[-1]]) ** 2, axis=1))
        chosen.append(int(np.argmax(distance)))
    return np.array(chosen)


def _likeliest(x: NDArray[np.float64], y: NDArray[np.float64]) -> tuple[float, NDArray[np.float64], float]:
    """Variance of the signal, length scales, variance of the noise."""
    from sklearn.gaussian_process import GaussianProcessRegressor
    from sklearn.gaussian_process.kernels import RBF, ConstantKernel, WhiteKernel

    shape = RBF(np.ones(x.shape[1]), (1e-2, 1e3))  # type: ignore[arg-type]
    kernel = ConstantKernel(1.0, (1e-3, 1e6)) * shape + WhiteKernel(1e-2, (1e-10, 1e1))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of length scales at their bounds, which are as good as without end
        fit = GaussianProcessRegressor(kernel, alpha=1e-10).fit(x, y)
    size, *lengths, noise = np.exp(getattr(fit.kernel_, "theta"))  # noqa: B009 unknown to its types
    return float(size), np.array(lengths), float(noise)


def _exact_weights(
    x: NDArray[np.float64], y: NDArray[np.float64], centres: NDArray[np.float64], found: tuple
) -> NDArray[np.float64]:
    from scipy.linalg import cho_factor, cho_solve

    size, lengths, noise = found
    covariance = size * _kernel(x, centres, lengths)
    covariance[np.diag_indices_from(covariance)] += noise + JITTER * size
    return size * cho_solve(cho_factor(covariance, lower=True, overwrite_a=True), y)


def _projected_weights(
    x: NDArray[np.float64], y: NDArray[np.float64], centres: NDArray[np.float64], found: tuple
) -> NDArray[np.float64]:
    """Solved by least squares, which loses half as many digits as the normal equations of Eq. 8.26."""
    size, lengths, noise = found
    across = np.sqrt(size) * _kernel(x, centres, lengths)
    among = _kernel(centres, centres, lengths)
    among[np.diag_indices_from(among)] += JITTER
    values, vectors = np.linalg.eigh(among)
    root = (np.sqrt(np.maximum(values, 0.0)) * vectors).T
    stacked = np.vstack([across, np.sqrt(noise + JITTER * size) * root])
    q, r = np.linalg.qr(stacked)
    found_weights = np.linalg.lstsq(r, q[: len(y)].T @ y, rcond=None)[0]
    return np.sqrt(size) * found_weights


def _kernel(a: NDArray[np.float64], b: NDArray[np.float64], lengths: NDArray[np.float64]) -> NDArray[np.float64]:
    a, b = a / lengths, b / lengths
    apart = np.sum(a**2, axis=1)[:, None] + np.sum(b**2, axis=1) - 2 * a @ b.T
    return np.exp(-0.5 * np.maximum(apart, 0.0))
