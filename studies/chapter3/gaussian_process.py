"""Gaussian process regression with its variance: exact on some thousand samples, on inducing points beyond."""

from __future__ import annotations

import warnings
from dataclasses import dataclass, replace
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from gaitdisc.errors import TrainingError
from gaitdisc.recording import Samples, Scale, fit_scale
from gaitdisc.recording.arrays import autocorrelation_time

KernelKind = Literal["squared_exponential", "matern_3_2", "matern_5_2"]
KERNELS: tuple[KernelKind, ...] = ("squared_exponential", "matern_3_2", "matern_5_2")
MOST_EXACT = 1500  # samples: memory grows with their square, time with their cube
MOST_FOR_LENGTHS = 300  # samples, evenly in time, that the length scales are found on
INDUCING = 300
LEAST_SAMPLES = 20
NOTHING_KNOWN = np.empty((0, 0, 0))
FORGOTTEN = 0.05  # correlation that counts as none
JITTER = 1e-9  # of the signal's variance, so that a matrix stays positive


def kernel(
    kind: KernelKind, a: NDArray[np.float64], b: NDArray[np.float64], lengths: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Covariance of a process of size one between points (a's point, b's point).

    Not scikit-learn's: another rounding of distances turns the variance on inducing points (studies/results).
    Source: Rasmussen and Williams 2006, Gaussian Processes for Machine Learning, Eqs. 4.9 and 4.17.
    """
    a, b = a / lengths, b / lengths
    apart = np.maximum(np.sum(a**2, axis=1)[:, None] + np.sum(b**2, axis=1) - 2 * a @ b.T, 0.0)
    if kind == "squared_exponential":
        return np.exp(-0.5 * apart)
    far = np.sqrt((3 if kind == "matern_3_2" else 5) * apart)
    return (1 + far + (far**2 / 3 if kind == "matern_5_2" else 0)) * np.exp(-far)


def _shape(kind: KernelKind, lengths: Any, bounds: Any = "fixed") -> Any:
    from sklearn.gaussian_process.kernels import RBF, Matern

    return RBF(lengths, bounds) if kind == KERNELS[0] else Matern(lengths, bounds, nu=1.5 if "3_2" in kind else 2.5)


@dataclass(frozen=True, eq=False)
class GaussianProcess:
    """Mean of a Gaussian process for each output; a `gaitdisc.model.Model`."""

    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    scale: Scale
    centres: NDArray[np.float64]  # (centre, input), scaled inputs that the kernel is laid on
    lengths: NDArray[np.float64]  # (output, input), length scales of the squared-exponential kernel, of scaled inputs
    weights: NDArray[np.float64]  # (centre, output) [output's unit], of the kernels
    offset: NDArray[np.float64]  # (output,) [output's unit], mean of the training part
    noise: NDArray[np.float64]  # (output,) [output's unit], standard deviation of what the process takes for noise
    exact: bool
    size: NDArray[np.float64]  # (output,) [output's unit], standard deviation of the process far from any sample
    # (output, centre, centre), what the samples take away from that variance; empty where it was not kept
    known: NDArray[np.float64]
    kind: KernelKind = "squared_exponential"  # of the kernel

    def __call__(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """Outputs (sample, output) for inputs (sample, input)."""
        scaled = self.scale.scaled(np.asarray(x, float))
        pairs = zip(self.lengths, self.weights.T, strict=True)
        columns = [kernel(self.kind, scaled, self.centres, lengths) @ weights for lengths, weights in pairs]
        return np.column_stack(columns) + self.offset

    def sd(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """Standard deviation of the outputs without their noise, (sample, output) [output's unit]."""
        if not len(self.known):
            raise TrainingError(
                "the variance of a Gaussian process is kept when it is fitted",
                "this one was fitted without",
                "Fit it with variance=True.",
            )
        scaled, found = self.scale.scaled(np.asarray(x, float)), []
        for k, size in enumerate(self.size):
            across = kernel(self.kind, scaled, self.centres, self.lengths[k])
            left = 1.0 - np.einsum("sc,cd,sd->s", across, self.known[k], across, optimize=True)
            found.append(size * np.sqrt(np.maximum(left, 0.0)))
        return np.column_stack(found)


def fit_gaussian_process(
    samples: Samples,
    most_exact: int = MOST_EXACT,
    inducing: int = INDUCING,
    kind: KernelKind = "squared_exponential",
    variance: bool = False,
) -> GaussianProcess:
    """Fit a Gaussian process with a stationary kernel and white noise to each output.

    Length scales, size and noise maximise the likelihood of at most 300 samples, evenly in time (scikit-learn). Then
    all samples are conditioned on: exactly, or, of long records, by the projected process on inducing points that are
    far apart from each other.

    Source: Rasmussen and Williams 2006, Gaussian Processes for Machine Learning, Eqs. 2.25, 2.26, 4.17, 5.9, 8.26,
        8.27. The published code uses MATLAB's `fitrgp`, which has one length scale for all inputs.
    """
    samples.trainable(LEAST_SAMPLES)
    scale, offset, size = fit_scale(samples.x), samples.y.mean(axis=0), samples.y.std(axis=0)
    x, y = scale.scaled(samples.x), (samples.y - offset) / size
    some = np.unique(np.linspace(0, len(x) - 1, min(MOST_FOR_LENGTHS, len(x))).astype(int))
    exact = len(x) <= most_exact
    centres = x if exact else x[far_apart(x, inducing)]
    found = [_likeliest(x[some], y[some, k], kind) for k in range(y.shape[1])]
    solve = _exact_weights if exact else _projected_weights
    weights = np.column_stack([solve(x, y[:, k], centres, each) for k, each in enumerate(found)]) * size
    lengths, noise, own = (np.array([getattr(f, name) for f in found]) for name in ("lengths", "noise", "size"))
    process = GaussianProcess(
        samples.inputs, samples.outputs, scale, centres, lengths, weights, offset, np.sqrt(noise) * size, exact,
        np.sqrt(own) * size, NOTHING_KNOWN, kind,
    )  # fmt: skip
    if not variance:
        return process
    memory = autocorrelation_time(samples.y - process(samples.x), FORGOTTEN)
    slow = [each._replace(noise=each.noise * float(memory[k])) for k, each in enumerate(found)]
    known = [_exact_weights(x, np.eye(len(x)), x, each) if exact else _known(x, centres, each) for each in slow]
    return replace(process, known=np.array(known))


def far_apart(x: NDArray[np.float64], count: int) -> NDArray[np.int64]:
    """Numbers of points that are far apart from each other: each next one is the farthest from those before."""
    chosen, distance = [0], np.full(len(x), np.inf)
    while len(chosen) < min(count, len(x)):
        distance = np.minimum(distance, np.sum((x - x[chosen[-1]]) ** 2, axis=1))
        chosen.append(int(np.argmax(distance)))
    return np.array(chosen)


class Likeliest(NamedTuple):
    """Variance of the process, length scales (input,) and variance of the noise, of scaled samples."""

    size: float
    lengths: NDArray[np.float64]
    noise: float
    kind: KernelKind


def _likeliest(x: NDArray[np.float64], y: NDArray[np.float64], kind: KernelKind) -> Likeliest:
    from sklearn.gaussian_process import GaussianProcessRegressor
    from sklearn.gaussian_process.kernels import ConstantKernel, WhiteKernel

    shape = _shape(kind, np.ones(x.shape[1]), (1e-2, 1e3))
    whole = ConstantKernel(1.0, (1e-3, 1e6)) * shape + WhiteKernel(1e-2, (1e-10, 1e1))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of length scales at their bounds, which are as good as without end
        fit = GaussianProcessRegressor(whole, alpha=1e-10).fit(x, y)
    size, *lengths, noise = np.exp(getattr(fit.kernel_, "theta"))  # noqa: B009 unknown to its types
    return Likeliest(float(size), np.array(lengths), float(noise), kind)


def _exact_weights(
    x: NDArray[np.float64], y: NDArray[np.float64], _: NDArray[np.float64], found: Likeliest
) -> NDArray[np.float64]:
    from sklearn.gaussian_process import GaussianProcessRegressor
    from sklearn.gaussian_process.kernels import ConstantKernel

    whole = ConstantKernel(found.size, "fixed") * _shape(found.kind, found.lengths)
    fit = GaussianProcessRegressor(whole, alpha=found.noise + JITTER * found.size, optimizer=None).fit(x, y)  # type: ignore[arg-type]
    return found.size * np.asarray(fit.alpha_)


def _projected_weights(
    x: NDArray[np.float64], y: NDArray[np.float64], centres: NDArray[np.float64], found: Likeliest
) -> NDArray[np.float64]:
    """Solved by least squares, which loses half as many digits as the normal equations of Eq. 8.26."""
    across, root = _factors(x, centres, found)
    q, r = np.linalg.qr(np.vstack([across, root]))
    return np.sqrt(found.size) * np.linalg.lstsq(r, q[: len(x)].T @ y, rcond=None)[0]


def _factors(
    x: NDArray[np.float64], centres: NDArray[np.float64], found: Likeliest
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Kernels between samples and centres, and a root of those among the centres, times the noise."""
    across = np.sqrt(found.size) * kernel(found.kind, x, centres, found.lengths)
    among = kernel(found.kind, centres, centres, found.lengths)
    among[np.diag_indices_from(among)] += JITTER
    values, vectors = np.linalg.eigh(among)
    root = (np.sqrt(np.maximum(values, 0.0)) * vectors).T
    return across, np.sqrt(found.noise + JITTER * found.size) * root


def _known(x: NDArray[np.float64], centres: NDArray[np.float64], found: Likeliest) -> NDArray[np.float64]:
    """Share of the variance that samples take away, on fewer centres: Eq. 8.27 without the noise of what comes next."""
    across, root = _factors(x, centres, found)
    r = np.linalg.qr(np.vstack([across, root]), mode="r")
    noise = found.noise + JITTER * found.size
    upright, left = np.sqrt(noise) * np.linalg.pinv(root), np.sqrt(noise) * np.linalg.pinv(r)
    return upright @ upright.T - left @ left.T
