"""The measured inputs of all trials, and the stretches of them that are run."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gaitdisc.errors import ShapeError
from gaitdisc.recording.arrays import read_only


@dataclass(frozen=True, eq=False)
class Drive:
    """What drives a simulation, trial by trial, at one rate.

    >>> Drive.of([np.zeros((300, 1)), np.zeros((200, 1))], 100.0).samples.tolist()
    [300, 200]
    """

    rate: float  # samples a second [Hz]
    time0: NDArray[np.float64]  # (trial,), time of each trial's first sample [s]
    # (trial, sample, input), in the order of the simulation's inputs; zero beyond a trial's end
    inputs: NDArray[np.float64]
    samples: NDArray[np.int64]  # (trial,), length of each trial

    def __post_init__(self) -> None:
        """Freeze the arrays and refuse shapes that do not fit."""
        inputs = read_only(np.ascontiguousarray(self.inputs, float))
        samples = read_only(np.ascontiguousarray(self.samples, np.int64), np.int64)
        time0 = read_only(np.ascontiguousarray(self.time0, float))
        fits = inputs.ndim == 3 and samples.shape == time0.shape == inputs.shape[:1]
        if not (fits and self.rate > 0 and np.all((samples > 0) & (samples <= inputs.shape[1]))):
            raise ShapeError(
                "a drive must have inputs (trial, sample, input), a first time and a length for each trial, and a rate",
                f"the inputs have shape {inputs.shape}, the times {time0.shape}; lengths {samples.tolist()[:5]}, rate "
                f"{self.rate}",
                "Build it from a list of trials with Drive.of.",
            )
        for name, value in (("rate", float(self.rate)), ("time0", time0), ("inputs", inputs), ("samples", samples)):
            object.__setattr__(self, name, value)

    @classmethod
    def of(cls, trials: Sequence[ArrayLike], rate: float, time0: ArrayLike = 0.0) -> Drive:
        """Drive of a list of trials.

        trials each (sample, input): inputs of each trial; (sample, 0) where the simulation has none
        rate: samples a second [Hz]
        time0 float or (trial,): time of each first sample [s]
        """
        arrays = [np.asarray(trial, float) for trial in trials]
        samples = np.array([len(each) for each in arrays])
        inputs = np.zeros((len(arrays), samples.max(), arrays[0].shape[1]))
        for trial, each in enumerate(arrays):
            inputs[trial, : len(each)] = each
        return cls(rate, np.broadcast_to(np.asarray(time0, float), samples.shape), inputs, samples)


@dataclass(frozen=True, eq=False)
class Rows:
    """Stretches of trials to run, each from its own state and with its own parameters."""

    trial: NDArray[np.int64]  # (row,), number of the trial
    begin: NDArray[np.int64]  # (row,), sample that each starts at
    starts: NDArray[np.float64]  # (row, state), state there
    # (row, parameter) or (parameter,), parameters; the simulation's own where absent
    values: NDArray[np.float64] | None = None
