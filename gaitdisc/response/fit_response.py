"""The four models of one participant (Eqs. 4.2-4.5): fit on the first part, score on the last, a band by refits."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cache, partial
from typing import Any, cast

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from gaitdisc.errors import LOG, ChannelError, TrainingError
from gaitdisc.model import Augmented, Model
from gaitdisc.models.ridge import INNER_SHARE, SEAM_S, fit_ridge
from gaitdisc.models.training_settings import TrainingSettings
from gaitdisc.processing.samples import gait_samples
from gaitdisc.recording import Samples, Trajectory
from gaitdisc.response.participant_response import FIT_COLUMNS, MODELS, R2_COLUMNS, HeldOut, ParticipantResponse
from gaitdisc.statistics.r2 import r2
from gaitdisc.statistics.stride_residuals import stride_curves, strides_of_phase
from gaitdisc.units import rate_unit

LEAST_HELD_OUT = 50
BLOCKS, LEVEL = 8, 0.9
STRIDES = 2  # of a block that counts as one: 24 simulated people of 60 s had 90.2 % inside, with single strides 88.4 %
PARTS = 20  # of the stride: errors are larger where a foot lands than where it hangs
FEWEST_ERRORS, MOST_ERRORS = 20, 400  # of a part; with fewer, those of the whole stride count
SHORTEST_S = 16.0  # of a training part: two seconds a block, a stride or two

Refit = Callable[[Model, Samples], Model]
Member = tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.int_]]


@dataclass(frozen=True)
class ResponseSettings:
    """What is predicted, on what it is scored, and how the models are fitted."""

    outputs: tuple[str, ...]
    # length held out at the end of both walks [s]; without it, `held_out_share` of each
    held_out_s: float | None = None
    held_out_share: float = 0.125  # share held out; the dissertation has 12.5 %, 30 s of 240 s
    training: TrainingSettings = field(default_factory=TrainingSettings)
    harmonics: int = 8  # harmonics of percent stride in the ridge regression


def fit_response(
    nominal: Trajectory,
    exo: Trajectory,
    settings: ResponseSettings,
    null_r2: Mapping[str, float] | None = None,
    progress: Callable[[float], None] | None = None,
    banded: bool = False,
) -> ParticipantResponse:
    """Fit all models to the first part of both walks and score them on the held-out last part.

    nominal, exo: whole walks of one participant without and with the device, with the same channels
    null_r2: R2 that noise reaches through the same filters, for each output (`gaitdisc.statistics.r2`)
    banded: whether predictions get a band from refits on blocks
    Source: Ebers 2023, Eqs. 4.1-4.5 and section 4.2.3. Beside the source: ridge regressions with phase harmonics and
        without, and the null of the filters, stand beside every network, and the Nominal model is scored on held-out
        nominal walking, too.
    """
    _check_pair(nominal, exo)
    held_nominal, held_exo = (split_held_out(walk, settings)[1] for walk in (nominal, exo))
    on_nominal, on_exo = (pick_held_out(held, settings) for held in (held_nominal, held_exo))
    training = training_samples(nominal, exo, settings)
    fitted = fit_kinds(*training, settings, progress or _log_tenths())
    null = [
        (variable, "nominal", "null", "exo", float(null_r2[variable]), len(on_exo))
        for variable in settings.outputs
        if null_r2 and variable in null_r2
    ]
    predicted = {name: model(on_exo.x) for name, model in fitted["network"].on_exo().items()}
    bands = response_bands(fitted["network"], refit_network, *training, on_exo) if banded else {}
    return ParticipantResponse(
        participant=exo.subject or nominal.subject,
        inputs=on_exo.inputs,
        outputs=settings.outputs,
        units=tuple(rate_unit(exo.channels[column].unit, 2) for column in exo.columns(settings.outputs)),
        r2=pd.DataFrame([*_scores(fitted, on_nominal, on_exo, settings), *null], columns=pd.Index(R2_COLUMNS)),
        fits=pd.DataFrame(
            [
                (name, kind, fit.decay, fit.epochs, fit.n_training, fit.n_inner)
                for kind, models in fitted.items()
                for name, fit in models.fits().items()
            ],
            columns=pd.Index(FIT_COLUMNS),
        ),
        held_out=HeldOut(on_exo.time, on_exo.phi, on_exo.y, predicted, bands),
        residuals={name: residual_strides(held_exo, on_exo, values) for name, values in predicted.items()},
        held_out_s=len(held_exo.time) / held_exo.rate_hz,
        weights={
            f"{name}_{array}": values
            for name, fit in fitted["network"].fits().items()
            for array, values in cast(Any, fit.model).arrays().items()
        },
    )


def _log_tenths() -> Callable[[float], None]:
    """Return a callback that logs each tenth of the fit once."""
    log = cache(lambda tenth: LOG.info("fitting the models: %d %%", 10 * tenth))
    return lambda share: log(int(10 * share))


def training_samples(nominal: Trajectory, exo: Trajectory, settings: ResponseSettings) -> tuple[Samples, Samples]:
    """Samples of the training parts of both walks; the held-out parts are not looked at."""
    first, second = (gait_samples(split_held_out(walk, settings)[0], settings.outputs)[0] for walk in (nominal, exo))
    return first, second


def fit_kinds(
    nominal: Samples, exo: Samples, settings: ResponseSettings, progress: Callable[[float], None] | None = None
) -> dict[str, ResponseModels]:
    """Fit networks, ridge regressions with phase harmonics, and `linear`: ridge on the networks' own inputs."""
    ridge = fit_models(nominal, exo, fit=lambda part, _: fit_linear(part, settings.harmonics))
    linear = fit_models(nominal, exo, fit=lambda part, _: fit_linear(part, harmonics=0))
    networks = fit_models(
        nominal, exo, fit=lambda part, report: fit_network(part, settings.training, report), progress=progress
    )
    return {"network": networks, "ridge": ridge, "linear": linear}


