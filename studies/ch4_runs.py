"""Two real runners, their samples: what is fitted to and what is held out."""

from __future__ import annotations

from functools import cache

from ch5_gait import DATA, RUNS, exotendon
from real_people import ANGLES

import gaitdisc as gd
from gaitdisc.ingest.study import Models
from gaitdisc.processing.process import processed
from gaitdisc.response.fit_response import ResponseSettings, held_out_part
from gaitdisc.response.samples import gait_samples

SETTINGS = ResponseSettings(ANGLES)
Parts = tuple[gd.Samples, gd.Samples]


@cache
def run(who: str, condition: str) -> Parts:
    """Training part and held-out part of a run, all ten accelerations to be predicted."""
    found = {"natural": "manual_ik.mot" if who == "welk002" else RUNS[who]["natural"]}
    name = found.get(condition) or RUNS[who][condition]
    study = exotendon(DATA).model_copy(update={"models": Models(angles=ANGLES, emg=(), outputs=ANGLES)})
    trial = gd.read(next((DATA / "exotendon_run").rglob(name)))
    before, held = held_out_part(processed(trial, study).trajectory, SETTINGS)
    return gait_samples(before, ANGLES)[0], gait_samples(held, ANGLES)[0]
