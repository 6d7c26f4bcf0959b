"""Reconstruct one person's states: fit every kind of model on two parts of the windows, judge it on the third."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from gaitdisc.channel import Channel
from gaitdisc.results.reconstruction import CALIBRATED
from gaitdisc.sensing.calibration import calibrated, first_strides, rehearsed
from gaitdisc.sensing.crossed import crossed_widths
from gaitdisc.sensing.forecast import PERSISTENCE, PHASE_AVERAGE, persistence, phase_average
from gaitdisc.sensing.intervals import coverage, half_widths
from gaitdisc.sensing.model_folder import SensingModel
from gaitdisc.sensing.reconstructor import KINDS, Reconstructor, Sensing, fit_reconstructor
from gaitdisc.sensing.splits import PERSON_OUT, Parts
from gaitdisc.sensing.state_errors import (
    Judged,
    angle_columns,
    angles_error,
    phase_curves,
    state_errors,
    stride_numbers,
)
from gaitdisc.sensing.windows import stacked
from gaitdisc.statistics.r2 import r2


@dataclass(frozen=True)
class Fits:
    """What is fitted for a person, and how."""

    kinds: tuple[str, ...] = tuple(KINDS)
    seed: int = 0
    device: str = "auto"  # that networks are fitted on: `cpu`, `cuda`, or `auto`, the GPU where there is one
    # strides of the test part, its first ones, on which models named `..., calibrated` are corrected for the person;
    # windows that share a reading with them are not judged, whether a model is calibrated or not. 0 for none
    calibration: int = 0


@dataclass(frozen=True, eq=False)
class PersonReconstruction:
    """Every kind of model, fitted and judged for one person."""

    participant: str  # pseudonym of the person on whom the models are judged
    errors: pd.DataFrame  # as in `gaitdisc.results.reconstruction.Reconstruction`
    summary: pd.DataFrame  # as in `gaitdisc.results.reconstruction.Reconstruction`
    curves: pd.DataFrame  # as in `gaitdisc.results.reconstruction.Reconstruction`
    fitted: tuple[SensingModel, ...]  # the models, with the intervals that the check part gives

    def model(self, kind: str) -> SensingModel:
        """Return the model of one kind."""
        return next(each for each in self.fitted if each.reconstructor.kind == kind)


def reconstruct(
    participant: str,
    parts: Parts,
    what: Sensing,
    channels: Sequence[Channel],
    fits: Fits | None = None,
) -> PersonReconstruction:
    """Fit every kind of model and judge it on the test part; a forecast has its two baselines beside it.

    channels: of the sensors, then of the states, in the order of `what`
    """
    fits = fits or Fits()
    test, own = parts.judged(), channels[len(what.sensors) :]
    stride = stride_numbers(parts.test)
    fitted, accounts, judged_rows = _fitted(parts, what, fits)
    accounts += _baselines(parts, what) if what.lags.ahead else []
    judged_rows &= np.isfinite(np.hstack([account.told for account in accounts])).all(axis=1)
    spread, errors, summary, curves = parts.fitted().y.std(axis=0), [], [], []
    for account in accounts:
        judged = Judged(test.rows(judged_rows), stride[judged_rows], account.told[judged_rows])
        row = _summary(judged, channels, what) | account.checked(spread, judged)
        summary.append({"participant": participant, "model": account.model, "n_fitted": account.n_fitted, **row,
                        "seconds": account.seconds})  # fmt: skip
        errors.append(state_errors(judged, own, fits.seed).assign(participant=participant, model=account.model))
        curves.append(phase_curves(judged, what.states).assign(participant=participant, model=account.model))
    order = ["participant", "model"]
    tables = (pd.concat(part, ignore_index=True) for part in (errors, curves))
    errors_table, curves_table = (table[[*order, *(c for c in table if c not in order)]] for table in tables)
    models = tuple(SensingModel(done, tuple(channels), half) for done, half in fitted)
    return PersonReconstruction(participant, errors_table, pd.DataFrame(summary), curves_table, models)


@dataclass(frozen=True, eq=False)
class _Account:
    """What one model tells of the judged part, its errors on the check part, and its interval."""

    model: str
    told: NDArray[np.float64]
    missed: NDArray[np.float64]
    half_widths: NDArray[np.float64]
    n_fitted: int = 0
    seconds: float = 0.0

    def checked(self, spread: NDArray[np.float64], judged: Judged) -> dict[str, float]:
        """Loss by which models are chosen, and how often the interval that the check part gives holds."""
        inside = coverage(judged.told - judged.windows.y, self.half_widths)
        return {"check_loss": float(np.mean((self.missed / spread) ** 2)), "coverage": float(np.mean(inside))}


Fitted = tuple[Reconstructor, NDArray[np.float64]]  # and the half widths of its interval


def _fitted(parts: Parts, what: Sensing, fits: Fits) -> tuple[list[Fitted], list[_Account], NDArray[np.bool_]]:
    """Every kind of model, what it tells as it is and calibrated, and which windows may be judged."""
    training, check, test = parts.fitted(), parts.checked(), parts.judged()
    first = first_strides(parts.test, fits.calibration, what.reach_s) if fits.calibration else None
    fitted, accounts = [], []
    for kind in fits.kinds:
        done = fit_reconstructor(kind, what, training, check, fits.seed, fits.device)
        missed = done(check) - check.y
        alone = parts.rule != PERSON_OUT
        half = half_widths(missed) if alone else crossed_widths(kind, what, parts, missed, fits.seed)
        fitted.append((done, half))
        accounts.append(_Account(kind, done(test), missed, half, done.n_fitted, done.seconds))
        if first is not None:
            rehearsal = rehearsed(done, parts.check, fits.calibration)
            told = calibrated(done, first.strides, rehearsal.penalty)(test)
            name = CALIBRATED.format(kind)
            half = half_widths(rehearsal.missed)
            accounts.append(_Account(name, told, rehearsal.missed, half, done.n_fitted, done.seconds))
    return fitted, accounts, np.ones(len(test), bool) if first is None else first.rest


def _baselines(parts: Parts, what: Sensing) -> list[_Account]:
    """What a forecast has to beat.

    Errors are those on the fitted and the checked part: the latter alone may be shorter than the time ahead.
    """
    ahead_s, average = what.lags.ahead / what.rate_hz, phase_average(parts.training)
    known = [trial for trial in (*parts.training, *parts.check) if len(trial)]
    found = []
    for name, told in (
        (PERSISTENCE, partial(persistence, ahead_s=ahead_s)),
        (PHASE_AVERAGE, partial(average.told, ahead_s=ahead_s)),
    ):
        missed = told(known) - stacked(known).y
        missed = missed[np.isfinite(missed).all(axis=1)]
        found.append(_Account(name, told(parts.test), missed, half_widths(missed)))
    return found


def _summary(judged: Judged, channels: Sequence[Channel], what: Sensing) -> dict[str, float]:
    count = len(what.sensors)
    read = channels[:count] if not what.lags.ahead else ()  # the future of a sensor is told, not read
    angles = angle_columns(read)
    readings = judged.windows.x[:, -count:][:, angles]
    errors = angles_error(judged, channels[count:], readings)
    if len({channel.unit for channel in channels[count:]}) == 1 and channels[-1].unit != "deg":
        errors |= _alike(judged)
    return {"strides": judged.strides, **errors}


def _alike(judged: Judged) -> dict[str, float]:
    """Errors without unit of states that are no angles but all of one unit: muscles, forces, moments."""
    measured = judged.windows.y
    relative = float(np.linalg.norm(judged.told - measured) / np.linalg.norm(measured))
    return {"relative_l2": relative, "r2": float(np.nanmedian(r2(measured, judged.told)))}
