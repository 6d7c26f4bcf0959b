"""A fitted reconstructor on disk: what it reads and gives, its weights; and states live, reading after reading."""

from __future__ import annotations

import json
import zipfile
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from gaitdisc.channel import Channel
from gaitdisc.errors import SamplingError, SchemaError, ShapeError, UnitError
from gaitdisc.models.fourier_ridge import FourierRidge
from gaitdisc.reconstruction.calibration import Corrected
from gaitdisc.reconstruction.window_model import (
    ENSEMBLE,
    KINDS,
    MASKED,
    MEMBERS,
    OF_TEXT,
    ON_REQUEST,
    STATIC,
    WITHOUT_NETWORK,
    Ensemble,
    Sensing,
    WindowModel,
    make_network,
)
from gaitdisc.reconstruction.windows import Lags, cut_windows, fill_readings, refuse_unknown_way
from gaitdisc.recording import Recording, Scale
from gaitdisc.recording.arrays import Values, real_array
from gaitdisc.saved.unit_folder import DamagedError, check_files, file_sha256, read_sealed, seal_text
from gaitdisc.whole_file import find_written, whole_file, write_together, write_whole

if TYPE_CHECKING:
    from gaitdisc.models.carried_windows import CarriedWindows

NAME, WEIGHTS = "model.json", "weights.npz"
RIDGE = ("frequencies", "phases", "weights", "offset")  # arrays of a ridge regression
FORMAT = 1
RATE_TOLERANCE = 1e-3


@dataclass(frozen=True, eq=False)
class SensingModel:
    """A reconstructor with the channels it was fitted to."""

    reconstructor: WindowModel
    channels: tuple[Channel, ...]  # of the sensors, then of the states
    # (state,) [each state's unit], half width of the 90 % interval, from the windows that the model was chosen by
    half_widths: Values

    def __call__(self, recording: Recording, missing: str = "none") -> Recording:
        """States of a new recording that has the sensors, in their units and at the model's rate.

        NaN where the history is not full, or holds a missing value; `missing`, a word of
        `gaitdisc.reconstruction.windows.WAYS`, may say what stands for it, and a masked model needs nothing.
        The recording has to be filtered as those were that the model was fitted to.
        """
        what = self.reconstructor.sensing
        if abs(recording.rate_hz / what.rate_hz - 1) > RATE_TOLERANCE:
            raise SamplingError(
                f"the sensors must have the rate of the model, {what.rate_hz:g} Hz",
                f"{recording.source.file or 'the recording'} has {recording.rate_hz:g} Hz",
                "Resample the recording to this rate.",
            )
        for channel in self.channels[: len(what.sensors)]:
            recorded = recording.channels[recording.index(channel.name)]
            if recorded.unit != channel.unit:
                raise UnitError(
                    f"{channel.name} must be in {channel.unit}, the unit of the model",
                    f"{recording.source.file or 'the recording'} has it in {recorded.unit}",
                    "State the unit in the study's [channels].",
                )
        read = fill_readings(recording.selected(what.sensors), what.sensors, missing, self.reconstructor.sensor_means)
        windows = cut_windows(
            read, what.sensors, (), what.lags, np.zeros(len(read.time)), self.reconstructor.kind == MASKED
        )
        rows = np.searchsorted(recording.time, windows.time - 1e-9)
        values = np.full((len(recording.time), len(what.states)), np.nan)
        values[rows] = self.reconstructor(windows)
        states = self.channels[len(what.sensors) :]
        return Recording(recording.time, values, states, recording.subject, recording.condition, recording.source)


