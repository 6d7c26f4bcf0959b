"""The methods of chapter 3, each fitted to the same samples."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

from gaitdisc.discrepancy.by_output import fitted_by_output
from gaitdisc.model import Model
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
    threshold : float, optional
        Of SINDy; chosen on an inner block where absent.
    bags : int
        Of SINDy's ensemble and of BOP-DMD; 0 for plain SINDy, and for ten bags of BOP-DMD.
    most_exact : int
        Samples up to which the Gaussian process is exact.
    nodes : int
        Of either hidden layer of the networks, one network for each output; the published code has ten.
    """

    degree: int = 3
    threshold: float | None = None
    bags: int = 0
    delays: int = DELAYS
    rank: int = RANK
    most_exact: int = MOST_EXACT
    nodes: int = 10


def fitted(samples: Samples, method: Method, settings: MethodSettings, seed: int = 0) -> Model:
    """Fit a method to samples.

    Each output has a network of its own, as it has a Gaussian process of its own in the published code: trained
    together, a rate in which nothing is missing decides by its noise how the others are smoothed. The networks are
    trained as the published ones, by Levenberg-Marquardt with Bayesian regularisation: stochastic descent, stopped by
    an inner block of a few seconds, left a bias that the forecast gathers (docs/results.md, chapter 3).

    Parameters
    ----------
    samples : Samples
        Of states, or of time for the methods of `OF_TIME`.
    """
    fits: dict[str, Callable[[], Model]] = {
        "sindy": lambda: fit_sindy(samples, settings.degree, settings.threshold, settings.bags, seed),
        "dmd": lambda: fit_dmd(samples, settings.delays, settings.rank),
        "bopdmd": lambda: fit_dmd(samples, settings.delays, settings.rank, settings.bags or BAGS, seed),
        "gp": lambda: fit_gaussian_process(samples, settings.most_exact),
        "nn": lambda: _network(samples, settings.nodes, seed),
    }
    return fits[method]()


def _network(samples: Samples, nodes: int, seed: int) -> Model:
    from gaitdisc.networks.bayesian_training import train_bayesian  # brings torch, which takes two seconds

    return fitted_by_output(samples, lambda one: train_bayesian(one, nodes, seed))
