"""States from a few sensors, on arrays: `fit(x, y)` and `predict(x)`, as scikit-learn has it."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gaitdisc.channel import Channel
from gaitdisc.errors import SamplingError, ShapeError, TrainingError
from gaitdisc.recording import Recording, Samples
from gaitdisc.results.saved import Saved
from gaitdisc.sensing.intervals import half_widths
from gaitdisc.sensing.model_folder import SensingModel, load_model, save_model
from gaitdisc.sensing.reconstructor import Sensing, fit_reconstructor
from gaitdisc.sensing.windows import Lags, stacked, windows_of
from gaitdisc.statistics.r2 import r2

CHECKED = 0.15  # of each trial, its last part: penalties, epochs and the interval are chosen on it
SEAM_S = 0.3  # zero-lag filters look ahead and back over the border
Trials = ArrayLike | Sequence[ArrayLike]


class Reconstructor(Saved, by="gaitdisc.library.reconstructor:save_reconstructor"):
    """Estimate the states of a system from the readings of a few sensors and their history.

    Parameters
    ----------
    kind : str
        A kind of `gaitdisc reconstruct --kinds`: `linear` (ridge regression on the present readings), `delay ridge` (on
        readings and their history), `fourier ridge` (on random Fourier features of these), `shallow decoder` (SDN,
        present readings), `shred` (recurrent network on readings and history, shallow decoder), or one on request.
    rate_hz : float
        Samples a second of all arrays [Hz].
    history_s : float
        How far back a window reaches [s].
    spacing_s : float
        From one reading of a window to the next [s].
    ahead_s : float
        0 estimates the present state, more of it forecasts [s].
    seed : int
        Of every random act.

    Attributes
    ----------
    half_widths : ndarray (state,) [each state's unit]
        Half width of the 90 % interval, from the part that the model was chosen by; after `fit`.

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
        self.kind, self.rate_hz, self.seed = kind, float(rate_hz), seed
        self.history_s, self.spacing_s, self.ahead_s = history_s, spacing_s, ahead_s
        self._model: SensingModel | None = None

    def fit(self, x: Trials, y: Trials) -> Reconstructor:
        """Fit the model to one trial, or to several.

        The last 15 % of each trial choose penalties, epochs and the interval; a gap of one window and 0.3 s keeps them
        apart from the rest. Filter `x` and `y` before, and hold your test data out before you call this.

        Parameters
        ----------
        x : array_like (time, sensor), DataFrame, Recording, or a sequence of them
            Readings; a DataFrame or a Recording names them, and `predict` then finds them by name.
        y : array_like (time, state), or a sequence of them
            States at the same times.

        Returns
        -------
        Reconstructor
            Itself.

        Raises
        ------
        ShapeError
            If the arrays do not fit together.
        SamplingError
            If a trial is shorter than a window.
        TrainingError
            If too few windows are left, or a state does not vary.
        """
        many = isinstance(x, list | tuple) and np.ndim(x[0]) > 1
        readings, states = (list(x), list(y)) if many else ([x], [y])  # type: ignore[arg-type]
        if len(readings) != len(states):
            raise ShapeError(
                "a model is fitted to as many trials of states as of readings",
                f"found {len(readings)} of readings, {len(states)} of states",
                "Give one array of states for each array of readings.",
            )
        sensors, targets = _names(readings[0], "sensor"), _names(states[0], "state")
        both = [name for name in targets if name in sensors]
        if both:
            raise ShapeError(
                "a state is none of the sensors",
                f"{both[0]!r} is in both",
                "Leave it out of the states: it is measured.",
            )
        lags = Lags(
            max(1, round(self.history_s / self.spacing_s) + 1) if self.history_s else 1,
            max(1, round(self.spacing_s * self.rate_hz)),
            round(self.ahead_s * self.rate_hz),
        )
        what = Sensing(sensors, targets, lags, self.rate_hz)
        channels = tuple(Channel(name, "signal", "1") for name in (*sensors, *targets))
        windows = [self._windows(one, other, what) for one, other in zip(readings, states, strict=True)]
        parts = [each.last_block(CHECKED, what.reach_s + SEAM_S) for each in windows]
        training, check = (stacked([part[k] for part in parts]) for k in (0, 1))
        done = fit_reconstructor(self.kind, what, training, check, self.seed)
        self._model = SensingModel(done, channels, half_widths(done(check) - check.y))
        return self

    def predict(self, x: ArrayLike) -> NDArray[np.float64]:
        """Estimate the states of one trial.

        Parameters
        ----------
        x : array_like (time, sensor)
            Readings at `rate_hz`, with the sensors of `fit` in their order.

        Returns
        -------
        ndarray (time, state)
            At the times of `x`; a forecast of a time rests on readings that end `ahead_s` before it. NaN where the
            history is not full or a reading is missing.

        Raises
        ------
        TrainingError
            If the model was not fitted.
        ShapeError
            If there are more or fewer sensors than at `fit`.
        """
        model = self.model
        return np.array(model(self._recording(x, model.reconstructor.sensing.sensors)).values)

    def score(self, x: ArrayLike, y: ArrayLike) -> float:
        """R2 of the estimates, the mean over states, where there are any.

        Parameters
        ----------
        x : array_like (time, sensor), DataFrame or Recording
            Readings.
        y : array_like (time, state)
            Measured states at the same times.
        """
        estimated, measured = self.predict(x), _array(y, "states")
        known = np.isfinite(estimated).all(axis=1) & np.isfinite(measured).all(axis=1)
        return float(np.mean(r2(measured[known], estimated[known])))

    def windows(self, x: ArrayLike, percent: ArrayLike) -> Samples:
        """Windows of readings, as the fitted model takes them.

        Parameters
        ----------
        x : array_like (time, sensor)
            Readings at `rate_hz`.
        percent : array_like (time,) [% stride]
            Percent stride of these times.

        Returns
        -------
        Samples
            Without states; percent stride at the last reading of each window.
        """
        what = self.model.reconstructor.sensing
        read = self._recording(x, what.sensors)
        return windows_of(read, what.sensors, (), what.lags, np.asarray(percent, float))

    @property
    def model(self) -> SensingModel:
        """What was fitted; takes a Recording as well."""
        if self._model is None:
            raise TrainingError("a model is fitted before it estimates", "fit was not called", "Call fit(x, y) first.")
        return self._model

    @property
    def half_widths(self) -> NDArray[np.float64]:
        """Half width of the 90 % interval of each state (state,), in its unit."""
        return self.model.half_widths

    def __repr__(self) -> str:
        fitted = "not fitted"
        if self._model is not None:
            what = self._model.reconstructor.sensing
            windows = self._model.reconstructor.n_fitted
            fitted = f"{len(what.sensors)} sensors to {len(what.states)} states, fitted to {windows} windows"
        return f"Reconstructor({self.kind!r}, {self.rate_hz:g} Hz, {self.history_s:g} s of history: {fitted})"

    def _recording(self, x: Any, sensors: tuple[str, ...]) -> Recording:
        if isinstance(x, Recording) and abs(x.rate_hz - self.rate_hz) > 1e-3 * self.rate_hz:
            raise SamplingError(
                f"the model reads {self.rate_hz:g} samples a second",
                f"the recording has {x.rate_hz:g}",
                "Resample it, or give its rate: Reconstructor(rate_hz=...).",
            )
        values = _array(_in_order(x, sensors), "readings")
        if values.shape[1] != len(sensors):
            raise ShapeError(
                f"the model reads {len(sensors)} sensors",
                f"found {values.shape[1]} columns",
                "Give the sensors of fit, in their order.",
            )
        time = np.arange(len(values)) / self.rate_hz
        return Recording(time, values, tuple(Channel(name, "signal", "1") for name in sensors))

    def _windows(self, x: Any, y: Any, what: Sensing) -> Samples:
        read, states = self._recording(x, what.sensors), _array(y, "states")
        if states.shape != (len(read.time), len(what.states)):
            raise ShapeError(
                f"every reading has its row of {len(what.states)} states",
                f"found readings {read.values.shape} and states {states.shape}, (time, column)",
                "Give one row a time in both.",
            )
        both = Recording(
            read.time,
            np.hstack([read.values, states]),
            (*read.channels, *(Channel(name, "signal", "1") for name in what.states)),
        )
        return windows_of(both, what.sensors, what.states, what.lags, np.zeros(len(read.time)))


def save_reconstructor(fitted: Reconstructor, folder: Path) -> None:
    """Save the fitted model."""
    save_model(fitted.model, folder)


def load_reconstructor(folder: Path) -> Reconstructor:
    """Load a reconstructor.

    folder: that `Reconstructor.save` or `gaitdisc reconstruct` wrote
    raises SchemaError if a file is missing, damaged, or of another version
    """
    model = load_model(folder)
    what = model.reconstructor.sensing
    lags, rate = what.lags, what.rate_hz
    done = Reconstructor(model.reconstructor.kind, rate, lags.reach / rate, lags.spacing / rate, lags.ahead / rate)
    done._model = model
    return done


def _array(given: Any, words: str) -> NDArray[np.float64]:
    values = np.asarray(given.values if isinstance(given, Recording) else given, float)
    if values.ndim != 2:
        raise ShapeError(
            f"{words} are an array (time, column)",
            f"found {values.shape}",
            "Put time first, one column a sensor or state: x[:, None] for one of them.",
        )
    return values


def _named(given: Any) -> tuple[str, ...]:
    """Names of the columns of a table or a recording; none of an array."""
    if isinstance(given, Recording):
        return given.names
    return tuple(str(name) for name in getattr(given, "columns", ()))


def _names(given: Any, word: str) -> tuple[str, ...]:
    return _named(given) or tuple(f"{word}_{n}" for n in range(1, _array(given, f"{word}s").shape[1] + 1))


def _in_order(given: Any, sensors: tuple[str, ...]) -> Any:
    """Columns of the sensors by name, where both have names; else as given."""
    names = _named(given)
    if not names or all(name == f"sensor_{n}" for n, name in enumerate(sensors, 1)):
        return given
    absent = [name for name in sensors if name not in names]
    if absent:
        raise ShapeError(
            f"the model reads {', '.join(sensors)}",
            f"{absent[0]!r} is not among {', '.join(names[:8])}",
            "Name the columns as in fit, or give an array in the order of fit.",
        )
    return _array(given, "readings")[:, [names.index(name) for name in sensors]]