def split_held_out(walk: Trajectory, settings: ResponseSettings) -> tuple[Trajectory, Trajectory]:
    """Training part and held-out part of a walk."""
    length = settings.held_out_s or settings.held_out_share * len(walk.time) / walk.rate_hz
    return walk.split(length)


def pick_held_out(held_out: Trajectory, settings: ResponseSettings) -> Samples:
    """Samples of a held-out part that models are scored on."""
    samples, excluded = gait_samples(held_out, settings.outputs)
    if len(samples) < LEAST_HELD_OUT:
        raise TrainingError(
            f"a model must be tested on at least {LEAST_HELD_OUT} held-out samples",
            f"the last {len(held_out.time) / held_out.rate_hz:.2f} s: {excluded.line()}",
            "Hold out a longer part, or correct the channels that the message names.",
        )
    return samples


def residual_strides(held_out: Trajectory, samples: Samples, predicted: NDArray[np.float64]) -> NDArray[np.float64]:
    """Measured minus predicted (stride, phase, output) [unit/s2] of strides wholly held out; NaN without samples."""
    residual = np.full((len(held_out.time), len(samples.outputs)), np.nan)
    residual[np.searchsorted(held_out.time, samples.time)] = samples.y - predicted
    return stride_curves(held_out.time, residual, strides_of_phase(held_out.time, held_out.phi))


def _scores(
    fitted: Mapping[str, ResponseModels], on_nominal: Samples, on_exo: Samples, settings: ResponseSettings
) -> Iterator[tuple[object, ...]]:
    """Rows of `R2_COLUMNS`: the Nominal model on held-out nominal walking, and all models on that with the device."""
    for kind, models in fitted.items():
        trials = [("nominal", models.nominal.model, "nominal", on_nominal)]
        trials += [(name, model, "exo", on_exo) for name, model in models.on_exo().items()]
        for name, model, walk, held in trials:
            for variable, value in zip(settings.outputs, r2(held.y, model(held.x)), strict=True):
                yield variable, name, kind, walk, value, len(held)


