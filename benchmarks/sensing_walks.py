"""Windows of real and of simulated walks, for the benchmarks of reconstruction."""

from __future__ import annotations

import os
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

from gaitdisc.channel import Channel
from gaitdisc.cohort.demonstration import write_demonstration
from gaitdisc.ingest.study import Study
from gaitdisc.reconstruction.sensed_walks import SensedWalks, read_walks
from gaitdisc.reconstruction.state_errors import angle_columns
from gaitdisc.reconstruction.window_model import Sensing, sensing
from gaitdisc.reconstruction.windows import Lags, Parts, split_within
from gaitdisc.recording import Samples

sys.path.insert(0, str(Path(__file__).parents[1] / "studies"))
from chapter5.gait import treadmill

SENSORS = ("hip_flexion_r", "knee_angle_r", "ankle_angle_r")
LAGS = Lags(25, 4)
DATA = Path(os.environ.get("GAITDISC_DATA", Path(__file__).parents[2] / "shared" / "data"))


@dataclass(frozen=True, eq=False)
class Person:
    """Walks of one person, with what is read and reconstructed."""

    name: str
    walks: SensedWalks
    what: Sensing

    @property
    def channels(self) -> tuple[Channel, ...]:
        """Of the sensors, then of the states."""
        return self.walks.named((*self.what.sensors, *self.what.states))

    @property
    def angles(self) -> list[int]:
        """Columns of the states that are angles."""
        return angle_columns(self.walks.named(self.what.states))

    def windows(self) -> list[Samples]:
        """Windows of each walk."""
        return [self.what.windows(walk.recording, walk.phi) for walk in self.walks.people[self.name]]

    def parts(self) -> Parts:
        """Windows of all walks, parted in time."""
        return split_within(self.windows(), "temporal", self.what.reach_s)


def chosen_walks(word: str, people: int) -> list[Person]:
    """Those of `treadmill`, or so many people of the `cohort`."""
    return treadmill_walks() if word == "treadmill" else cohort_walks(people)


def treadmill_walks() -> list[Person]:
    """The person of treadmill_walk_ik, twelve walks of 21 s."""
    with tempfile.TemporaryDirectory() as name:
        return _people(treadmill(DATA / "gait", Path(name)), LAGS)


def cohort_walks(people: int = 12, lags: Lags = LAGS) -> list[Person]:
    """Nominal walks of the embedded cohort."""
    with tempfile.TemporaryDirectory() as name:
        return _people(write_demonstration(Path(name), 60.0, people), lags, "nominal")


def _people(study: Study, lags: Lags, condition: str = "") -> list[Person]:
    walks = read_walks(study, SENSORS, condition)
    what = sensing(tuple(channel.name for channel in walks.channels), SENSORS, lags, walks.rate_hz)
    return [Person(name, walks, what) for name in walks.people]
