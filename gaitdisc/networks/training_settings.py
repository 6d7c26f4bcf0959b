"""What decides how a network is trained."""

from __future__ import annotations

from dataclasses import dataclass

from gaitdisc.errors import TrainingError

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
    # the GRU of 64 (docs/results.md)
    precision: str = "float32"
    # whether inputs may be missing (NaN); the network has to know what to do with them, as `Shred` with `masked`
    missing_inputs: bool = False

    def __post_init__(self) -> None:
        """Refuse settings that train nothing."""
        for name in ("epochs", "batch", "learning_rate", "threads"):
            _refuse_unless(getattr(self, name) > 0, f"{name} above 0", f"{name} is {getattr(self, name)}")
        _refuse_unless(bool(self.decays), "at least one weight decay", "decays is empty")
        _refuse_unless(min(self.decays) >= 0, "weight decays of 0 or more", f"decays holds {min(self.decays)}")
        _refuse_unless(0 < self.inner_share < 1, "an inner_share between 0 and 1", f"it is {self.inner_share}")
        known = self.arithmetic in ("auto", "torch")
        _refuse_unless(known, "arithmetic 'auto' or 'torch'", f"it is {self.arithmetic!r}")
        known = self.precision in PRECISIONS
        _refuse_unless(known, f"precision {' or '.join(map(repr, PRECISIONS))}", f"it is {self.precision!r}")


def _refuse_unless(holds: bool, needed: str, found: str) -> None:
    if not holds:
        raise TrainingError(f"training needs {needed}", found, "Correct the training settings.")
