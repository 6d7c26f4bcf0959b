"""How long to descend and how far each step goes."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gaitdisc.networks.training_settings import TrainingSettings

LEAST_STEPS = 1000  # short recordings have few batches an epoch: they get more epochs


@dataclass(frozen=True, eq=False)
class Schedule:
    """Every step of a descent, whatever computes it."""

    # (epoch, step of the epoch), learning rate, from the first one to 0 along a cosine, or the same in all
    rates: NDArray[np.float64]
    decay: float  # decoupled decay of weight matrices, times the learning rate each step
    batch: int

    def continued(self, decay: float) -> Schedule:
        """Return the schedule that goes on where this one led to: a third of its epochs, half its rate.

        >>> schedule_of(512, 0.1, TrainingSettings()).continued(0.3).rates.shape
        (167, 2)
        """
        epochs, steps = math.ceil(len(self.rates) / 3), self.rates.shape[1]
        return Schedule(_cosine(self.rates[0, 0] / 2, epochs, steps), decay, self.batch)


def schedule_of(samples: int, decay: float, settings: TrainingSettings) -> Schedule:
    """Schedule for a training part of that many samples.

    Source: Loshchilov and Hutter 2017, SGDR: stochastic gradient descent with warm restarts; one period, no restart.

    >>> schedule_of(512, 0.1, TrainingSettings()).rates[[0, 250, 499], [0, 0, 1]].round(8).tolist()
    [0.01, 0.005, 2e-08]
    """
    epochs, steps = epochs_of(samples, settings), math.ceil(samples / settings.batch)
    constant = np.full((epochs, steps), settings.learning_rate)
    rates = _cosine(settings.learning_rate, epochs, steps) if settings.falling else constant
    return Schedule(rates, decay, settings.batch)


def epochs_of(samples: int, settings: TrainingSettings) -> int:
    """Passes over a training part of that many samples: the epochs of the settings, or what 1,000 steps need.

    >>> epochs_of(21_000, TrainingSettings()), epochs_of(2_000, TrainingSettings())
    (20, 125)
    """
    return max(settings.epochs, math.ceil(LEAST_STEPS / math.ceil(samples / settings.batch)))


def _cosine(first: float, epochs: int, steps: int) -> NDArray[np.float64]:
    angle = np.pi * np.arange(epochs * steps) / (epochs * steps)
    return (first * (1 + np.cos(angle)) / 2).reshape(epochs, steps)
