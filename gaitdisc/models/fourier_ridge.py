"""Ridge regression on columns and on random Fourier features of them: what a network that sees the same has to beat."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gaitdisc.errors import TrainingError
from gaitdisc.recording import Samples, Scale, fit_scale
from gaitdisc.recording.arrays import Values

PENALTIES = tuple(10.0**power for power in range(-8, 2))
WIDTHS = (0.5, 1.0, 2.0, 4.0)  # of the kernel, in typical distances between two samples
TRIAL_FEATURES = 300  # with which the width is chosen
ROWS_AT_ONCE = 4096
LEAST_SAMPLES = 20


@dataclass(frozen=True, eq=False)
class FourierRidge:
    """Linear in the inputs and in cosines of random mixtures of them; a `gaitdisc.model.Model`."""

    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    x_scale: Scale
    y_scale: Scale
    # (input, feature), of the cosines, for scaled inputs; no feature makes it plain ridge regression
    frequencies: Values
    phases: Values  # (feature,) [rad], of the cosines
    weights: Values  # (input + feature, output), for scaled inputs, cosines, and scaled outputs
    offset: Values  # (output,), of the scaled outputs
    penalty: float  # per sample, as chosen on the check part

    def __call__(self, x: Values) -> Values:
        """Outputs (sample, output) for inputs (sample, input); NaN where an input is NaN."""
        scaled = self.x_scale.scaled(np.asarray(x, float))
        blocks = [scaled[row : row + ROWS_AT_ONCE] for row in range(0, max(len(scaled), 1), ROWS_AT_ONCE)]
        outputs = [_columns(block, self.frequencies, self.phases) @ self.weights + self.offset for block in blocks]
        return self.y_scale.unscaled(np.vstack(outputs))


def fit_fourier_ridge(training: Samples, check: Samples, features: int = 0, seed: int = 0) -> FourierRidge:
    """Fit a ridge regression whose penalty, and width of the kernel, are those that do best on a check part.

    Minimises sum (y - W h - b)^2 / samples + penalty sum W^2 on scaled outputs, where h holds the scaled inputs and
    sqrt(2 / features) cos(frequency x + phase). The check part takes no part in the fit nor in the scales.

    features: random Fourier features; 0 is ridge regression on the inputs alone
    Source: Rahimi and Recht 2007, Random features for large-scale kernel machines; the Gaussian kernel.

    >>> t = np.arange(400) / 100
    >>> s = Samples(np.sin(t)[:, None], 3 * np.sin(t)[:, None] + 1, ("a",), ("b",), t, t)
    >>> fit_fourier_ridge(s.rows(slice(0, 300)), s.rows(slice(300, None)))(np.array([[0.5]])).round(3)
    array([[2.5]])
    """
    training.trainable(LEAST_SAMPLES)
    if not len(check):
        raise TrainingError(
            "ridge regression must have a validation part to choose its penalty",
            "the validation part has no samples",
            "Record longer, or give validation a larger share.",
        )
    x_scale, y_scale = fit_scale(training.x), fit_scale(training.y)
    part, checked = (
        (x_scale.scaled(s.x).astype(np.float32), y_scale.scaled(s.y).astype(np.float32)) for s in (training, check)
    )
    rng = np.random.default_rng(seed)
    directions = rng.normal(size=(training.x.shape[1], features))
    phases = rng.uniform(0, 2 * np.pi, features)
    width = 1.0
    if directions.shape[1]:
        few, some = slice(0, TRIAL_FEATURES), part[0][:: max(1, len(part[0]) // 500)]
        typical = float(np.sqrt(np.median(((some - some[::-1]) ** 2).sum(axis=1)))) or 1.0
        losses = [_solved(part, checked, directions[:, few] / (w * typical), phases[few])[1] for w in WIDTHS]
        width = WIDTHS[int(np.argmin(losses))] * typical
    frequencies = directions / width
    penalty, _, weights, offset = _solved(part, checked, frequencies, phases)
    return FourierRidge(
        training.inputs, training.outputs, x_scale, y_scale, frequencies, phases, weights, offset, penalty
    )


Part = tuple[NDArray[np.float32], NDArray[np.float32]]


def _solved(part: Part, checked: Part, frequencies: Values, phases: Values) -> tuple[float, float, Values, Values]:
    """Penalty, mean squared error on the check part, weights and offset."""
    from scipy.linalg import cho_factor, cho_solve

    squares, products, mean = _squares(part, frequencies, phases)
    h = _columns(checked[0], frequencies, phases)
    best = None
    for penalty in PENALTIES:
        try:
            factor = cho_factor(squares + penalty * np.eye(len(squares)), check_finite=False)
        except np.linalg.LinAlgError:
            continue  # rounding: inputs that say the same need a larger penalty
        weights = cho_solve(factor, products, check_finite=False)
        offset = -mean @ weights  # scaled outputs have no mean
        loss = float(np.mean((checked[1] - h @ weights - offset) ** 2))
        if best is None or loss < best[1]:
            best = (penalty, loss, weights, offset)
    assert best is not None  # the largest penalty outweighs any rounding
    return best


def _squares(part: Part, frequencies: Values, phases: Values) -> tuple[Values, Values, Values]:
    """Mean products of the columns about their means, of columns and outputs, and the means of the columns."""
    count = part[0].shape[1] + len(phases)
    squares, products, total = np.zeros((count, count)), np.zeros((count, part[1].shape[1])), np.zeros(count)
    for row in range(0, len(part[0]), ROWS_AT_ONCE):
        # in double precision: in single, rounding outweighs the small penalties that columns that say the same rest on
        h = _columns(part[0][row : row + ROWS_AT_ONCE], frequencies, phases).astype(float)
        squares += h.T @ h
        products += h.T @ part[1][row : row + ROWS_AT_ONCE]
        total += h.sum(axis=0)
    n = len(part[0])
    mean = total / n
    return squares / n - np.outer(mean, mean), products / n, mean


def _columns(x: NDArray, frequencies: Values, phases: Values) -> NDArray:
    """Scaled inputs and cosines, in the precision of the inputs."""
    if not len(phases):
        return x
    cosines = np.cos(x @ frequencies.astype(x.dtype) + phases.astype(x.dtype))
    return np.hstack([x, cosines * x.dtype.type(np.sqrt(2 / len(phases)))])