@write_together()
def save_model(model: SensingModel, folder: Path) -> None:
    """Save a model: `weights.npz`, and `model.json` with the hashes of both."""
    done = model.reconstructor
    places = _places(done.kind, folder)
    members = done.model.members if isinstance(done.model, Ensemble) else (done.model,)
    for member, place in zip(members, places, strict=True):
        save_weights(member, place)
    data = {
        "format": FORMAT,
        "kind": done.kind,
        "sensing": asdict(done.sensing),
        "channels": [asdict(channel) for channel in model.channels],
        "half_widths": model.half_widths.tolist(),
        "n_fitted": done.n_fitted,
        "seconds": done.seconds,
        "device": done.device,
        "sha256": {path.name: file_sha256(find_written(path)) for path in places},
    }
    write_whole(folder / NAME, seal_text(data))


def load_model(folder: Path) -> SensingModel:
    """Load a model that `save_model` wrote."""
    try:
        data = read_sealed(folder / NAME)
        if data["format"] != FORMAT:
            raise ValueError(f"it has format {data['format']}, but this version reads {FORMAT}")
        check_files(folder, data["sha256"])
        held = data["sensing"]
        what = Sensing(tuple(held["sensors"]), tuple(held["states"]), Lags(**held["lags"]), held["rate_hz"])
        channels: Sequence[Channel] = [Channel(**channel) for channel in data["channels"]]
        half, kind = np.array(data["half_widths"], float), data["kind"]
        numbers = data["n_fitted"], data["seconds"], data["device"]
        if kind not in (*KINDS, *ON_REQUEST):
            raise ValueError(f"its kind {kind!r} is unknown to this version")
        if tuple(channel.name for channel in channels) != (*what.sensors, *what.states):
            raise ValueError("its channels differ from its sensors and states")
        if half.shape != (len(what.states),):
            raise ValueError(f"it has {half.size} interval half-widths for {len(what.states)} states")
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        fault = error.found if isinstance(error, DamagedError) else str(error)
        raise SchemaError(
            f"{folder.name}/{NAME} must be a model saved by gaitdisc",
            f"it lacks {error}" if isinstance(error, KeyError) else fault,
            "Run `gaitdisc reconstruct` again.",
        ) from error
    build = None if kind in WITHOUT_NETWORK else make_network(kind, len(what.sensors))
    members = tuple(load_weights(path, build) for path in _places(kind, folder))
    weights = Ensemble(members) if kind == ENSEMBLE else members[0]
    readings = 1 if kind in STATIC else what.lags.count
    if weights.outputs != what.states or len(weights.inputs) != readings * len(what.sensors):
        raise SchemaError(
            f"{folder.name}/{WEIGHTS} must match {folder.name}/{NAME}",
            f"the weights use {len(weights.inputs)} numbers and estimate {', '.join(weights.outputs[:3])}; the model "
            f"file states {readings * len(what.sensors)} numbers and {', '.join(what.states[:3])}",
            "Both files must come from one model. Copy them together, or run `gaitdisc reconstruct` again.",
        )
    return SensingModel(WindowModel(kind, what, weights, *numbers), tuple(channels), half)


def _places(kind: str, folder: Path) -> list[Path]:
    """Where the weights of a kind lie: in one file, of an ensemble in one for each member."""
    if kind != ENSEMBLE:
        return [folder / WEIGHTS]
    return [folder / f"weights_{number}.npz" for number in range(1, MEMBERS + 1)]


def save_weights(model: Any, path: Path) -> None:
    """Save a `FourierRidge` or a `TrainedNetwork` as `.npz`; what is loaded again equals it to the last bit."""
    names = {"format": FORMAT, "inputs": model.inputs, "outputs": model.outputs}
    if isinstance(model, FourierRidge):
        names["penalty"] = model.penalty
        arrays = {name: getattr(model, name) for name in RIDGE}
        arrays |= {"x_mean": model.x_scale.mean, "x_sd": model.x_scale.sd}
        arrays |= {"y_mean": model.y_scale.mean, "y_sd": model.y_scale.sd}
    else:
        arrays = model.arrays()
    with whole_file(path) as part, part.open("wb") as file:
        np.savez(file, names=np.array(json.dumps(names)), **arrays)


