"""A model is anything with named inputs and outputs; models add."""

from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from gaitdisc.errors import ShapeError


@runtime_checkable
class Model(Protocol):
    """Named inputs to named outputs: a system, a regression or a network."""

    @property
    def inputs(self) -> tuple[str, ...]:
        """Names of the inputs, in order."""
        ...

    @property
    def outputs(self) -> tuple[str, ...]:
        """Names of the outputs, in order."""
        ...

    def __call__(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """Outputs (sample, output) for inputs (sample, input)."""
        ...


@dataclass(frozen=True)
class Augmented:
    """A known model plus what it misses (Eq. 4.5)."""

    known: Model
    missing: Model  # the Discrepancy model; same inputs and outputs

    def __post_init__(self) -> None:
        for what in ("inputs", "outputs"):
            known, missing = getattr(self.known, what), getattr(self.missing, what)
            if known != missing:
                apart = sorted(set(known) ^ set(missing)) or ["their order"]
                raise ShapeError(
                    f"models that are added must have the same {what}",
                    f"they have {len(known)} and {len(missing)}, and differ in {', '.join(apart[:3])}",
                    "Fit both models on the same channels.",
                )

    @property
    def inputs(self) -> tuple[str, ...]:
        """Names of the inputs of both."""
        return self.known.inputs

    @property
    def outputs(self) -> tuple[str, ...]:
        """Names of the outputs of both."""
        return self.known.outputs

    def __call__(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """Sum of both models, (sample, output)."""
        return self.known(x) + self.missing(x)
