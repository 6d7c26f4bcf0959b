"""Error against noise of the sensors and against missing readings, for every kind of model."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from gaitdisc import Channel, Recording, Samples
from gaitdisc.sensing.missing import filled, with_missing
from gaitdisc.sensing.reconstructor import KINDS, MASKED, Reconstructor, Sensing, fit_reconstructor
from gaitdisc.sensing.splits import Parts, split_within
from gaitdisc.sensing.state_errors import angle_columns

NOISES = (0.0, 0.01, 0.02, 0.05, 0.10)
SHARES = (0.0, 0.1, 0.2, 0.3, 0.4, 0.5)
DISTURBED = ("disturbance", "level", "model", "rmse_deg")
Walks = Sequence[tuple[Recording, NDArray[np.float64]]]


def noisy(recording: Recording, sensors: Sequence[str], share: float, seed: int = 0) -> Recording:
    """Add white noise to the readings of the sensors, and to nothing else.

    share: standard deviation of the noise, by that of the sensor in this trial

    >>> from gaitdisc.channel import Channel
    >>> time = np.arange(4000) / 100
    >>> walk = Recording(time, np.sin(time)[:, None], (Channel("a", "signal", "V"),))
    >>> more = noisy(walk, ["a"], 0.1).values - walk.values
    >>> round(float(more.std() / walk.values.std()), 2)
    0.1
    """
    rng = np.random.default_rng(seed)
    values = recording.values.copy()
    for name in sensors:
        column = recording.index(name)
        values[:, column] += share * np.nanstd(values[:, column]) * rng.standard_normal(len(values))
    return recording.with_values(values)


def against_noise(
    walks: Walks, what: Sensing, channels: Sequence[Channel], kinds: Sequence[str] = tuple(KINDS), seed: int = 0
) -> pd.DataFrame:
    """RMSE of every kind of model against noise, temporal split; fitted to and tested on the same noise.

    walks sequence of (Recording, (time,) [% stride]): of one person
    returns: disturbance (`noise`), level [share of the sensor's standard deviation], model, rmse_deg (angles)
    """
    rows = []
    for level in NOISES:
        parts = _parts(walks, what, lambda walk, k, level=level: noisy(walk, what.sensors, level, seed + k))
        for kind in kinds:
            done = fit_reconstructor(kind, what, parts.fitted(), parts.checked(), seed)
            rows.append(("noise", level, kind, _rmse(done, parts.tested(), channels)))
    return pd.DataFrame(rows, columns=pd.Index(DISTURBED))


def against_missing(
    walks: Walks,
    what: Sensing,
    channels: Sequence[Channel],
    kinds: Sequence[str] = (*KINDS, MASKED),
    seed: int = 0,
) -> pd.DataFrame:
    """RMSE of every kind of model against missing readings, temporal split; fitted to walks that lack none.

    Readings are lost one by one, each sensor by itself. The sensor's last known reading stands in their place; the
    masked SHRED alone is given which are missing.

    walks sequence of (Recording, (time,) [% stride]): of one person
    returns: disturbance (`missing`), level [share of the readings], model, rmse_deg (angles)
    """
    parts = _parts(walks, what, lambda walk, _: walk)
    fitted = {kind: fit_reconstructor(kind, what, parts.fitted(), parts.checked(), seed) for kind in kinds}
    rows = []
    for level in SHARES:
        for kind, done in fitted.items():

            def lost(walk: Recording, k: int, done: Reconstructor = done, level: float = level) -> Recording:
                holed = with_missing(walk, what.sensors, level, 0.0, seed + k)
                return holed if done.kind == MASKED else filled(holed, what.sensors, "last", done.sensor_means)

            test = _parts(walks, what, lost).tested()
            rows.append(("missing", level, kind, _rmse(done, test, channels)))
    return pd.DataFrame(rows, columns=pd.Index(DISTURBED))


def _parts(walks: Walks, what: Sensing, disturbed: Callable[[Recording, int], Recording]) -> Parts:
    windows = [what.windows(disturbed(walk, k), phi, missing=True) for k, (walk, phi) in enumerate(walks)]
    return split_within(windows, "temporal", what.reach_s)


def _rmse(done: Reconstructor, test: Samples, channels: Sequence[Channel]) -> float:
    return float(np.sqrt(np.mean((done(test) - test.y)[:, angle_columns(channels)] ** 2)))
