"""What decides how a network is trained."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from gaitdisc.errors import TrainingError
from gaitdisc.recording.arrays import Values

if TYPE_CHECKING:
    from torch import Tensor

PRECISIONS = ("float32", "bfloat16")


@dataclass(frozen=True)
class TrainingSettings:
    """Settings of the trainer, the same for every kind of network.

    >>> TrainingSettings(seed=3).batch
    256
    """

    epochs: int = 20  # passes over the training part; more where 1,000 steps need more
    batch: int = 256
    learning_rate: float = 1e-2  # of the first step; it falls to 0 along a cosine, or stays where `falling` is False
    falling: bool = True
    patience: int = 0  # epochs without gain on the inner block after which a descent ends; 0 goes through all of them
    # whether the last layer is solved by least squares after the descent, or stays as it was descended
    solved: bool = True
    # candidates of the decoupled weight decay, weak to strong; they are tried in this order until the inner block does
    # worse, each from the weights of the one before, and the best is used
    decays: tuple[float, ...] = (0.1, 0.3, 1.0)
    inner_share: float = 0.15  # share of the training part in the inner block, its last samples
    seed: int = 0  # of the first weights and of the order of the samples
    device: str = "cpu"  # `cpu`, `cuda`, or `auto`: the GPU where there is one
    # threads of one training on the CPU. Networks of this size train slower on two threads than on one; participants
    # are what to run beside each other
    threads: int = 1
    # `auto` computes the dissertation's network on the CPU by compiled code, with torch's numbers to rounding, and
    # everything else by torch; `torch` computes everything by torch
    arithmetic: str = "auto"
    # `float32`, or `bfloat16`: torch multiplies in bfloat16 while descending, and keeps weights, losses and the readout
    # in float32 and better. It pays for an LSTM (1.5 to 1.7 times as fast on a processor that has bfloat16), not for
    # the GRU of 64 (studies/results/chapter5.md)
    precision: str = "float32"
    # whether inputs may be missing (NaN); the network has to know what to do with them, as `Shred` with `masked`
    missing_inputs: bool = False

    def __post_init__(self) -> None:
        """Refuse settings that train nothing."""
        for name in ("epochs", "batch", "learning_rate", "threads"):
            _refuse_unless(getattr(self, name) > 0, f"{name} above 0", f"{name} is {getattr(self, name)}")
        _refuse_unless(bool(self.decays), "at least one weight decay", "there is none")
        _refuse_unless(min(self.decays) >= 0, "weight decays of 0 or more", f"one is {min(self.decays)}")
        _refuse_unless(0 < self.inner_share < 1, "an inner_share between 0 and 1", f"it is {self.inner_share}")
        for name, among in (("arithmetic", ("auto", "torch")), ("precision", PRECISIONS)):
            value = getattr(self, name)
            _refuse_unless(value in among, f"{name} {' or '.join(map(repr, among))}", f"it is {value!r}")


def _refuse_unless(holds: bool, needed: str, fault: str) -> None:
    if not holds:
        raise TrainingError(f"the training settings must have {needed}", fault, "Correct the training settings.")


LEAST_STEPS = 1000  # short recordings have few batches an epoch: they get more epochs


@dataclass(frozen=True, eq=False)
class Schedule:
    """Every step of a descent, whatever computes it."""

    # (epoch, step of the epoch), learning rate, from the first one to 0 along a cosine, or the same in all
    rates: Values
    decay: float  # decoupled decay of weight matrices, times the learning rate each step
    batch: int

    def continue_at(self, decay: float) -> Schedule:
        """Return the schedule that goes on where this one led to: a third of its epochs, half its rate.

        >>> make_schedule(512, 0.1, TrainingSettings()).continue_at(0.3).rates.shape
        (167, 2)
        """
        epochs, steps = math.ceil(len(self.rates) / 3), self.rates.shape[1]
        return Schedule(_cosine(self.rates[0, 0] / 2, epochs, steps), decay, self.batch)


class ScaledSamples(NamedTuple):
    """Scaled samples to train on or to check by, on the device of the network."""

    x: Tensor  # (sample, input)
    y: Tensor  # (sample, output)


def make_schedule(samples: int, decay: float, settings: TrainingSettings) -> Schedule:
    """Schedule for a training part of that many samples.

    Source: Loshchilov and Hutter 2017, SGDR: stochastic gradient descent with warm restarts; one period, no restart.

    >>> make_schedule(512, 0.1, TrainingSettings()).rates[[0, 250, 499], [0, 0, 1]].round(8).tolist()
    [0.01, 0.005, 2e-08]
    """
    epochs, steps = count_epochs(samples, settings), math.ceil(samples / settings.batch)
    constant = np.full((epochs, steps), settings.learning_rate)
    rates = _cosine(settings.learning_rate, epochs, steps) if settings.falling else constant
    return Schedule(rates, decay, settings.batch)


def count_epochs(samples: int, settings: TrainingSettings) -> int:
    """Passes over a training part of that many samples: the epochs of the settings, or what 1,000 steps need.

    >>> count_epochs(21_000, TrainingSettings()), count_epochs(2_000, TrainingSettings())
    (20, 125)
    """
    return max(settings.epochs, math.ceil(LEAST_STEPS / math.ceil(samples / settings.batch)))


def _cosine(first: float, epochs: int, steps: int) -> Values:
    angle = np.pi * np.arange(epochs * steps) / (epochs * steps)
    return (first * (1 + np.cos(angle)) / 2).reshape(epochs, steps)