def _check_pair(nominal: Trajectory, exo: Trajectory) -> None:
    if nominal.subject and exo.subject and nominal.subject != exo.subject:
        raise ChannelError(
            "both walks of a response must be of one participant",
            f"the walks are of {nominal.subject} and {exo.subject}",
            "Pair the trials by participant in the study.",
        )
    if nominal.channels != exo.channels:
        apart = sorted(set(nominal.names) ^ set(exo.names))
        difference = f"they differ in {', '.join(apart[:5])}" if apart else "they differ in order or unit"
        raise ChannelError(
            "both walks of a response must have the same channels",
            f"{nominal.subject}: {len(nominal.names)} channels in {nominal.condition or 'nominal'}, "
            f"{len(exo.names)} in {exo.condition or 'exo'}, {difference}",
            "Remove channels that one walk lacks.",
        )


def response_bands(
    models: ResponseModels, refit: Refit, nominal: Samples, exo: Samples, held: Samples
) -> dict[str, NDArray[np.float64]]:
    """Lower and upper bound of each model's prediction, (bound, sample, output) [unit/s2], by model.

    Of eight contiguous blocks of the training part one after the other is left out, the models are fitted to the rest,
    and their errors on the block, at the same part of the stride, stand around their predictions. What a Nominal model
    misses of device walking was in no block of nominal walking: its band covers less there, which is a finding. The
    samples of a stride err together: the unit that is exchangeable is a block of two strides, and with K of them the
    quantile is that of 90 % times (1 + 1/K). None where a training part is shorter than 16 s.

    refit: takes a model and samples, and gives the model as it is fitted to these
    nominal, exo: training parts of both walks
    held: Held-out device walking, at which the models predict
    Source: Barber, Candes, Ramdas and Tibshirani 2021, Predictive inference with the jackknife+ (CV+); Dunn, Wasserman
        and Ramdas 2023, Distribution-free prediction sets for two-layer hierarchical models (pooled within groups, the
        groups counted); by part of the stride is our addition.
    """
    if min(samples.time[-1] - samples.time[0] for samples in (nominal, exo)) < SHORTEST_S:
        return {}
    members: dict[str, list[Member]] = {name: [] for name in MODELS}
    for number in range(BLOCKS):
        (rest_nominal, out_nominal), (rest, out) = (part(samples, number) for samples in (nominal, exo))
        f, y = refit(models.nominal.model, rest_nominal), refit(models.exo.model, rest)
        g = refit(models.discrepancy.model, rest.with_outputs(rest.y - f(rest.x)))
        for name, model, block in (("nominal", f, out_nominal), ("augmented", Augmented(f, g), out), ("exo", y, out)):
            members[name].append((model(held.x), np.abs(block.y - model(block.x)), _part(block.phi)))
    return {name: _bounds(group, _part(held.phi)) for name, group in members.items()}


def part(samples: Samples, number: int) -> tuple[Samples, Samples]:
    """Samples without one of the blocks and what lies within 0.3 s of it, and that block."""
    cuts = np.linspace(0, len(samples), BLOCKS + 1).astype(int)
    block = samples.rows(slice(cuts[number], cuts[number + 1]))
    apart = (samples.time < block.time[0] - SEAM_S) | (samples.time > block.time[-1] + SEAM_S)
    return samples.rows(apart), block


def _part(phi: NDArray[np.float64]) -> NDArray[np.int_]:
    return np.clip((phi * PARTS / 100).astype(int), 0, PARTS - 1)