def load_weights(path: Path, build: Callable[[int, int], Any] | None = None) -> Any:
    """Load what `save_weights` wrote: a network where `build` makes one of its numbers of inputs and outputs."""
    what = "a trained network" if build else "a ridge regression"
    try:
        with np.load(path, allow_pickle=False) as file:
            arrays = {name: file[name] for name in file.files}
        names = json.loads(str(arrays["names"]))
        if names["format"] != FORMAT:
            raise ValueError(f"it has format {names['format']}, but this version reads {FORMAT}")
        named = tuple(names["inputs"]), tuple(names["outputs"])
        if build is None:
            scales = Scale(arrays["x_mean"], arrays["x_sd"]), Scale(arrays["y_mean"], arrays["y_sd"])
            return FourierRidge(*named, *scales, **{name: arrays[name] for name in RIDGE}, penalty=names["penalty"])
        from gaitdisc.models.trained_network import restore_network

        return restore_network(*named, arrays, build(*map(len, named)))
    except (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile) as error:
        raise SchemaError(
            f"{path.name} must be {what} saved by gaitdisc",
            str(error),
            "Load it as the kind of network that was saved, or train it again." if build else "Fit the model again.",
        ) from error


class Stream:
    """Reconstructs the states at each new reading, with the same numbers as over a recording.

    A recurrent network carries the windows under way along (`gaitdisc.models.carried_windows`), others keep readings.
    missing: a word of `gaitdisc.reconstruction.windows.WAYS` for a missing reading, unless the model is a masked one
    """

    def __init__(self, reconstructor: WindowModel, missing: str = "none") -> None:
        refuse_unknown_way(missing)
        self._sensors = reconstructor.sensing.sensors
        self._members = _stepwise(reconstructor)
        self._missing = missing
        self._stands = reconstructor.sensor_means

    def update(self, reading: ArrayLike) -> Values:
        """States at the time of a new reading, (state,) [each state's unit].

        NaN until the history is full, and while it holds a missing reading that the model needs: unless the stream was
        given what to put in its place, a value that was never measured is not made up.

        reading array_like (sensor,) [each sensor's unit]: in the order of the sensors; NaN where a sensor dropped out.
            One call a sample, at the model's rate
        """
        new = real_array(reading)
        if new.shape != (len(self._sensors),):
            raise ShapeError(
                f"a sample must have one value for each of {', '.join(self._sensors)}",
                f"the array has shape {new.shape}",
                "Give the values in this order, with NaN for a missing sensor.",
            )
        if self._missing != "none":
            new = np.where(np.isfinite(new), new, self._stands)
        if self._missing == "last":
            self._stands = new
        return np.mean([member.update(new) for member in self._members], axis=0)


class _LastReadings:
    """The last readings, and what a model reconstructs from them."""

    def __init__(self, reconstructor: WindowModel) -> None:
        what = reconstructor.sensing
        lags = Lags(1, 1) if reconstructor.kind in STATIC else what.lags
        self._model = reconstructor.model
        self._readings = np.full((lags.reach + 1, len(what.sensors)), np.nan)
        self._rows = np.arange(lags.count) * lags.spacing

    def update(self, reading: Values) -> Values:
        self._readings[:-1] = self._readings[1:]
        self._readings[-1] = reading
        return self._model(self._readings[self._rows].reshape(1, -1))[0]


def _stepwise(reconstructor: WindowModel) -> list[CarriedWindows] | list[_LastReadings]:
    """What reads along; the mean of what it reconstructs is that of the model."""
    lags, model = reconstructor.sensing.lags, reconstructor.model
    if reconstructor.kind in ("shred", MASKED, ENSEMBLE, OF_TEXT) and not isinstance(model, Corrected):
        from gaitdisc.models.carried_windows import CarriedWindows

        members: Any = model.members if isinstance(model, Ensemble) else (model,)
        return [CarriedWindows(member, lags.count, lags.spacing) for member in members]
    return [_LastReadings(reconstructor)]  # a corrected model needs what the windows hold
