"""States told live: one reading of the sensors after the other."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gaitdisc.errors import ShapeError
from gaitdisc.recording import Samples
from gaitdisc.sensing.reconstructor import Reconstructor


class Stream:
    """Keeps the last readings, and tells the states each time a new one comes; the same numbers as over a recording.

    Parameters
    ----------
    reconstructor : Reconstructor
        What tells the states.

    Examples
    --------
    >>> stream = Stream(reconstructor)  # doctest: +SKIP
    >>> stream.update([12.1, 30.4, -3.3])  # doctest: +SKIP
    array([...])
    """

    def __init__(self, reconstructor: Reconstructor) -> None:
        self._reconstructor = reconstructor
        what = reconstructor.sensing
        self._readings = np.full((what.lags.reach + 1, len(what.sensors)), np.nan)
        self._rows = np.arange(what.lags.count) * what.lags.spacing
        first = np.zeros(1)
        names = tuple(f"{k}" for k in range(what.lags.count * len(what.sensors)))
        self._frame = (names, np.zeros((1, len(what.states))), first)

    def update(self, reading: ArrayLike) -> NDArray[np.float64]:
        """States at the time of a new reading, (state,) [each state's unit].

        NaN until the history is full, and while it holds a missing reading that the model needs: a value that was
        never measured is not made up.

        Parameters
        ----------
        reading : array_like (sensor,) [each sensor's unit]
            In the order of the sensors; NaN where a sensor dropped out. One call a sample, at the model's rate.

        Raises
        ------
        ShapeError
            If there are not as many values as sensors.
        """
        new = np.asarray(reading, float)
        what = self._reconstructor.sensing
        if new.shape != (len(what.sensors),):
            raise ShapeError(
                f"a reading needs one value for each of {', '.join(what.sensors)}",
                f"found an array of shape {new.shape}",
                "Give them in this order, NaN where a sensor dropped out.",
            )
        self._readings[:-1] = self._readings[1:]
        self._readings[-1] = new
        names, states, time = self._frame
        window = self._readings[self._rows].reshape(1, -1)
        return self._reconstructor(Samples(window, states, names, what.states, time, time))[0]
