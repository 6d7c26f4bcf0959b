"""Muscles and ground forces reconstructed from movement: on the embedded cohort, and on one real walk of 8.7 s.

    python benchmarks/targets.py [--people 12] [--networks]

Cohort: nominal walks of 60 s, hip, knee and ankle angle of the right leg, 1 s of history. The real walk
(treadmill_c3d_emg: markers, 16 EMG electrodes without muscle names, two belts): height and fore-aft place of both heels
and toes, 0.24 s of history, since its checked and test parts last 0.9 s and 1.7 s before the gaps are taken off.
"""

from __future__ import annotations

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "studies"))
from command_line import argument, command_line

GIVEN = command_line(
    __name__,
    __doc__,
    argument("--people", "the first so many of the cohort", 12),
    argument("--networks", "networks as well as ridge regressions", False),
)  # before the slow imports

import os
import tempfile

os.environ.setdefault("OMP_NUM_THREADS", "1")

from sensing_walks import DATA, SENSORS

from gaitdisc.cohort.demonstration import write_demonstration
from gaitdisc.ingest.study import Conditions, Participant, PlannedTrial, Study
from gaitdisc.reconstruction.page import reconstruction_sentences
from gaitdisc.reconstruction.reconstruct_study import ReconstructionSettings, reconstruct_study
from gaitdisc.reconstruction.window_model import KINDS

RIDGES = ("linear", "delay ridge", "fourier ridge")
MARKERS = tuple(f"{side}{place}.{axis}" for side in "RL" for place in ("CAL", "MT1") for axis in "yz")


def main() -> None:
    kinds = tuple(KINDS) if GIVEN.networks else RIDGES
    with tempfile.TemporaryDirectory() as name:
        study = write_demonstration(Path(name), 60.0, GIVEN.people)
        for targets in ("emg", "forces"):
            settings = ReconstructionSettings(kinds=kinds, condition="nominal", targets=targets)
            measure("cohort", study, SENSORS, settings)
    walk = PlannedTrial(condition="walk", files=(str(DATA / "gait" / "treadmill_c3d_emg" / "walking_1.c3d"),))
    study = Study(
        conditions=Conditions(nominal="walk", device="none"), participants=(Participant(id="P01", trials=(walk,)),)
    )
    for targets in ("emg", "forces"):
        settings = ReconstructionSettings(history_s=0.24, kinds=kinds, targets=targets)
        measure("treadmill_c3d_emg", study, MARKERS, settings)


def measure(name: str, study: Study, sensors: tuple[str, ...], settings: ReconstructionSettings) -> None:
    """Print what is found, state by state."""
    done, _ = reconstruct_study(study, sensors, settings)
    print(f"{name}, {settings.targets}: {reconstruction_sentences(done)[0]}")
    print(done.over_participants()[["relative_l2", "r2", "coverage", "seconds"]].to_string())
    print(done.over_states().xs(done.recommended, level="model").round(3).to_string())
    print(*(finding.line() for finding in done.findings), sep="\n")


if __name__ == "__main__":
    main()
