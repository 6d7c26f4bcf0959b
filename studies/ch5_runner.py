"""A minute of one runner in windows, and the error of what is estimated."""

from __future__ import annotations

import numpy as np
from ch5_gait import DATA, SENSORS, exotendon, first_person
from numpy.typing import NDArray
from real_people import ANGLES

import gaitdisc as gd
from gaitdisc.batch.sensed_walks import SensedWalk, sensed_walks
from gaitdisc.sensing.reconstructor import Sensing
from gaitdisc.sensing.splits import Parts, split_within
from gaitdisc.sensing.windows import Lags

SAGITTAL = SENSORS["3 sagittal"]
TOLD = tuple(name for name in ANGLES if name not in SAGITTAL)  # of the angles that every real person has
LAGS = Lags(25, 4)
Values = NDArray[np.float64]


def runner() -> tuple[SensedWalk, tuple[gd.Channel, ...]]:
    """A minute of one runner, and the states that no sagittal sensor measures and that are angles."""
    walks = sensed_walks(first_person(exotendon(DATA)), SAGITTAL, "natural")
    angles = [channel for channel in walks.channels if channel.unit == "deg" and channel.name not in SAGITTAL]
    return next(iter(walks.people.values()))[0], tuple(angles)


def parts_of(walk: SensedWalk, angles: tuple[gd.Channel, ...], lags: Lags) -> tuple[Sensing, Parts]:
    """Fitted, checked and tested windows, in time."""
    what = Sensing(SAGITTAL, tuple(channel.name for channel in angles), lags, walk.recording.rate_hz)
    return what, split_within([what.windows(walk.recording, walk.phi)], "temporal", what.reach_s)


def rmse(missed: Values) -> float:
    """Over windows and angles [deg]."""
    return float(np.sqrt(np.mean(missed**2)))
