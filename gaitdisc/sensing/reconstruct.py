"""Reconstruct one person's states: fit every kind of model on two parts of the windows, judge it on the third."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from gaitdisc.channel import Channel
from gaitdisc.recording import Samples
from gaitdisc.results.reconstruction import CALIBRATED
from gaitdisc.sensing.calibration import calibrated, first_strides, rehearsed
from gaitdisc.sensing.intervals import coverage, half_widths
from gaitdisc.sensing.model_folder import SensingModel
from gaitdisc.sensing.reconstructor import KINDS, Sensing, fit_reconstructor
from gaitdisc.sensing.splits import Parts
from gaitdisc.sensing.state_errors import Judged, angles_error, phase_curves, state_errors, stride_numbers
from gaitdisc.statistics.r2 import r2


@dataclass(frozen=True, eq=False)
class PersonReconstruction:
    """Every kind of model, fitted and judged for one person.

    Parameters
    ----------
    participant : str
        Pseudonym of the person on whom the models are judged.
    errors, summary, curves : DataFrame
        As in `gaitdisc.results.reconstruction.Reconstruction`.
    fitted : tuple of SensingModel
        The models, with the intervals that the check part gives.
    """

    participant: str
    errors: pd.DataFrame
    summary: pd.DataFrame
    curves: pd.DataFrame
    fitted: tuple[SensingModel, ...]


def reconstruct(
    participant: str,
    parts: Parts,
    what: Sensing,
    channels: Sequence[Channel],
    kinds: Sequence[str] = tuple(KINDS),
    seed: int = 0,
    calibration: int = 0,
) -> PersonReconstruction:
    """Fit every kind of model and judge it on the test part.

    Parameters
    ----------
    participant : str
        On whom the models are judged.
    parts : Parts
        Windows to fit, to choose by, to judge on.
    what : Sensing
        What is read and told.
    channels : sequence of Channel
        Of the sensors, then of the states, in the order of `what`.
    kinds : sequence of str
        Words of `KINDS`.
    seed : int
        Of every random act.
    calibration : int
        Strides of the test part, its first ones, on which models named `..., calibrated` are corrected for the person;
        windows that share a reading with them are not judged, whether a model is calibrated or not. 0 for none.

    Returns
    -------
    PersonReconstruction
    """
    training, check, test = parts.fitted(), parts.checked(), parts.judged()
    stride = stride_numbers(parts.test)
    own = channels[len(what.sensors) :]
    first = first_strides(parts.test, calibration, what.reach_s) if calibration else None
    judged_rows = np.ones(len(test), bool) if first is None else first.rest
    fitted, errors, summary, curves = [], [], [], []
    for kind in kinds:
        done = fit_reconstructor(kind, what, training, check, seed)
        missed = done(check) - check.y
        fitted.append(SensingModel(done, tuple(channels), half_widths(missed)))
        named = {kind: (done(test), missed)}
        if first is not None:
            rehearsal = rehearsed(done, parts.check, calibration)
            told = calibrated(done, first.strides, rehearsal.penalty)(test)
            named[CALIBRATED.format(kind)] = told, rehearsal.missed
        for name, (told, missed) in named.items():
            judged = Judged(test.rows(judged_rows), stride[judged_rows], told[judged_rows])
            row = _summary(judged, channels, what) | _checked(missed, half_widths(missed), training, judged)
            summary.append({"participant": participant, "model": name, "n_fitted": done.n_fitted, **row,
                            "seconds": done.seconds})  # fmt: skip
            errors.append(state_errors(judged, own, seed).assign(participant=participant, model=name))
            curves.append(phase_curves(judged, what.states).assign(participant=participant, model=name))
    order = ["participant", "model"]
    tables = (pd.concat(part, ignore_index=True) for part in (errors, curves))
    errors_table, curves_table = (table[[*order, *(c for c in table if c not in order)]] for table in tables)
    return PersonReconstruction(participant, errors_table, pd.DataFrame(summary), curves_table, tuple(fitted))


def _summary(judged: Judged, channels: Sequence[Channel], what: Sensing) -> dict[str, float]:
    count = len(what.sensors)
    angles = [k for k, channel in enumerate(channels[:count]) if channel.unit == "deg"]
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


def _checked(
    missed: NDArray[np.float64], half: NDArray[np.float64], training: Samples, judged: Judged
) -> dict[str, float]:
    """Loss by which models are chosen, and how often the interval that the check part gives holds."""
    spread = training.y.std(axis=0)
    inside = coverage(judged.told - judged.windows.y, half)
    return {"check_loss": float(np.mean((missed / spread) ** 2)), "coverage": float(np.mean(inside))}


def best_of(done: PersonReconstruction) -> SensingModel:
    """Model with the least error on the check part.

    Parameters
    ----------
    done : PersonReconstruction
        Fitted and judged.
    """
    loss = done.summary.drop_duplicates("model").set_index("model")["check_loss"]
    return min(done.fitted, key=lambda each: float(loss[each.reconstructor.kind]))
