"""The response of one participant: fit on the first part of both walks, score on the last."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from gaitdisc.errors import ChannelError, TrainingError
from gaitdisc.networks.training_settings import TrainingSettings
from gaitdisc.recording import Samples, Trajectory
from gaitdisc.response.band import response_bands
from gaitdisc.response.models import ResponseModels, fit_linear, fit_models, fit_network, refitted_network
from gaitdisc.response.samples import gait_samples
from gaitdisc.results.participant_response import FIT_COLUMNS, R2_COLUMNS, HeldOut, ParticipantResponse
from gaitdisc.statistics.r2 import r2
from gaitdisc.statistics.stride_residuals import stride_curves, strides_of_phase
from gaitdisc.units import rate_unit

LEAST_HELD_OUT = 50


@dataclass(frozen=True)
class ResponseSettings:
    """What is predicted, on what it is scored, and how the models are fitted.

    >>> ResponseSettings(("ankle_angle_r",)).training.seed
    0
    """

    outputs: tuple[str, ...]
    # length held out at the end of both walks [s]; without it, `held_out_share` of each
    held_out_s: float | None = None
    held_out_share: float = 0.125  # share held out; the dissertation has 12.5 %, 30 s of 240 s
    training: TrainingSettings = field(default_factory=TrainingSettings)
    harmonics: int = 8  # harmonics of percent stride in the ridge regression


@dataclass(frozen=True, eq=False)
class FittedResponse:
    """The models of one participant, of every kind."""

    network: ResponseModels
    ridge: ResponseModels  # regressions with phase harmonics
    linear: ResponseModels  # regressions on the networks' own inputs alone


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
    null_r2: R2 that noise reaches through the same filters, for each output (`gaitdisc.statistics.band_limit_null`)
    banded: whether predictions get a band from refits on blocks
    Source: Ebers 2023, Eqs. 4.1-4.5 and section 4.2.3. Beside the source: ridge regressions with phase harmonics and
        without, and the null of the filters, stand beside every network, and the Nominal model is scored on held-out
        nominal walking, too.
    """
    _check_pair(nominal, exo)
    held_nominal, held_exo = (held_out_part(walk, settings)[1] for walk in (nominal, exo))
    on_nominal, on_exo = (held_out_samples(held, settings) for held in (held_nominal, held_exo))
    parts = training_samples(nominal, exo, settings)
    fitted = fit_both(*parts, settings, progress)
    kinds = {"network": fitted.network, "ridge": fitted.ridge, "linear": fitted.linear}
    scored = [_scored(kind, models, on_nominal, on_exo, settings) for kind, models in kinds.items()]
    predicted = {name: model(on_exo.x) for name, model in fitted.network.on_exo().items()}
    bands = response_bands(fitted.network, refitted_network, *parts, on_exo) if banded else {}
    return ParticipantResponse(
        participant=exo.subject or nominal.subject,
        inputs=on_exo.inputs,
        outputs=settings.outputs,
        units=tuple(rate_unit(exo.channels[column].unit, 2) for column in exo.columns(settings.outputs)),
        r2=pd.concat([*scored, _null_rows(null_r2 or {}, settings, len(on_exo))], ignore_index=True),
        fits=pd.concat([_fit_rows(kind, models) for kind, models in kinds.items()], ignore_index=True),
        held_out=HeldOut(on_exo.time, on_exo.phi, on_exo.y, predicted, bands),
        residuals={name: residual_strides(held_exo, on_exo, values) for name, values in predicted.items()},
        held_out_s=len(held_exo.time) / held_exo.rate_hz,
    )


def training_samples(nominal: Trajectory, exo: Trajectory, settings: ResponseSettings) -> tuple[Samples, Samples]:
    """Samples of the training parts of both walks; the held-out parts are not looked at."""
    first, second = (gait_samples(held_out_part(walk, settings)[0], settings.outputs)[0] for walk in (nominal, exo))
    return first, second


