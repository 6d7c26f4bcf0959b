"""States reconstructed live: one reading of the sensors after the other."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gaitdisc.errors import ShapeError
from gaitdisc.recording.arrays import real_array
from gaitdisc.sensing.missing import refuse_unknown_way
from gaitdisc.sensing.reconstructor import ENSEMBLE, MASKED, OF_TEXT, STATIC, Reconstructor

if TYPE_CHECKING:
    from gaitdisc.networks.carried_windows import CarriedWindows


class Stream:
    """Reconstructs the states each time a new reading comes; the same numbers as over a recording.

    A recurrent network carries the states of the windows under way from one reading to the next
    (`gaitdisc.networks.carried_windows`); every other model reads the last readings, which are kept.

    missing: a word of `gaitdisc.sensing.missing.WAYS`: what stands for a reading that is missing, unless the model is
        a masked one
    """

    def __init__(self, reconstructor: Reconstructor, missing: str = "none") -> None:
        refuse_unknown_way(missing)
        self._sensors = reconstructor.sensing.sensors
        self._model = _stepwise(reconstructor)
        self._missing = missing
        self._stands = reconstructor.sensor_means

    def update(self, reading: ArrayLike) -> NDArray[np.float64]:
        """States at the time of a new reading, (state,) [each state's unit].

        NaN until the history is full, and while it holds a missing reading that the model needs: unless the stream was
        given what to put in its place, a value that was never measured is not made up.

        reading array_like (sensor,) [each sensor's unit]: in the order of the sensors; NaN where a sensor dropped out.
            One call a sample, at the model's rate
        """
        new = real_array(reading)
        if new.shape != (len(self._sensors),):
            raise ShapeError(
                f"a reading needs one value for each of {', '.join(self._sensors)}",
                f"found an array of shape {new.shape}",
                "Give them in this order, NaN where a sensor dropped out.",
            )
        if self._missing != "none":
            new = np.where(np.isfinite(new), new, self._stands)
        if self._missing == "last":
            self._stands = new
        return self._model.update(new)


class _LastReadings:
    """The last readings, and what a model reconstructs from them."""

    def __init__(self, reconstructor: Reconstructor) -> None:
        what = reconstructor.sensing
        lags = what.lags.static() if reconstructor.kind in STATIC else what.lags
        self._model = reconstructor.model
        self._readings = np.full((lags.reach + 1, len(what.sensors)), np.nan)
        self._rows = np.arange(lags.count) * lags.spacing

    def update(self, reading: NDArray[np.float64]) -> NDArray[np.float64]:
        self._readings[:-1] = self._readings[1:]
        self._readings[-1] = reading
        return self._model(self._readings[self._rows].reshape(1, -1))[0]


class _Mean:
    """Mean of what several carried networks reconstruct."""

    def __init__(self, members: Sequence[CarriedWindows]) -> None:
        self._members = members

    def update(self, reading: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.mean([member.update(reading) for member in self._members], axis=0)


def _stepwise(reconstructor: Reconstructor) -> _LastReadings | _Mean | CarriedWindows:
    if reconstructor.kind not in ("shred", MASKED, ENSEMBLE, OF_TEXT):
        return _LastReadings(reconstructor)
    from gaitdisc.networks.carried_windows import CarriedWindows
    from gaitdisc.networks.trained_network import Ensemble, TrainedNetwork

    lags, model = reconstructor.sensing.lags, reconstructor.model
    if isinstance(model, Ensemble):
        return _Mean([CarriedWindows(member, lags.count, lags.spacing) for member in model.members])
    if isinstance(model, TrainedNetwork):
        return CarriedWindows(model, lags.count, lags.spacing)
    return _LastReadings(reconstructor)  # corrected for a person by what the windows hold
