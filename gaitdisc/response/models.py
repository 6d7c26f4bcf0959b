"""Nominal, Exo, Discrepancy and Augmented: four models of one participant (Eqs. 4.2-4.5)."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

from gaitdisc.errors import TrainingError
from gaitdisc.model import Augmented, Model, augment
from gaitdisc.networks.training_settings import TrainingSettings
from gaitdisc.recording import Samples
from gaitdisc.regression.ridge import fit_ridge


@dataclass(frozen=True, eq=False)
class Fit:
    """A model fitted to samples, and how."""

    model: Model
    decay: float  # weight decay of a network, penalty of a ridge regression
    epochs: int  # epochs trained; 0 where nothing is descended
    n_training: int  # samples of the whole training part, and of the inner block that chose the decay
    n_inner: int  # samples of the whole training part, and of the inner block that chose the decay
    seconds: float  # Wall-clock time [s]


@dataclass(frozen=True, eq=False)
class ResponseModels:
    """The models of one participant."""

    nominal: Fit  # Eqs. 4.2, 4.3 and 4.4; same inputs and outputs
    exo: Fit  # Eqs. 4.2, 4.3 and 4.4; same inputs and outputs
    discrepancy: Fit  # Eqs. 4.2, 4.3 and 4.4; same inputs and outputs

    @property
    def augmented(self) -> Augmented:
        """Nominal plus Discrepancy (Eq. 4.5)."""
        return augment(self.nominal.model, self.discrepancy.model)

    def on_exo(self) -> dict[str, Model]:
        """Return the models that predict device walking, by the names of `gaitdisc.results`."""
        return {"nominal": self.nominal.model, "augmented": self.augmented, "exo": self.exo.model}


def fit_models(
    nominal: Samples,
    exo: Samples,
    fit: Callable[[Samples, Callable[[float], None]], Fit],
    progress: Callable[[float], None] | None = None,
) -> ResponseModels:
    """Fit the Nominal, the Exo and the Discrepancy model, all in the same way.

    The Discrepancy model learns what the Nominal model misses of device walking,
    xddot_exo - f(x_exo, xdot_exo, phi_exo) (Eq. 4.4).

    nominal, exo: training parts of the walks without and with the device; same inputs and outputs
    """
    parts = [partial(report_share, progress or (lambda _: None), done, 3) for done in range(3)]
    f = _named("Nominal", fit, nominal, parts[0])
    y = _named("Exo", fit, exo, parts[1])
    g = _named("Discrepancy", fit, exo.with_outputs(exo.y - f.model(exo.x)), parts[2])
    return ResponseModels(nominal=f, exo=y, discrepancy=g)


def _named(
    model: str,
    fit: Callable[[Samples, Callable[[float], None]], Fit],
    samples: Samples,
    progress: Callable[[float], None],
) -> Fit:
    """Fit, and name the model where it is refused."""
    try:
        return fit(samples, progress)
    except TrainingError as error:
        raise TrainingError(f"the {model} model: {error.needed}", error.found, error.remedy) from error


def report_share(progress: Callable[[float], None], done: int, count: int, fraction: float) -> None:
    """Say how far a whole is, of which so many equal parts are done and so much of the next."""
    progress((done + fraction) / count)


def fit_network(
    samples: Samples,
    settings: TrainingSettings | None = None,
    progress: Callable[[float], None] | None = None,
) -> Fit:
    """Fit the dissertation's feed-forward network."""
    from gaitdisc.networks.feedforward import FeedForward  # brings torch, which takes two seconds
    from gaitdisc.networks.trainer import train

    done = train(samples, FeedForward, settings, progress)
    return Fit(done.network, done.decay, len(done.losses), done.n_training, done.n_inner, done.seconds)


def refitted_network(model: Model, samples: Samples) -> Model:
    """Return a network whose last layer is solved for other samples."""
    from gaitdisc.networks.trained_network import TrainedNetwork
    from gaitdisc.networks.trainer import resolved

    assert isinstance(model, TrainedNetwork)  # fit_network makes nothing else
    return resolved(model, samples)


def fit_linear(samples: Samples, harmonics: int = 8) -> Fit:
    """Fit the ridge regression that stands beside the network."""
    begun = time.perf_counter()
    ridge = fit_ridge(samples, harmonics)
    return Fit(ridge, ridge.penalty, 0, ridge.n_training, ridge.n_inner, time.perf_counter() - begun)
