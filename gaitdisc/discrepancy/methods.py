"""The methods of chapter 3, each fitted to the same samples."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Literal

from gaitdisc.discrepancy.by_output import fitted_by_output
from gaitdisc.model import Model
from gaitdisc.networks.training_settings import TrainingSettings
from gaitdisc.recording import Samples
from gaitdisc.regression.dmd import DELAYS, RANK, fit_dmd
from gaitdisc.regression.gaussian_process import MOST_EXACT, fit_gaussian_process
from gaitdisc.regression.sindy import fit_sindy

Method = Literal["sindy", "dmd", "bopdmd", "gp", "nn"]
OF_TIME: tuple[Method, ...] = ("dmd", "bopdmd")  # what they learn is a function of time
BAGS = 10  # of BOP-DMD, where none are asked for


@dataclass(frozen=True)
class MethodSettings:
    """Settings of all methods.

    Parameters
    ----------
    degree : int
        Of SINDy's library.
    threshold : float, optional
        Of SINDy; chosen on an inner block where absent.
    bags : int
        Of SINDy's ensemble and of BOP-DMD; 0 for plain SINDy, and for ten bags of BOP-DMD.
    delays, rank : int
        Of dynamic mode decomposition.
    most_exact : int
        Samples up to which the Gaussian process is exact.
    training : TrainingSettings
        Of the networks, one for each output. Errors without noise are smooth functions of few inputs: many epochs.
    """

    degree: int = 3
    threshold: float | None = None
    bags: int = 0
    delays: int = DELAYS
    rank: int = RANK
    most_exact: int = MOST_EXACT
    training: TrainingSettings = field(default_factory=lambda: TrainingSettings(epochs=400, decays=(1e-4, 1e-2, 0.3)))


def fitted(samples: Samples, method: Method, settings: MethodSettings, seed: int = 0) -> Model:
    """Fit a method to samples.

    Each output has a network of its own, as it has a Gaussian process of its own in the published code: trained
    together, a rate in which nothing is missing decides by its noise when the others stop.

    Parameters
    ----------
    samples : Samples
        Of states, or of time for the methods of `OF_TIME`.
    method : str
        `sindy`, `dmd`, `bopdmd`, `gp` or `nn`.
    settings : MethodSettings
        Of all methods.
    seed : int
        Of what a method draws.

    Raises
    ------
    TrainingError
        If the samples cannot be fitted.
    SamplingError
        If the record is too short for the delays.
    """
    fits: dict[str, Callable[[], Model]] = {
        "sindy": lambda: fit_sindy(samples, settings.degree, settings.threshold, settings.bags, seed),
        "dmd": lambda: fit_dmd(samples, settings.delays, settings.rank),
        "bopdmd": lambda: fit_dmd(samples, settings.delays, settings.rank, settings.bags or BAGS, seed),
        "gp": lambda: fit_gaussian_process(samples, settings.most_exact),
        "nn": lambda: _network(samples, settings.training, seed),
    }
    return fits[method]()


def _network(samples: Samples, training: TrainingSettings, seed: int) -> Model:
    from gaitdisc.networks.feedforward import FeedForward
    from gaitdisc.networks.trainer import train

    seeded = replace(training, seed=seed)
    return fitted_by_output(samples, lambda one: train(one, FeedForward, seeded).network)
