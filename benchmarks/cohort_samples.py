"""Samples of the embedded cohort, through the package's own reading of a walk, for the benchmarks of training."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from gaitdisc.cohort.cohort import WALK_S, make_walks, the_twelve
from gaitdisc.ingest.study import Conditions, Models, Participant, Study
from gaitdisc.processing.process import processed
from gaitdisc.processing.samples import gait_samples
from gaitdisc.recording import Samples
from gaitdisc.response.fit_response import ResponseSettings, split_held_out

MUSCLES = ("ham", "rf", "vas", "gas", "sol", "ta", "gmed")
OUTPUTS = ("hip_flexion_r", "knee_angle_r", "ankle_angle_r", *(f"emg_{muscle}_r" for muscle in MUSCLES[:5]))
STUDY = Study(
    conditions=Conditions(nominal="nominal", device="exo"),
    models=Models(emg=tuple(f"emg_{muscle}_{side}" for side in "rl" for muscle in MUSCLES), outputs=OUTPUTS),
    participants=(Participant(id="C01"),),
)
HELD_OUT_S = 30.0


@dataclass(frozen=True, eq=False)
class PersonSamples:
    """Training parts without and with the device, and the held-out device walking, of one person."""

    nominal: Samples
    exo: Samples
    held_out: Samples

    def first(self, length_s: float) -> tuple[Samples, Samples, Samples]:
        """Shorten the training parts to their first seconds, from the first usable sample on, as `gaitdisc ablate`."""
        shorter = (part.rows(part.time < part.time[0] + length_s - 1e-6) for part in (self.nominal, self.exo))
        nominal, exo = shorter
        return nominal, exo, self.held_out


def person_samples(number: int) -> PersonSamples:
    """240 s of one of the twelve in both conditions; who changes gait late does not: twelve are needed."""
    person = replace(the_twelve()[number], change_s=math.inf)
    walks = make_walks(person, WALK_S)
    settings = ResponseSettings(OUTPUTS, HELD_OUT_S)
    parts = {
        word: [gait_samples(part, OUTPUTS)[0] for part in split_held_out(processed(trial, STUDY).trajectory, settings)]
        for word, trial in walks.trials.items()
    }
    return PersonSamples(parts["nominal"][0], parts["exo"][0], parts["exo"][1])
