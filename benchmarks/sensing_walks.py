"""Windows of real and of simulated walks, for the benchmarks of reconstruction."""

from __future__ import annotations

import os
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from gaitdisc.batch.demonstration import write_demonstration
from gaitdisc.batch.sensed_walks import SensedWalks, sensed_walks
from gaitdisc.channel import Channel, vocabulary
from gaitdisc.ingest.storage import write_storage
from gaitdisc.ingest.study import Conditions, Participant, PlannedTrial, Study
from gaitdisc.recording import Recording
from gaitdisc.sensing.reconstructor import Sensing, sensing
from gaitdisc.sensing.windows import Lags

SENSORS = ("hip_flexion_r", "knee_angle_r", "ankle_angle_r")
LAGS = Lags(25, 4)
TRIALS = range(504, 516)
DATA = Path(os.environ.get("GAITDISC_DATA", Path(__file__).parents[2] / "shared" / "data"))


@dataclass(frozen=True, eq=False)
class Person:
    """Walks of one person, with what is read and told."""

    name: str
    walks: SensedWalks
    what: Sensing

    @property
    def channels(self) -> tuple[Channel, ...]:
        """Of the sensors, then of the states."""
        by_name = {channel.name: channel for channel in self.walks.channels}
        return tuple(by_name[name] for name in (*self.what.sensors, *self.what.states))


def treadmill_walks(sensors: tuple[str, ...] = SENSORS, lags: Lags = LAGS) -> list[Person]:
    """The person of treadmill_walk_ik, twelve walks of 21 s."""
    with tempfile.TemporaryDirectory() as name:
        return _people(_treadmill_study(Path(name)), sensors, lags)


def cohort_walks(
    people: int = 12, duration_s: float = 60.0, sensors: tuple[str, ...] = SENSORS, lags: Lags = LAGS
) -> list[Person]:
    """Nominal walks of the embedded cohort."""
    with tempfile.TemporaryDirectory() as name:
        return _people(write_demonstration(Path(name), duration_s, people), sensors, lags, "nominal")


def _people(study: Study, sensors: tuple[str, ...], lags: Lags, condition: str = "") -> list[Person]:
    walks = sensed_walks(study, sensors, condition)
    what = sensing(tuple(channel.name for channel in walks.channels), sensors, lags, walks.rate_hz)
    return [Person(name, walks, what) for name in walks.people]


def _treadmill_study(folder: Path) -> Study:
    with np.load(DATA / "gait" / "treadmill_walk_ik" / "addbio_expert3_ik.npz") as packed:
        names = [str(name) for name in packed["columns"]]
        known = [(k, vocabulary().named(name)) for k, name in enumerate(names)]
        kept = [(k, channel) for k, channel in known if channel is not None]
        for number in TRIALS:
            values = np.array(packed[f"S01DE{number}"], float)[:, [k for k, _ in kept]]
            channels = tuple(channel for _, channel in kept)
            write_storage(Recording(np.arange(len(values)) / 100, values, channels), folder / f"{number}.mot")
    trials = tuple(PlannedTrial(condition="walk", files=(f"{number}.mot",)) for number in TRIALS)
    one = Conditions(nominal="walk", device="none")
    study = Study(conditions=one, participants=(Participant(id="S01", trials=trials),))
    return study.model_copy(update={"quality": study.quality.model_copy(update={"late_change": "report"})}).placed(
        folder
    )
