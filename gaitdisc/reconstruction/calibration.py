"""A person whom a model never saw, after a few strides of which the states are known: what the model then says."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from gaitdisc.errors import StrideError
from gaitdisc.reconstruction.state_errors import stride_numbers
from gaitdisc.reconstruction.window_model import STATIC, OfOne, ScaledModel, WindowModel
from gaitdisc.reconstruction.windows import SEAM_S, present, stacked
from gaitdisc.recording import Samples
from gaitdisc.recording.arrays import Values

PENALTIES = tuple(10.0**power for power in np.arange(-3.0, 2.5, 0.5))
USUAL_PENALTY = 0.1  # where no other person is there to rehearse on
STATES_WEIGHT = 3.0  # of the reconstructed states beside the readings, in standard deviations


@dataclass(frozen=True, eq=False)
class Corrected(OfOne):
    """A model with what is added for one person: linear in the readings, their history and the reconstructed states."""

    model: ScaledModel
    # (column,), of readings and reconstructed states in the calibration strides, each scaled as in the model's
    # training part
    mean: Values
    # (column, state) [each state's unit], zero is the model of the population with the mean error of these strides
    # taken off
    weights: Values
    offset: Values  # (state,) [each state's unit], mean error in the calibration strides

    def __call__(self, x: Values) -> Values:
        """States (window, state) of the person, each in its unit."""
        states = self.model(x)
        return states + (_columns(self.model, x, states) - self.mean) @ self.weights + self.offset


def first_strides(trials: Sequence[Samples], count: int, reach_s: float) -> tuple[Samples, NDArray[np.bool_]]:
    """Part a person's first strides from the rest, with a gap as long as a window (`reach_s`) and 0.3 s.

    returns rest (window,): which windows of all trials, stacked, come after these and share no reading with them
    """
    windows, stride = stacked(trials), stride_numbers(trials)
    first, rest = (stride >= 0) & (stride < count), stride >= count
    if not first.any() or not rest.any():
        raise StrideError(
            f"there must be {count} strides for calibration, and further strides for the test",
            f"{windows.subject or 'the person'} has {len(np.unique(stride[stride >= 0]))} strides",
            "Calibrate on fewer strides, or record longer.",
        )
    last = int(np.flatnonzero(first)[-1])
    trial = np.repeat(np.arange(len(trials)), [len(t) for t in trials])
    near = (trial == trial[last]) & (windows.time < windows.time[last] + reach_s + SEAM_S - 1e-9)
    return windows.rows(first), rest & ~near


def calibrate(done: WindowModel, strides: Samples, penalty: float = USUAL_PENALTY) -> WindowModel:
    """Correct a model for one person by ridge regression of its error, shrunk towards the model as it is.

    Minimises sum (y - f(x) - b - W h)^2 / windows + penalty sum W^2, where h holds the scaled readings with their
    history and, three times as heavy, the scaled states that the model f reconstructs.

    penalty: from `rehearse`; a large one takes off the mean error alone
    """
    return _calibrated(done, strides, (penalty,))[0]


def rehearse(done: WindowModel, trials: Sequence[Samples], count: int) -> tuple[float, Values]:
    """Calibrate for the person models are chosen by, never the one they are tested on, and see which penalty serves.

    returns: the penalty, and the errors on that person's further strides (window, state) [each state's unit]
    """
    strides, after = first_strides(trials, count, done.sensing.reach_s)
    rest = stacked(trials).rows(after)
    missed = [model(rest) - rest.y for model in _calibrated(done, strides, PENALTIES)]
    best = int(np.argmin([np.mean((error / done.model.y_scale.sd) ** 2) for error in missed]))
    return PENALTIES[best], missed[best]


def _calibrated(done: WindowModel, strides: Samples, penalties: Sequence[float]) -> list[WindowModel]:
    x = present(strides, done.sensing.sensors).x if done.kind in STATIC else strides.x
    states = done.model(x)
    columns, missed = _columns(done.model, x, states), strides.y - states
    mean, offset = columns.mean(axis=0), missed.mean(axis=0)
    centred = columns - mean
    values, vectors = np.linalg.eigh(centred.T @ centred / len(centred))
    turned = vectors.T @ (centred.T @ (missed - offset) / len(centred))
    spread = np.maximum(values, 0.0)[:, None]
    models = [Corrected(done.model, mean, vectors @ (turned / (spread + penalty)), offset) for penalty in penalties]
    return [replace(done, model=model, n_fitted=len(strides)) for model in models]


def _columns(model: ScaledModel, x: Values, states: Values) -> Values:
    readings = np.nan_to_num(model.x_scale.scaled(x))  # a missing one counts as the mean
    return np.hstack([readings, STATES_WEIGHT * model.y_scale.scaled(states)])
