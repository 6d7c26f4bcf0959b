"""Several models of one output each, side by side as one model."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from gaitdisc.model import Model
from gaitdisc.recording import Samples


@dataclass(frozen=True)
class ByOutput:
    """A model for each output; a `gaitdisc.model.Model`."""

    models: tuple[Model, ...]  # of the same inputs, each with one output, in order

    @property
    def inputs(self) -> tuple[str, ...]:
        """Names of the inputs of each."""
        return self.models[0].inputs

    @property
    def outputs(self) -> tuple[str, ...]:
        """Names of the outputs, in order."""
        return tuple(model.outputs[0] for model in self.models)

    def __call__(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """Outputs (sample, output) for inputs (sample, input)."""
        return np.column_stack([model(x) for model in self.models])


def fitted_by_output(samples: Samples, fit: Callable[[Samples], Model]) -> ByOutput:
    """Fit a model to each output by itself, so that one that is noise decides nothing about another."""
    alone = [replace(samples, y=samples.y[:, [k]], outputs=(name,)) for k, name in enumerate(samples.outputs)]
    return ByOutput(tuple(fit(each) for each in alone))
