"""States from a few sensors, on arrays: `fit(x, y)` and `predict(x)`, as scikit-learn has it."""

from __future__ import annotations

import re
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias, Union

import numpy as np
from numpy.typing import ArrayLike

from gaitdisc.channel import Channel
from gaitdisc.errors import SamplingError, ShapeError, TrainingError
from gaitdisc.ingest.table import frame_columns, has_times
from gaitdisc.reconstruction.model_folder import SensingModel, load_model, save_model
from gaitdisc.reconstruction.state_errors import half_widths
from gaitdisc.reconstruction.window_model import Sensing, fit_reconstructor
from gaitdisc.reconstruction.windows import SEAM_S, Lags, cut_windows, stacked
from gaitdisc.recording import Recording, Samples
from gaitdisc.recording.arrays import Values, mean_rate, real_array
from gaitdisc.saved.kind import Kind, Saved
from gaitdisc.statistics.r2 import r2

if TYPE_CHECKING:
    import pandas as pd

CHECKED = 0.15  # of each trial, its last part: penalties, epochs and the interval are chosen on it
Readings: TypeAlias = Union[ArrayLike, Recording, "pd.DataFrame", "pd.Series[Any]"]
Trials: TypeAlias = Readings | Sequence[Readings]
SETTINGS = ("kind", "rate_hz", "history_s", "spacing_s", "ahead_s", "seed")


