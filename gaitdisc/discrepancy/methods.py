"""The four methods of chapter 3, each fitted to the same samples."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Literal

from gaitdisc.model import Model
from gaitdisc.networks.training_settings import TrainingSettings
from gaitdisc.recording import Samples
from gaitdisc.regression.dmd import DELAYS, RANK, fit_dmd
from gaitdisc.regression.gaussian_process import MOST_EXACT, fit_gaussian_process
from gaitdisc.regression.sindy import fit_sindy

Method = Literal["sindy", "dmd", "gp", "nn"]


@dataclass(frozen=True)
class MethodSettings:
    """Settings of all four methods.

    Parameters
    ----------
    degree : int
        Of SINDy's library.
    threshold : float, optional
        Of SINDy; chosen on an inner block where absent.
    bags : int
        Of SINDy's ensemble and of BOP-DMD; 0 for the plain methods.
    delays, rank : int
        Of dynamic mode decomposition.
    most_exact : int
        Samples up to which the Gaussian process is exact.
    training : TrainingSettings
        Of the network. Errors without noise are smooth functions of few inputs: no decay, and many epochs.
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

    Parameters
    ----------
    samples : Samples
        Of states, or of time for `dmd`.
    method : str
        `sindy`, `dmd`, `gp` or `nn`.
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
        "dmd": lambda: fit_dmd(samples, settings.delays, settings.rank, settings.bags, seed),
        "gp": lambda: fit_gaussian_process(samples, settings.most_exact),
        "nn": lambda: _network(samples, settings.training, seed),
    }
    return fits[method]()


def _network(samples: Samples, training: TrainingSettings, seed: int) -> Model:
    from dataclasses import replace

    from gaitdisc.networks.feedforward import FeedForward
    from gaitdisc.networks.trainer import train

    return train(samples, FeedForward, replace(training, seed=seed)).network