def fit_both(
    nominal: Samples,
    exo: Samples,
    settings: ResponseSettings,
    progress: Callable[[float], None] | None = None,
) -> FittedResponse:
    """Fit networks and ridge regressions to the samples of the training parts."""
    ridge = fit_models(nominal, exo, fit=lambda part, _: fit_linear(part, settings.harmonics))
    linear = fit_models(nominal, exo, fit=lambda part, _: fit_linear(part, harmonics=0))
    networks = fit_models(
        nominal, exo, fit=lambda part, report: fit_network(part, settings.training, report), progress=progress
    )
    return FittedResponse(networks, ridge, linear)


def held_out_part(walk: Trajectory, settings: ResponseSettings) -> tuple[Trajectory, Trajectory]:
    """Training part and held-out part of a walk."""
    length = settings.held_out_s or settings.held_out_share * len(walk.time) / walk.rate_hz
    return walk.split(length)


def held_out_samples(held_out: Trajectory, settings: ResponseSettings) -> Samples:
    """Samples of a held-out part that models are scored on."""
    samples, dropped = gait_samples(held_out, settings.outputs)
    if len(samples) < LEAST_HELD_OUT:
        raise TrainingError(
            f"a model is tested on {LEAST_HELD_OUT} held-out samples at least",
            f"the last {len(held_out.time) / held_out.rate_hz:.2f} s: {dropped.finding().line()}",
            "Hold out a longer part, or mend or leave away the channels named.",
        )
    return samples


def residual_strides(held_out: Trajectory, samples: Samples, predicted: NDArray[np.float64]) -> NDArray[np.float64]:
    """Measured minus predicted over every stride that lies wholly in the held-out part.

    predicted (sample, output) [unit/s2]: for these samples
    returns (stride, phase, output) [unit/s2]: NaN where samples are missing
    """
    residual = np.full((len(held_out.time), len(samples.outputs)), np.nan)
    residual[np.searchsorted(held_out.time, samples.time)] = samples.y - predicted
    return stride_curves(held_out.time, residual, strides_of_phase(held_out.time, held_out.phi))


def _scored(
    kind: str, models: ResponseModels, on_nominal: Samples, on_exo: Samples, settings: ResponseSettings
) -> pd.DataFrame:
    trials = [("nominal", models.nominal.model, "nominal", on_nominal)]
    trials += [(name, model, "exo", on_exo) for name, model in models.on_exo().items()]
    rows = [
        (variable, name, kind, walk, value, len(held))
        for name, model, walk, held in trials
        for variable, value in zip(settings.outputs, r2(held.y, model(held.x)), strict=True)
    ]
    return pd.DataFrame(rows, columns=pd.Index(R2_COLUMNS))


def _null_rows(null_r2: Mapping[str, float], settings: ResponseSettings, samples: int) -> pd.DataFrame:
    known = [variable for variable in settings.outputs if variable in null_r2]
    rows = [(variable, "nominal", "null", "exo", float(null_r2[variable]), samples) for variable in known]
    return pd.DataFrame(rows, columns=pd.Index(R2_COLUMNS))


def _fit_rows(kind: str, models: ResponseModels) -> pd.DataFrame:
    fits = {"nominal": models.nominal, "exo": models.exo, "discrepancy": models.discrepancy}
    rows = [(name, kind, fit.decay, fit.epochs, fit.n_training, fit.n_inner) for name, fit in fits.items()]
    return pd.DataFrame(rows, columns=pd.Index(FIT_COLUMNS))


def _check_pair(nominal: Trajectory, exo: Trajectory) -> None:
    if nominal.subject and exo.subject and nominal.subject != exo.subject:
        raise ChannelError(
            "a response needs two walks of one participant",
            f"found {nominal.subject} and {exo.subject}",
            "Pair the trials by participant in the study.",
        )
    if nominal.channels != exo.channels:
        apart = sorted(set(nominal.names) ^ set(exo.names))
        found = f"apart in {', '.join(apart[:5])}" if apart else "they differ in order or unit"
        raise ChannelError(
            "a response needs the same channels in both walks",
            f"{nominal.subject}: {len(nominal.names)} channels in {nominal.condition or 'nominal'}, "
            f"{len(exo.names)} in {exo.condition or 'exo'}, {found}",
            "Leave away what one walk lacks.",
        )
