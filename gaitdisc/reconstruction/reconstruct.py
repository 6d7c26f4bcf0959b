"""Reconstruct one person's states: fit every kind of model on two parts of the windows, test it on the third."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from gaitdisc.channel import Channel
from gaitdisc.errors import StrideError
from gaitdisc.reconstruction.calibration import calibrate, first_strides, rehearse
from gaitdisc.reconstruction.model_folder import SensingModel
from gaitdisc.reconstruction.reconstruction import CALIBRATED, FLOORS
from gaitdisc.reconstruction.state_errors import (
    Reconstructed,
    angle_columns,
    angles_error,
    coverage,
    half_widths,
    phase_curves,
    state_errors,
    stride_numbers,
)
from gaitdisc.reconstruction.window_model import KINDS, WITHOUT_NETWORK, Sensing, WindowModel, fit_reconstructor
from gaitdisc.reconstruction.windows import PERSON_OUT, Parts, stacked
from gaitdisc.recording import Samples
from gaitdisc.recording.arrays import Values, finite_rows
from gaitdisc.statistics.r2 import r2

PERSISTENCE, PHASE_AVERAGE = FLOORS
BASELINES = {
    PERSISTENCE: "all states as measured at the time of the forecast, not reconstructed from the sensors",
    PHASE_AVERAGE: "the mean stride of the training part, at the phase given by the time since the last contact",
}
POINTS, LEAST_FILLED = 100, 0.5


def persistence(trials: Sequence[Samples], ahead_s: float) -> Values:
    """States as they were `ahead_s` before, (window, state); NaN where that time has no window.

    trials: windows of each trial, in order of time; time and y are those of the state that is forecast
    ahead_s: from the last reading to that state [s]

    >>> t = np.arange(5) / 10
    >>> persistence([Samples(t[:, None], t[:, None], ("a",), ("a",), t, t)], 0.2).ravel().tolist()
    [nan, nan, 0.0, 0.1, 0.2]
    """
    forecast = []
    for trial in trials:
        before = trial.time - ahead_s
        row = np.clip(np.searchsorted(trial.time, before - 1e-6), 0, max(len(trial) - 1, 0))
        exists = np.abs(trial.time[row] - before) < 1e-6
        forecast.append(np.where(exists[:, None], trial.y[row], np.nan))
    return np.concatenate(forecast)


@dataclass(frozen=True, eq=False)
class PhaseAverage:
    """The mean stride of a fitted part, as a forecast."""

    curve: Values  # (phase, state) [each state's unit], mean in each percent of the stride
    stride_s: float  # mean duration of a stride [s]

    def forecast(self, trials: Sequence[Samples], ahead_s: float) -> Values:
        """States (window, state) `ahead_s` [s] after the last reading, at the expected phase; NaN before a contact.

        Phase is the time since the last known contact by the mean duration of a stride: percent stride is known later.
        """
        forecasts = []
        for trial in trials:
            contacts = contact_times(trial)
            last = np.searchsorted(contacts, trial.time - ahead_s + 1e-9) - 1
            since = trial.time - np.append(contacts, np.nan)[last]  # -1, none yet, takes the NaN
            phase = np.where(last < 0, np.nan, since / self.stride_s % 1.0)
            known = np.isfinite(phase)
            values = np.full((len(trial), self.curve.shape[1]), np.nan)
            values[known] = self.curve[(phase[known] * POINTS).astype(int) % POINTS]
            forecasts.append(values)
        return np.concatenate(forecasts)


def phase_average(trials: Sequence[Samples]) -> PhaseAverage:
    """Mean stride of a fitted part; a percent without a sample lies between its neighbours.

    Strides of 71 samples each, all from a sample on, leave 29 percents empty however many there are.
    """
    durations = np.concatenate([np.diff(contact_times(trial)) for trial in trials])
    phi, y = (np.concatenate([getattr(trial, name) for trial in trials]) for name in ("phi", "y"))
    known = np.isfinite(phi)
    place = (phi[known] * POINTS / 100).astype(int) % POINTS
    counts = np.bincount(place, minlength=POINTS)
    filled = counts > 0
    if not len(durations) or filled.mean() < LEAST_FILLED:
        raise StrideError(
            "the training part must have strides that fill the mean stride",
            f"the number of strides is {len(durations)}, and {int((counts == 0).sum())} of {POINTS} points are empty",
            "Record longer, or reconstruct the present state (ahead 0).",
        )
    sums = np.zeros((POINTS, y.shape[1]))
    np.add.at(sums, place, y[known])
    at = np.flatnonzero(filled)
    means = sums[at] / counts[at, None]
    curve = np.column_stack([np.interp(np.arange(POINTS), at, column, period=POINTS) for column in means.T])
    return PhaseAverage(curve, float(np.median(durations)))


def contact_times(trial: Samples) -> Values:
    """Contacts by percent stride, in order [s].

    >>> t = np.arange(0.0, 3.0, 0.1)
    >>> s = Samples(t[:, None], t[:, None], ("a",), ("a",), t, 100 * ((t + 0.25) % 1.0))
    >>> contact_times(s).round(6).tolist()
    [-0.25, 0.75, 1.75, 2.75]
    """
    steps, rises = np.diff(trial.time), np.diff(trial.phi)
    within = (rises > 0) & (steps < 1.5 * np.median(steps)) if len(steps) else np.zeros(0, bool)
    duration = 100 * steps[within] / rises[within]
    begun = trial.time[1:][within] - trial.phi[1:][within] / 100 * duration
    both = np.sort(np.concatenate([begun, begun + duration]))
    if not len(both):
        return both
    groups = np.split(both, np.flatnonzero(np.diff(both) > 0.1 * np.median(duration)) + 1)
    last = trial.time[-1]
    return np.array([time for group in groups if (time := float(np.median(group))) <= last])


@dataclass(frozen=True)
class Fits:
    """What is fitted for a person, and how."""

    kinds: tuple[str, ...] = tuple(KINDS)
    seed: int = 0
    device: str = "auto"  # that networks are fitted on: `cpu`, `cuda`, or `auto`, the GPU where there is one
    # strides of the test part, its first ones, on which models named `..., calibrated` are corrected for the person;
    # windows that share a reading with them are no test windows, whether a model is calibrated or not. 0 for none
    calibration: int = 0


@dataclass(frozen=True, eq=False)
class PersonReconstruction:
    """Every kind of model, fitted and tested for one person."""

    participant: str  # pseudonym of the person on whom the models are tested
    errors: pd.DataFrame  # as in `gaitdisc.reconstruction.reconstruction.Reconstruction`
    summary: pd.DataFrame  # as in `gaitdisc.reconstruction.reconstruction.Reconstruction`
    curves: pd.DataFrame  # as in `gaitdisc.reconstruction.reconstruction.Reconstruction`
    fitted: tuple[SensingModel, ...]  # the models, with the intervals that the check part gives

    def model(self, kind: str) -> SensingModel:
        """Return the model of one kind."""
        return next(model for model in self.fitted if model.reconstructor.kind == kind)


def reconstruct(
    participant: str, parts: Parts, what: Sensing, channels: Sequence[Channel], fits: Fits
) -> PersonReconstruction:
    """Fit and test every kind of model, a forecast beside its two baselines; channels: sensors, then states."""
    test, state_channels = parts.tested(), channels[len(what.sensors) :]
    stride = stride_numbers(parts.test)
    fitted, predictions, test_rows = _fitted(parts, what, fits)
    predictions += _baselines(parts, what) if what.lags.ahead else []
    test_rows &= np.isfinite(np.hstack([prediction.states for prediction in predictions])).all(axis=1)
    spread, summary = parts.fitted().y.std(axis=0), []
    errors: dict[tuple[str, str], pd.DataFrame] = {}
    curves: dict[tuple[str, str], pd.DataFrame] = {}
    for prediction in predictions:
        tested = Reconstructed(test.rows(test_rows), stride[test_rows], prediction.states[test_rows])
        inside = coverage(tested.states - tested.windows.y, prediction.half_widths)
        summary.append(
            {
                "participant": participant,
                "model": prediction.model,
                "n_fitted": prediction.n_fitted,
                **_summary(tested, channels, what),
                "check_loss": float(np.mean((prediction.missed / spread) ** 2)),
                "coverage": float(np.mean(inside)),
                "seconds": prediction.seconds,
            }
        )
        errors[participant, prediction.model] = state_errors(tested, state_channels, fits.seed)
        curves[participant, prediction.model] = phase_curves(tested, what.states)
    errors_table, curves_table = (
        pd.concat(tables, names=["participant", "model"]).reset_index(level=[0, 1]).reset_index(drop=True)
        for tables in (errors, curves)
    )
    models = tuple(SensingModel(done, tuple(channels), half) for done, half in fitted)
    return PersonReconstruction(participant, errors_table, pd.DataFrame(summary), curves_table, models)


@dataclass(frozen=True, eq=False)
class _Prediction:
    """States that one model reconstructs in the test part, its errors on the check part, and its interval."""

    model: str
    states: Values
    missed: Values
    half_widths: Values
    n_fitted: int = 0
    seconds: float = 0.0


Fitted = tuple[WindowModel, Values]  # and the half widths of its interval


def _fitted(parts: Parts, what: Sensing, fits: Fits) -> tuple[list[Fitted], list[_Prediction], NDArray[np.bool_]]:
    """Every kind of model, its states as it is and calibrated, and which windows are tested."""
    training, check, test = parts.fitted(), parts.checked(), parts.tested()
    strides, tested, fitted, predictions = None, np.ones(len(test), bool), [], []
    if fits.calibration:
        strides, tested = first_strides(parts.test, fits.calibration, what.reach_s)
    for kind in fits.kinds:
        done = fit_reconstructor(kind, what, training, check, fits.seed, fits.device)
        missed = done(check) - check.y
        alone = parts.rule != PERSON_OUT
        half = half_widths(missed) if alone else cross_widths(kind, what, parts, missed, fits.seed)
        fitted.append((done, half))
        predictions.append(_Prediction(kind, done(test), missed, half, done.n_fitted, done.seconds))
        if strides is not None:
            penalty, missed = rehearse(done, parts.check, fits.calibration)
            states, name = calibrate(done, strides, penalty)(test), CALIBRATED.format(kind)
            predictions.append(_Prediction(name, states, missed, half_widths(missed), done.n_fitted, done.seconds))
    return fitted, predictions, tested


def _baselines(parts: Parts, what: Sensing) -> list[_Prediction]:
    """What a forecast has to beat; errors of fitted and checked part, the latter may be shorter than the time ahead."""
    ahead_s = what.lags.ahead / what.rate_hz
    known = (*parts.training, *parts.check)
    predictions = []
    for name, forecast in ((PERSISTENCE, persistence), (PHASE_AVERAGE, phase_average(parts.training).forecast)):
        missed = finite_rows(forecast(known, ahead_s) - stacked(known).y)
        predictions.append(_Prediction(name, forecast(parts.test, ahead_s), missed, half_widths(missed)))
    return predictions


def _summary(tested: Reconstructed, channels: Sequence[Channel], what: Sensing) -> dict[str, float]:
    count = len(what.sensors)
    read = channels[:count] if not what.lags.ahead else ()  # the future of a sensor is forecast, not read
    angles = angle_columns(read)
    readings = tested.windows.x[:, -count:][:, angles]
    errors = angles_error(tested, channels[count:], readings)
    if len({channel.unit for channel in channels[count:]}) == 1 and channels[-1].unit != "deg":
        measured = tested.windows.y
        relative = float(np.linalg.norm(tested.states - measured) / np.linalg.norm(measured))
        errors |= {"relative_l2": relative, "r2": float(np.nanmedian(r2(measured, tested.states)))}
    return {"strides": tested.strides, **errors}


FOLDS = 5
FEWEST = 3  # people of whom one can be left out, one chosen by, one fitted
STANDARD = "delay ridge"  # stands in for the others in how far the checked people are from typical


def cross_errors(kind: str, what: Sensing, parts: Parts, seed: int = 0) -> Values:
    """Errors (window, state) on everybody fitted or checked, in five groups, each by a model of the others."""
    people = group_people((*parts.check, *parts.training))
    names = list(people)
    errors = []
    for group in range(min(FOLDS, len(names))):
        left_out = names[group::FOLDS]
        others = [name for name in names if name not in left_out]
        training = stacked([trial for name in others[1:] for trial in people[name]])
        done = fit_reconstructor(kind, what, training, stacked(people[others[0]]), seed)
        errors += [done(trial) - trial.y for name in left_out for trial in people[name]]
    return np.concatenate(errors)


def cross_widths(kind: str, what: Sensing, parts: Parts, missed: Values, seed: int = 0) -> Values:
    """Half width of the 90 % interval for a person whom a model has not seen, (state,) [each state's unit].

    One checked person may be reconstructed better or worse than most (and is all there is where there are fewer than
    four people in all). Ridge regression is therefore crossed over people; a network, which would take five times as
    long, gets its interval on the checked person, times what crossing changes for ridge regression on delays.

    missed (window, state) [each state's unit]: errors of the model on the checked person
    Source: Barber, Candes, Ramdas and Tibshirani 2021, Predictive inference with the jackknife+ (CV+); here one
        interval for all, about what the model of everybody reconstructs.
    """
    if len(group_people((*parts.check, *parts.training))) < FEWEST:
        return half_widths(missed)
    if kind in WITHOUT_NETWORK:
        return half_widths(cross_errors(kind, what, parts, seed))
    check = parts.checked()
    standard = fit_reconstructor(STANDARD, what, parts.fitted(), check, seed)
    standard_widths = half_widths(standard(check) - check.y)
    return half_widths(missed) * half_widths(cross_errors(STANDARD, what, parts, seed)) / standard_widths


def group_people(trials: Sequence[Samples]) -> dict[str, list[Samples]]:
    """Trials of each person, by pseudonym."""
    people: dict[str, list[Samples]] = {}
    for trial in trials:
        if len(trial):
            people.setdefault(trial.subject, []).append(trial)
    return people