class Reconstructor(Saved, file="model.json"):
    """Estimate the states of a system from a few sensors and their history.

    Parameters
    ----------
    kind : str
        Kind of model: `linear` (ridge regression on the current readings), `delay ridge` (on readings and history),
        `fourier ridge` (on random Fourier features of both), `shallow decoder` (SDN, current readings), `shred`
        (recurrent network on readings and history, shallow decoder), or another kind of `docs/reconstruct.md`.
    rate_hz : float
        Sampling rate of all arrays [Hz].
    history_s : float
        Length of the history in a window [s].
    spacing_s : float
        Time between consecutive readings in a window [s].
    ahead_s : float
        Time from the last reading to the estimated state [s]; 0 for the current state.
    seed : int
        Seed of all random numbers.

    Attributes
    ----------
    half_widths : ndarray (state,) [each state's unit]
        Half width of the 90 % interval, from the validation part; available after `fit`.

    References
    ----------
    Williams, Zahn and Kutz 2024 (SHRED); Erichson et al. 2020 (shallow decoder). Ebers 2023, chapter 5.

    Examples
    --------
    >>> import gaitdisc as gd
    >>> t = np.arange(0.0, 30.0, 0.01)
    >>> x, y = np.sin(3 * t)[:, None], np.column_stack([np.cos(3 * t), np.sin(3 * t + 1)])
    >>> model = gd.Reconstructor("delay ridge", rate_hz=100.0, history_s=0.5).fit(x[:2000], y[:2000])
    >>> bool(model.score(x[2000:], y[2000:]) > 0.99)
    True
    """

    def __init__(
        self,
        kind: str = "delay ridge",
        rate_hz: float = 100.0,
        history_s: float = 1.0,
        spacing_s: float = 0.04,
        ahead_s: float = 0.0,
        seed: int = 0,
    ) -> None:
        self.kind, self.rate_hz, self.seed = kind, rate_hz, seed
        self.history_s, self.spacing_s, self.ahead_s = history_s, spacing_s, ahead_s
        self._model: SensingModel | None = None

    def fit(self, x: Trials, y: Trials) -> Reconstructor:
        """Fit the model to one trial, or to several.

        Penalties, epochs and `half_widths` are determined on the last 15 % of each trial, separated from the rest by
        one window and 0.3 s. Filter `x` and `y` first, and hold out your test data before you call `fit`.

        Parameters
        ----------
        x : array_like (time, sensor), DataFrame, Series, Recording, or a sequence of them
            Readings. `predict` finds the columns of a DataFrame or Recording by name. A column or index `time` contains
            times, which must agree with `rate_hz`; it is not a sensor.
        y : array_like (time, state), DataFrame, Series, Recording, or a sequence of them
            States at the same times.

        Returns
        -------
        Reconstructor
            The fitted model itself.

        Raises
        ------
        ShapeError
            If the arrays do not match.
        SamplingError
            If a trial is shorter than a window.
        TrainingError
            If too few windows remain, or a state does not vary.
        """
        many = isinstance(x, list | tuple) and (isinstance(x[0], Recording) or np.ndim(x[0]) > 1)
        trials_of_x, trials_of_y = (list(x), list(y)) if many else ([x], [y])  # type: ignore[arg-type]
        readings, states = (
            [_read(trial, self.rate_hz, words) for trial in trials]
            for trials, words in ((trials_of_x, "readings"), (trials_of_y, "states"))
        )
        for trial_of_x, trial_of_y in zip(readings, states, strict=False):
            _check_same_times(trial_of_x, trial_of_y, self.rate_hz)
        if len(readings) != len(states):
            raise ShapeError(
                "readings and states must have the same number of trials",
                f"the readings have {len(readings)}, the states {len(states)}",
                "Give one array of states for each array of readings.",
            )
        sensors, targets = readings[0].names_or("sensor"), states[0].names_or("state")
        both = [name for name in targets if name in sensors]
        if both:
            raise ShapeError(
                "a state must not be one of the sensors",
                f"{both[0]!r} is a sensor and a state",
                "Remove it from the states, because it is measured.",
            )
        lags = Lags(
            max(1, round(self.history_s / self.spacing_s) + 1) if self.history_s else 1,
            max(1, round(self.spacing_s * self.rate_hz)),
            round(self.ahead_s * self.rate_hz),
        )
        what = Sensing(sensors, targets, lags, float(self.rate_hz))
        windows = [self._windows(*pair, what) for pair in zip(readings, states, strict=True)]
        blocks = [trial.last_block(CHECKED, what.reach_s + SEAM_S) for trial in windows]
        training, check = (stacked([block[k] for block in blocks]) for k in (0, 1))
        done = fit_reconstructor(self.kind, what, training, check, self.seed)
        self._model = SensingModel(done, _signals((*sensors, *targets)), half_widths(done(check) - check.y))
        return self

    def predict(self, x: Readings) -> Values:
        """Estimate the states of one trial.

        Parameters
        ----------
        x : array_like (time, sensor), DataFrame or Recording
            Readings at `rate_hz`, with the sensors of `fit` by name or in the same order.

        Returns
        -------
        ndarray (time, state)
            States at the times of `x`; NaN if the history is incomplete or a reading is missing. A forecast for a time
            uses readings until `ahead_s` before that time.

        Raises
        ------
        TrainingError
            If the model was not fitted.
        ShapeError
            If there are more or fewer sensors than at `fit`.
        """
        model = self.model
        readings = _read(x, self.rate_hz, "readings")
        return np.array(model(self._recording(readings, model.reconstructor.sensing.sensors)).values)

    def score(self, x: Readings, y: Readings) -> float:
        """R2 of the estimates, averaged over states.

        Parameters
        ----------
        x : array_like (time, sensor), DataFrame or Recording
            Readings.
        y : array_like (time, state), DataFrame or Recording
            Measured states at the same times.
        """
        states = _read(y, self.rate_hz, "states")
        _check_same_times(_read(x, self.rate_hz, "readings"), states, self.rate_hz)
        estimated = self.predict(x)
        measured = states.in_order(self.model.reconstructor.sensing.states)
        known = np.isfinite(estimated).all(axis=1) & np.isfinite(measured).all(axis=1)
        return float(np.mean(r2(measured[known], estimated[known])))

    def windows(self, x: ArrayLike, percent: ArrayLike) -> Samples:
        """Windows of readings in the form that the fitted model needs.

        Parameters
        ----------
        x : array_like (time, sensor)
            Readings at `rate_hz`.
        percent : array_like (time,) [% stride]
            Percent stride of these times.

        Returns
        -------
        Samples
            Windows without states, with the percent stride of the last reading of each window.
        """
        what = self.model.reconstructor.sensing
        read = self._recording(_read(x, self.rate_hz, "readings"), what.sensors)
        return cut_windows(read, what.sensors, (), what.lags, np.asarray(percent, float))

    def get_params(self, deep: bool = True) -> dict[str, Any]:  # noqa: ARG002
        """Return the settings by name, for scikit-learn's `clone` and `Pipeline`.

        Parameters
        ----------
        deep : bool
            Has no effect, because there is no inner estimator.
        """
        return {name: getattr(self, name) for name in SETTINGS}

    def set_params(self, **settings: Any) -> Reconstructor:
        """Change settings, for scikit-learn's searches; the fitted model is discarded.

        Parameters
        ----------
        **settings
            Settings of the constructor.
        """
        if unknown := sorted(set(settings) - set(SETTINGS)):
            raise TrainingError(
                f"settings must be among {', '.join(SETTINGS)}", f"found {unknown[0]!r}", "Name one of these."
            )
        self.__init__(**{**self.get_params(), **settings})  # type: ignore[misc]
        return self

    def __sklearn_is_fitted__(self) -> bool:
        return self._model is not None

    def __sklearn_tags__(self) -> Any:
        from sklearn.utils import RegressorTags, Tags, TargetTags

        return Tags("regressor", TargetTags(required=True, multi_output=True), regressor_tags=RegressorTags())

    @property
    def model(self) -> SensingModel:
        """The fitted model; it can be called with a Recording."""
        if self._model is None:
            known = sys.modules.get("sklearn.exceptions")  # whose tools look for its own class
            UnfittedError = type("TrainingError", (TrainingError, *([known.NotFittedError] if known else [])), {})
            raise UnfittedError("the model must be fitted to predict", "fit was not called", "Call fit(x, y) first.")
        return self._model

    @property
    def half_widths(self) -> Values:
        """Half width of the 90 % interval of each state (state,), in its unit."""
        return self.model.half_widths

    def __repr__(self) -> str:
        fitted = "not fitted"
        if self._model is not None:
            what = self._model.reconstructor.sensing
            windows = self._model.reconstructor.n_fitted
            fitted = f"{len(what.sensors)} sensors to {len(what.states)} states, fitted to {windows} windows"
        return f"Reconstructor({self.kind!r}, {self.rate_hz:g} Hz, {self.history_s:g} s of history: {fitted})"

    def _recording(self, readings: Given, sensors: tuple[str, ...]) -> Recording:
        values = readings.in_order(sensors)
        if values.shape[1] != len(sensors):
            raise ShapeError(
                f"the array must have one column per sensor of the model ({len(sensors)})",
                f"the number of columns is {values.shape[1]}",
                "Give the sensors of fit, in the same order.",
            )
        return Recording(np.arange(len(values)) / self.rate_hz, values, _signals(sensors))

    def _windows(self, readings: Given, states: Given, what: Sensing) -> Samples:
        read = self._recording(readings, what.sensors)
        if states.values.shape != (len(read.time), len(what.states)):
            raise ShapeError(
                f"every reading must have a row of {len(what.states)} states",
                f"the readings have shape {read.values.shape}, the states {states.values.shape}",
                "Give one row per time in both.",
            )
        both = Recording(read.time, np.hstack([read.values, states.values]), _signals((*what.sensors, *what.states)))
        return what.windows(both, np.zeros(len(read.time)))


