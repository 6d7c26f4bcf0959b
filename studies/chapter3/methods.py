"""The methods of chapter 3, each fitted to the same samples."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from gaitdisc.model import Model
from gaitdisc.recording import Samples

from .dmd import DELAYS, RANK, fit_dmd, fit_exact_dmd
from .gaussian_process import MOST_EXACT, fit_gaussian_process
from .sindy import fit_sindy, fit_weak_sindy

Method = Literal["sindy", "esindy", "wsindy", "dmd", "exactdmd", "bopdmd", "gp", "gpm", "nn"]
OF_TIME: tuple[Method, ...] = ("dmd", "exactdmd", "bopdmd")  # what they learn is a function of time
BAGS, SINDY_BAGS = 10, 20  # of BOP-DMD and of SINDy's ensemble, where no number is given


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


@dataclass(frozen=True)
class MethodSettings:
    """Settings of all methods."""

    degree: int = 3
    threshold: float | None = None  # of SINDy; chosen on an inner block where absent
    # of SINDy's ensemble and of BOP-DMD; 0 for plain SINDy, for twenty of `esindy` and for ten of BOP-DMD
    bags: int = 0
    delays: int = DELAYS
    rank: int = RANK
    most_exact: int = MOST_EXACT  # samples up to which the Gaussian process is exact
    nodes: int = 10  # of either hidden layer of the networks, one network for each output; the published code has ten


def fitted(samples: Samples, method: Method, settings: MethodSettings, seed: int = 0) -> Model:
    """Fit a method to samples.

    Each output has a network of its own, as it has a Gaussian process of its own in the published code: trained
    together, a rate in which nothing is missing decides by its noise how the others are smoothed.
    """
    fits: dict[str, Callable[[], Model]] = {
        "sindy": lambda: fit_sindy(samples, settings.degree, settings.threshold, settings.bags, seed),
        "esindy": lambda: fit_sindy(samples, settings.degree, settings.threshold, settings.bags or SINDY_BAGS, seed),
        "wsindy": lambda: fit_weak_sindy(samples, settings.degree),
        "exactdmd": lambda: fit_exact_dmd(samples, settings.delays, settings.rank),
        "dmd": lambda: fit_dmd(samples, settings.delays, settings.rank),
        "bopdmd": lambda: fit_dmd(samples, settings.delays, settings.rank, settings.bags or BAGS, seed),
        "gp": lambda: fit_gaussian_process(samples, settings.most_exact),
        "gpm": lambda: fit_gaussian_process(samples, settings.most_exact, kind="matern_5_2"),
        "nn": lambda: _network(samples, settings.nodes, seed),
    }
    return fits[method]()


def _network(samples: Samples, nodes: int, seed: int) -> Model:
    from .bayesian_training import train_bayesian  # brings torch, which takes two seconds

    return fitted_by_output(samples, lambda one: train_bayesian(one, nodes, seed))