def _bounds(members: list[Member], parts: NDArray[np.int_]) -> NDArray[np.float64]:
    """CV+ in each part of the stride, at the level of so many blocks of strides."""
    predicted = np.array([member[0] for member in members])
    whose = np.concatenate([np.full(len(missed), k) for k, (_, missed, _) in enumerate(members)])
    missed, where = np.concatenate([m[1] for m in members]), np.concatenate([m[2] for m in members])
    strides = sum(1 + int(np.sum(np.diff(member[2]) < -PARTS / 2)) for member in members)
    high = min(LEVEL * (1 + STRIDES / strides), 1.0)
    bounds = np.empty((2, *predicted.shape[1:]))
    for part in np.unique(parts):
        at, errors = parts == part, where == part
        errors = np.flatnonzero(errors if errors.sum() >= FEWEST_ERRORS else np.ones(len(where), bool))
        errors = errors[:: -(-len(errors) // MOST_ERRORS)]
        around, reach = predicted[whose[errors]][:, at], missed[errors, None]
        for bound, sign, level in ((0, -1, 1 - high), (1, 1, high)):
            bounds[bound, at] = np.quantile(around + sign * reach, level, axis=0)
    return bounds


@dataclass(frozen=True, eq=False)
class Fit:
    """A model fitted to samples, and how."""

    model: Model
    decay: float  # weight decay of a network, penalty of a ridge regression
    epochs: int  # epochs trained; 0 where nothing is descended
    n_training: int  # samples of the whole training part
    n_inner: int  # samples of the inner block that chose the decay


@dataclass(frozen=True, eq=False)
class ResponseModels:
    """The models of one participant."""

    nominal: Fit  # Eq. 4.2
    exo: Fit  # Eq. 4.3, of the same inputs and outputs
    discrepancy: Fit  # Eq. 4.4, of the same inputs and outputs

    @property
    def augmented(self) -> Augmented:
        """Nominal plus Discrepancy (Eq. 4.5)."""
        return Augmented(self.nominal.model, self.discrepancy.model)

    def fits(self) -> dict[str, Fit]:
        """Return the models that were fitted, by name."""
        return {"nominal": self.nominal, "exo": self.exo, "discrepancy": self.discrepancy}

    def on_exo(self) -> dict[str, Model]:
        """Return the models that predict device walking, by the names of `ParticipantResponse`."""
        return {"nominal": self.nominal.model, "augmented": self.augmented, "exo": self.exo.model}


def fit_models(
    nominal: Samples,
    exo: Samples,
    fit: Callable[[Samples, Callable[[float], None]], Fit],
    progress: Callable[[float], None] | None = None,
) -> ResponseModels:
    """Fit Nominal, Exo and Discrepancy alike to both training parts, which have the same inputs and outputs.

    The Discrepancy model learns xddot_exo - f(x_exo, xdot_exo, phi_exo), what Nominal misses (Eq. 4.4).
    """
    reports = [partial(report_share, progress or (lambda _: None), done, 3) for done in range(3)]

    def fit_named(model: str, samples: Samples, report: Callable[[float], None]) -> Fit:
        try:
            return fit(samples, report)
        except TrainingError as error:
            raise TrainingError(f"the {model} model: {error.needed}", error.found, error.remedy) from error

    f = fit_named("Nominal", nominal, reports[0])
    y = fit_named("Exo", exo, reports[1])
    g = fit_named("Discrepancy", exo.with_outputs(exo.y - f.model(exo.x)), reports[2])
    return ResponseModels(nominal=f, exo=y, discrepancy=g)


def report_share(progress: Callable[[float], None], done: int, count: int, fraction: float) -> None:
    """Say how far a whole is, of which so many equal parts are done and so much of the next."""
    progress((done + fraction) / count)


def fit_network(
    samples: Samples, settings: TrainingSettings | None = None, progress: Callable[[float], None] | None = None
) -> Fit:
    """Fit the dissertation's feed-forward network."""
    from gaitdisc.models.networks import FeedForward  # brings torch, which takes two seconds
    from gaitdisc.models.trainer import train

    done = train(samples, FeedForward, settings, progress)
    return Fit(done.network, done.decay, len(done.losses), done.n_training, done.n_inner)


def refit_network(model: Model, samples: Samples) -> Model:
    """Return a network whose last layer is solved for other samples."""
    from gaitdisc.models.trained_network import TrainedNetwork
    from gaitdisc.models.trainer import resolve

    assert isinstance(model, TrainedNetwork)  # fit_network makes nothing else
    return resolve(model, samples)


def fit_linear(samples: Samples, harmonics: int = 8) -> Fit:
    """Fit the ridge regression that stands beside the network."""
    ridge, (_, inner) = fit_ridge(samples, harmonics), samples.last_block(INNER_SHARE, SEAM_S)
    return Fit(ridge, ridge.penalty, 0, len(samples), len(inner))
