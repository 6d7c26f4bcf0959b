"""What chapter 3 learns from: a true trajectory, measured with noise, in a training and a forecast part."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gaitdisc.discrepancy.record_noise import NoiseKind, drawn_noise
from gaitdisc.discrepancy.smoothing import smoothed
from gaitdisc.discrepancy.system import System
from gaitdisc.errors import SamplingError
from gaitdisc.recording.arrays import read_only

LEAST_SAMPLES = 60  # a training part shorter than this carries no smoothing and no inner block


@dataclass(frozen=True)
class Conditions:
    """How a system is recorded and judged; the defaults are the text's, with what it leaves open done right.

    Parameters
    ----------
    noise : float
        Standard deviation of the noise, as a share of each channel's own, or in its unit.
    absolute : bool
        The noise is in each channel's unit, as in the published code.
    dt_s, duration_s : float
        Between samples, and of the record [s].
    train_share : float
        Share of the record that is learned from.
    published : bool
        As the published code: 4 Hz filter where there is noise, central differences, each forecast starts from the
        last measured sample, and the truth that it is judged by is run again from there. Otherwise: a cut-off where
        the noise begins, the flow of the known model in place of a derivative, starts and truth of the trajectory.
    """

    noise: float = 0.0
    seed: int = 0
    absolute: bool = False
    dt_s: float = 0.01
    duration_s: float = 50.0
    train_share: float = 0.6
    published: bool = False
    kind: NoiseKind = "normal"


@dataclass(frozen=True, eq=False)
class Record:
    """Truth and measurement of one run.

    Parameters
    ----------
    time : ndarray (sample,) [s]
        Even.
    truth : ndarray (sample, state)
        x0 of Eq. 3.2.
    measured : ndarray (sample, channel)
        y of Eqs. 3.3 and 3.15.
    filtered : ndarray (training sample, channel)
        Measured in the training part, smoothed.
    """

    system: System
    conditions: Conditions
    time: NDArray[np.float64]
    truth: NDArray[np.float64]
    measured: NDArray[np.float64]
    filtered: NDArray[np.float64]
    split: int

    def __post_init__(self) -> None:
        """Freeze the numbers."""
        for name in ("time", "truth", "measured", "filtered"):
            object.__setattr__(self, name, read_only(getattr(self, name)))

    def start(self, forecast: bool) -> NDArray[np.float64]:
        """State that the known and the augmented model begin from, (state,).

        Parameters
        ----------
        forecast : bool
            At the end of the training part instead of its beginning.
        """
        if not forecast and self.system.assumed is not None:
            return self.system.assumed
        sample = self.split - 1 if forecast else 0
        complete = len(self.system.channels) == len(self.system.states)
        return self.filtered[sample] if self.conditions.published and complete else self.truth[sample]

    def target(self, forecast: bool) -> NDArray[np.float64]:
        """Noise-free channels that a part is judged by, (sample, channel)."""
        part = slice(self.split - 1, None) if forecast else slice(0, self.split)
        states = self.truth[part]
        if self.conditions.published:
            states = self.system.true.run(self.start(forecast)[None], self.conditions.dt_s, len(states) - 1)[0]
        return states @ self.system.observation.T


def recorded(system: System, conditions: Conditions) -> Record:
    """Run the true system and measure it.

    Examples
    --------
    >>> from gaitdisc.discrepancy.system import system_of
    >>> from gaitdisc.simulation.bundled import bundled
    >>> recorded(system_of(bundled("lorenz")), Conditions(duration_s=5.0)).split
    301
    """
    steps = round(conditions.duration_s / conditions.dt_s)
    split = round(conditions.train_share * steps) + 1
    if split < LEAST_SAMPLES:
        raise SamplingError(
            f"the training part of a record needs {LEAST_SAMPLES} samples",
            f"{conditions.duration_s:g} s at {conditions.dt_s:g} s give {split}, {LEAST_SAMPLES - split} too few",
            "Record longer, or sample faster.",
        )
    truth = system.true.run(system.start[None], conditions.dt_s, steps)[0]
    if not np.isfinite(truth).all():
        when = conditions.dt_s * int(np.argmin(np.isfinite(truth).all(axis=1)))
        raise SamplingError(
            "a true trajectory stays finite", f"{system.name!r} leaves every bound at {when:g} s", "Change its start."
        )
    clean = truth @ system.observation.T
    size = conditions.noise * (np.ones(clean.shape[1]) if conditions.absolute else clean.std(axis=0))
    rng = np.random.default_rng(conditions.seed)
    measured = clean + drawn_noise(conditions.kind, clean, size, conditions.dt_s, rng)
    time = conditions.dt_s * np.arange(steps + 1.0)
    training = measured[:split]
    if conditions.noise:
        training = smoothed(training, 1.0 / conditions.dt_s, 4.0 if conditions.published else None)
    return Record(system, conditions, np.asarray(time, float), truth, measured, training, split)
