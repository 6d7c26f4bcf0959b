"""Ridge regression with phase harmonics: the rival that a network has to beat."""

from dataclasses import dataclass

import numpy as np

from gaitdisc.recording import Samples, Scale, fit_scale
from gaitdisc.recording.arrays import Values

PENALTIES = tuple(10.0**power for power in range(-7, 2))
PHASE = "phi"
INNER_SHARE = 0.15  # of the samples, on which a penalty is chosen
LEAST_SAMPLES = 50
LEAST_BEFORE_INNER = 20
SEAM_S = 0.3  # as Trajectory.split: zero-lag filters look ahead over the seam


@dataclass(frozen=True, eq=False)
class Ridge:
    """Linear in the inputs and in harmonics of percent stride; a `gaitdisc.model.Model`."""

    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    # sines and cosines of 1 to so many cycles a stride, beside the inputs; 0 where `phi` is not among them
    harmonics: int
    scale: Scale  # of inputs and harmonics in the training part
    weights: Values  # (column, output) [each output's unit], for scaled columns
    offset: Values  # (output,) [each output's unit], mean of each output in the training part
    penalty: float  # per sample, as chosen on the inner block

    def __call__(self, x: Values) -> Values:
        """Outputs (sample, output) for inputs (sample, input)."""
        return self.scale.scaled(_columns(x, self.inputs, self.harmonics)) @ self.weights + self.offset


def fit_ridge(samples: Samples, harmonics: int = 8) -> Ridge:
    """Fit a ridge regression.

    Minimises sum (y - W x - b)^2 / samples + penalty sum W^2 on scaled columns. The penalty is the one of `PENALTIES`
    that does best on the last `INNER_SHARE` of the samples (contiguous, 0.3 s apart, all outputs weighed by their
    variance); then everything is fitted again on all samples.

    harmonics: harmonics of percent stride beside the inputs, where `phi` is among them; 0 for none

    >>> t = np.arange(400) / 100
    >>> s = Samples(np.sin(t)[:, None], 3 * np.sin(t)[:, None] + 1, ("a",), ("b",), t, t)
    >>> fit_ridge(s)(np.array([[0.5]])).round(3)
    array([[2.5]])
    """
    samples.trainable(LEAST_SAMPLES)
    harmonics = harmonics if PHASE in samples.inputs else 0
    before, inner = samples.last_block(INNER_SHARE, SEAM_S)
    before.trainable(LEAST_BEFORE_INNER)
    spread = before.y.std(axis=0)
    scale, offset, solved = _solved(before, harmonics, PENALTIES)
    columns = scale.scaled(_columns(inner.x, inner.inputs, harmonics))
    losses = [float(np.mean(((inner.y - (columns @ weights + offset)) / spread) ** 2)) for weights in solved]
    penalty = PENALTIES[int(np.argmin(losses))]
    scale, offset, (weights,) = _solved(samples, harmonics, (penalty,))
    return Ridge(samples.inputs, samples.outputs, harmonics, scale, weights, offset, penalty=penalty)


def _solved(samples: Samples, harmonics: int, penalties: tuple[float, ...]) -> tuple[Scale, Values, list[Values]]:
    """Scale, offset, and the weights (column, output) of each penalty."""
    columns = _columns(samples.x, samples.inputs, harmonics)
    scale = fit_scale(columns)
    scaled, offset = scale.scaled(columns), samples.y.mean(axis=0)
    normal, right = scaled.T @ scaled / len(scaled), scaled.T @ (samples.y - offset) / len(scaled)
    return scale, offset, [np.linalg.solve(normal + penalty * np.eye(len(normal)), right) for penalty in penalties]


def _columns(x: Values, inputs: tuple[str, ...], harmonics: int) -> Values:
    if not harmonics:
        return x
    turns = np.deg2rad(3.6 * x[:, inputs.index(PHASE), None]) * np.arange(1, harmonics + 1)
    return np.hstack([x, np.sin(turns), np.cos(turns)])