def load_reconstructor(folder: Path) -> Reconstructor:
    """Load what `Reconstructor.save` or `gaitdisc reconstruct` wrote; a damaged file is refused."""
    model = load_model(folder)
    what = model.reconstructor.sensing
    lags, rate = what.lags, what.rate_hz
    done = Reconstructor(model.reconstructor.kind, rate, lags.reach / rate, lags.spacing / rate, lags.ahead / rate)
    done._model = model
    return done


RECONSTRUCTOR = Kind(
    Reconstructor, "model.json", write=lambda fitted, folder: save_model(fitted.model, folder), read=load_reconstructor
)


def _signals(names: tuple[str, ...]) -> tuple[Channel, ...]:
    return tuple(Channel(name, "signal", "1") for name in names)


class Given(NamedTuple):
    """Readings or states of one trial, as they were given."""

    values: Values  # (time, column)
    names: tuple[str, ...]  # of the columns; none of an array
    time: Values | None  # [s]; None where no times were given

    def names_or(self, word: str) -> tuple[str, ...]:
        """Names of the columns; a word and their number where they have none."""
        return self.names or tuple(f"{word}_{number}" for number in range(1, self.values.shape[1] + 1))

    def in_order(self, order: tuple[str, ...]) -> Values:
        """Columns of the sensors or states by name, where both have names; else as given."""
        if not self.names or all(re.fullmatch(r"(sensor|state)_\d+", name) for name in order):
            return self.values
        absent = [name for name in order if name not in self.names]
        if absent:
            raise ShapeError(
                f"the table must have the columns {', '.join(order)}",
                f"{absent[0]!r} is not among {', '.join(self.names[:8])}",
                "Use the column names of fit, or an array in the order of fit.",
            )
        return self.values[:, [self.names.index(name) for name in order]]


def _read(data: Any, rate_hz: float, words: str) -> Given:
    """Read a trial from a recording, a table, a column or an array; its times, if any, must have the model's rate."""
    if isinstance(data, Recording):
        _check_rate(rate_hz, data.rate_hz, "recording")
        return Given(data.values, data.names, data.time)
    names, time = (), None
    if hasattr(data, "to_frame"):  # one column of a DataFrame
        names = () if data.name is None else (str(data.name),)
        data = data.to_frame(data.name if names else words)
    elif hasattr(data, "columns"):
        names = tuple(map(str, data.columns))
    if hasattr(data, "columns") and has_times(data):
        time, labels, data = frame_columns(data)
        _check_rate(rate_hz, mean_rate(time), "table")
        names = names and tuple(labels)
    elif hasattr(data, "columns") and data.index.dtype.kind == "f":
        time = np.asarray(data.index, float)
    values = real_array(data)
    if values.ndim != 2:
        raise ShapeError(
            f"{words} must be an array (time, column)",
            f"found {values.shape}",
            "Put time first, with one column per sensor or state: x[:, None] for a single one.",
        )
    return Given(values, names, time)


def _check_same_times(readings: Given, states: Given, rate_hz: float) -> None:
    """Refuse readings and states that were measured more than half a sample apart: they are paired row by row."""
    first, second = readings.time, states.time
    if first is None or second is None or len(first) != len(second):
        return
    row = int(np.argmax(np.abs(first - second)))
    if abs(first[row] - second[row]) > 0.5 / rate_hz:
        raise SamplingError(
            "readings and states must be measured at the same times",
            f"in row {row + 1} the readings are at {first[row]:.6g} s, the states at {second[row]:.6g} s",
            "Cut both to the same period, or shift the clock of one.",
        )


def _check_rate(rate_hz: float, found_hz: float, what: str) -> None:
    if abs(found_hz - rate_hz) > 1e-3 * rate_hz:
        raise SamplingError(
            f"the {what} must have {rate_hz:g} samples per second, the rate of the model",
            f"its rate is {found_hz:g} samples per second",
            "Resample it, or state its rate: Reconstructor(rate_hz=...).",
        )
