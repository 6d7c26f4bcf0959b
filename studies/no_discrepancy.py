"""Without a spring and without adaptation there is no discrepancy: the embedded cohort's first law, over many pairs.

    python studies/no_discrepancy.py [--quick]

results/cohort.md holds what it prints. Both walks of a pair come from the same model with another seed, so the true
difference is zero; what 30 held-out seconds show of it scatters.
"""

from __future__ import annotations

from command_line import QUICK, command_line

GIVEN = command_line(__name__, __doc__, QUICK)  # before the slow imports

import numpy as np
from markdown_table import markdown_table
from numpy.typing import NDArray

import gaitdisc as gd
from gaitdisc.cohort.measurement import measure
from gaitdisc.cohort.person import MUSCLES, Person, Spring, draw_one
from gaitdisc.cohort.walk import walked
from gaitdisc.ingest.study import Conditions, Models, Participant, Quality, Study
from gaitdisc.processing.process import processed
from gaitdisc.processing.samples import gait_samples
from gaitdisc.response.fit_response import ResponseSettings, fit_linear, split_held_out

OUTPUTS = ("hip_flexion_r", "knee_angle_r", "ankle_angle_r", *(f"{muscle}_r" for muscle in MUSCLES[:5]))
EMG = tuple(f"{muscle}_{side}" for side in "rl" for muscle in MUSCLES)
PEOPLE, PERSON_SEED, WALK_SEED = 12, 70_000, 700_000  # nobody of either cohort
PAIRS = 9  # of walks, each person
WALK_S = 240.0


def run(quick: bool = False) -> NDArray[np.float64]:
    """Walk the pairs, print mean difference and standard error by variable, and return every pair's difference."""
    people, pairs, duration_s = (2, 1, 40.0) if quick else (PEOPLE, PAIRS, WALK_S)
    everybody = [draw_one("A", PERSON_SEED + number, "fm"[number % 2]).unadapted() for number in range(people)]
    seeds = [WALK_SEED + 1000 * pair for pair in range(pairs)]
    apart = np.array([difference(one, duration_s, s + 2 * k) for s in seeds for k, one in enumerate(everybody)])
    error = apart.std(axis=0, ddof=1) / np.sqrt(len(apart))
    print(f"{len(apart)} pairs of walks of {duration_s:.0f} s, {people} people; ridge with phase harmonics\n")
    rows = [("difference", *map("{:+.4f}".format, apart.mean(axis=0)))]
    rows.append(("standard error", *map("{:.4f}".format, error)))
    print(markdown_table(" | ".join(("", *OUTPUTS)), rows))
    return apart


def difference(person: Person, duration_s: float, seed: int) -> NDArray[np.float64]:
    """R2 of a Nominal model on a second walk, minus R2 on the held-out part of its own."""
    train, held = _parts(person, None, duration_s, seed)
    _, other = _parts(person, Spring(0.0), duration_s, seed + 1)
    model = fit_linear(train).model
    return gd.r2(other.y, model(other.x)) - gd.r2(held.y, model(held.x))


def _parts(person: Person, device: Spring | None, duration_s: float, seed: int) -> tuple[gd.Samples, gd.Samples]:
    both, models = Conditions(nominal="nominal", device="exo"), Models(emg=EMG, outputs=OUTPUTS)
    settled = Quality(late_change="report")
    study = Study(conditions=both, participants=(Participant(id="A"),), models=models, quality=settled)
    walk = processed(measure(walked(person, device, duration_s, seed), "walk", "nominal"), study).trajectory
    training, held_out = split_held_out(walk, ResponseSettings(OUTPUTS))
    return gait_samples(training, OUTPUTS)[0], gait_samples(held_out, OUTPUTS)[0]


if __name__ == "__main__":
    run(GIVEN.quick)
