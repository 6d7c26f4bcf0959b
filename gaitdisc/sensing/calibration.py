"""A person whom a model never saw, after a few strides of which the states are known: what the model then says."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gaitdisc.errors import StrideError
from gaitdisc.recording import Samples
from gaitdisc.sensing.reconstructor import Reconstructor
from gaitdisc.sensing.splits import SEAM_S
from gaitdisc.sensing.state_errors import stride_numbers
from gaitdisc.sensing.windows import stacked

PENALTIES = tuple(10.0**power for power in np.arange(-3.0, 2.5, 0.5))
TOLD = 3.0  # weight of what the model tells beside the readings, in standard deviations


@dataclass(frozen=True, eq=False)
class Correction:
    """What is added to a model's states for one person: linear in the readings, their history and the states told.

    Parameters
    ----------
    reconstructor : Reconstructor
        The model of the population.
    mean : ndarray (column,)
        Of readings and told states in the calibration strides, each scaled as in the model's training part.
    weights : ndarray (column, state) [each state's unit]
        Zero is the model of the population with the mean error of these strides taken off.
    offset : ndarray (state,) [each state's unit]
        Mean error in the calibration strides.
    """

    reconstructor: Reconstructor
    mean: NDArray[np.float64]
    weights: NDArray[np.float64]
    offset: NDArray[np.float64]

    def __call__(self, windows: Samples) -> NDArray[np.float64]:
        """States (window, state) of the person, each in its unit."""
        states = self.reconstructor(windows)
        columns = _columns(self.reconstructor, windows, states)
        return states + (columns - self.mean) @ self.weights + self.offset


@dataclass(frozen=True, eq=False)
class FirstStrides:
    """The first strides of a person, and what comes after them.

    Parameters
    ----------
    strides : Samples
        Windows of the first strides.
    rest : ndarray of bool (window,)
        Which windows of all trials, stacked, come after these and share no reading with them.
    """

    strides: Samples
    rest: NDArray[np.bool_]


def first_strides(trials: Sequence[Samples], count: int, reach_s: float) -> FirstStrides:
    """Part the first strides of a person from the rest, with a gap as long as a window and 0.3 s.

    Parameters
    ----------
    trials : sequence of Samples
        Windows of each trial of a person.
    count : int
        Strides to calibrate on.
    reach_s : float
        From the first reading of a window to its last [s].

    Returns
    -------
    FirstStrides

    Raises
    ------
    StrideError
        If nothing comes after these strides.
    """
    kept = [each for each in trials if len(each)]
    windows, stride = stacked(kept), stride_numbers(kept)
    first, rest = (stride >= 0) & (stride < count), stride >= count
    if not first.any() or not rest.any():
        raise StrideError(
            f"calibration needs {count} strides, and more to judge it by",
            f"{windows.subject or 'the person'} has {len(np.unique(stride[stride >= 0]))} strides",
            "Calibrate on fewer strides, or record longer.",
        )
    last = int(np.flatnonzero(first)[-1])
    trial = np.repeat(np.arange(len(kept)), [len(each) for each in kept])
    near = (trial == trial[last]) & (windows.time < windows.time[last] + reach_s + SEAM_S - 1e-9)
    return FirstStrides(windows.rows(first), rest & ~near)


def calibrated(done: Reconstructor, strides: Samples, penalty: float) -> Correction:
    """Correct a model for one person by ridge regression of its error, shrunk towards the model as it is.

    Minimises sum (y - f(x) - b - W h)^2 / windows + penalty sum W^2, where h holds the scaled readings with their
    history and, three times as heavy, the scaled states that the model f tells.

    Parameters
    ----------
    done : Reconstructor
        Of the population.
    strides : Samples
        Windows of the person with known states.
    penalty : float
        From `rehearsed`; a large one takes off the mean error alone.

    Returns
    -------
    Correction
    """
    return _corrections(done, strides, (penalty,))[0]


@dataclass(frozen=True, eq=False)
class Rehearsal:
    """A calibration that was tried on another person.

    Parameters
    ----------
    penalty : float
        One of `PENALTIES`, with which that person was told best.
    missed : ndarray (window, state) [each state's unit]
        Errors on that person's further strides.
    """

    penalty: float
    missed: NDArray[np.float64]


def rehearsed(done: Reconstructor, trials: Sequence[Samples], count: int) -> Rehearsal:
    """Calibrate a model for a person to whom it was not fitted, and see which penalty serves best.

    Parameters
    ----------
    done : Reconstructor
        Of the population.
    trials : sequence of Samples
        Windows of each trial of the person whom models are chosen by, never of the one they are judged on.
    count : int
        Strides to calibrate on.

    Returns
    -------
    Rehearsal
    """
    parted = first_strides(trials, count, done.sensing.reach_s)
    rest = stacked([each for each in trials if len(each)]).rows(parted.rest)
    missed = [each(rest) - rest.y for each in _corrections(done, parted.strides, PENALTIES)]
    best = int(np.argmin([np.mean((each / done.model.y_scale.sd) ** 2) for each in missed]))
    return Rehearsal(PENALTIES[best], missed[best])


def _corrections(done: Reconstructor, strides: Samples, penalties: Sequence[float]) -> list[Correction]:
    states = done(strides)
    columns, missed = _columns(done, strides, states), strides.y - states
    mean, offset = columns.mean(axis=0), missed.mean(axis=0)
    centred = columns - mean
    values, vectors = np.linalg.eigh(centred.T @ centred / len(centred))
    turned = vectors.T @ (centred.T @ (missed - offset) / len(centred))
    spread = np.maximum(values, 0.0)[:, None]
    return [Correction(done, mean, vectors @ (turned / (spread + p)), offset) for p in penalties]


def _columns(done: Reconstructor, windows: Samples, states: NDArray[np.float64]) -> NDArray[np.float64]:
    scale = done.model.x_scale
    readings = windows.x[:, -len(scale.mean) :]  # a model without history is corrected without it
    return np.hstack([scale.scaled(readings), TOLD * done.model.y_scale.scaled(states)])
