"""What a device does, from a laboratory's files alone: which hidden effects of the embedded cohort are named.

    python studies/device_from_files.py [OUT.csv] [--people 3] [--seed 777301] [--fit] [--quick]

People drawn from a seed, outside both cohorts, walk twice 36 s: Nominal, and with one thing hidden. Each is written as
a study (angles .mot; EMG, forces, markers .c3d; moments .sto, the pressure 3 mm off) and searched; not by `--fit`.
"""

from __future__ import annotations

from pathlib import Path

from command_line import QUICK, argument, command_line

GIVEN = command_line(
    __name__,
    __doc__,
    argument("out", "CSV that gets the table (default: none)", nargs="?", type=Path),
    argument("--people", "how many people", 3),
    argument("--seed", "of the first person; the next have the next", 777301),
    argument("--fit", "the fit of both walks alone, not the search that has to bear it out", False),
    argument("--trials", "trials of 4 s into which each walk is cut; 0 leaves it whole", 0),
    QUICK,
)  # before the slow imports

from dataclasses import replace
from tempfile import TemporaryDirectory

import numpy as np
import pandas as pd
from ankle_records import moments_per_foot_kg
from scipy.signal import butter, sosfiltfilt

import gaitdisc as gd
from gaitdisc.cohort.demonstration import FORCES
from gaitdisc.cohort.marker_trial import marker_trial
from gaitdisc.cohort.measurement import measure
from gaitdisc.cohort.person import STIFFNESS, Person, Spring, draw_one
from gaitdisc.cohort.walk import TrueWalk, walked
from gaitdisc.discovery.changed_moment import NORMAL_95
from gaitdisc.discovery.device_study import FOOT_SHOWS_AT, PersonWalks, weigh_foot
from gaitdisc.discovery.discover_device import discover_study
from gaitdisc.discovery.result import Estimate, FoundEffect
from gaitdisc.ingest.c3d_writing import write_c3d
from gaitdisc.ingest.storage import write_storage
from gaitdisc.ingest.study import Conditions, Participant, PlannedTrial, Study
from gaitdisc.ingest.study_file import load_study, write_study

CONDITIONS, CHANNELS = Conditions(nominal="nominal", device="exo"), {name: f"{name} [N]" for name in FORCES}
WALK_S, TRIAL_S, PRESSURE_M, ERROR_HZ = 36.0, 4.0, 0.003, 6.0
MODELS = ("Nominal", "Nominal + named effect", "Augmented (plain regression)", "Exo")
RIGHT = {
    "none": ("", "", np.nan),
    "spring": ("one_sided_spring", "ankle_moment", np.degrees(STIFFNESS)),
    "weak plantarflexor": ("wrong_parameter", "plantarflexors_strength", 0.75),
    "late EMG": ("wrong_parameter", "emg_delay", -0.04),
    "foot mass": ("wrong_parameter", "added_foot_mass", 0.8),
}


def summary(table: pd.DataFrame) -> pd.DataFrame:
    """How many are right, how far off the value is, and the held-out errors [N m], by what was hidden."""
    inside, off = table["truth"].between(table["low"], table["high"]), 100 * (table["value"] / table["truth"] - 1).abs()
    groups = table.assign(off=off, inside=inside).groupby("hidden", sort=False)
    counts = groups.agg(n=("right", "size"), right=("right", "sum"), inside=("inside", "sum"))
    return counts.join(groups[["off", *(one for one in MODELS if one in table)]].median())


def run(people: int, seed: int, quick: bool, fit: bool = False, trials: int = 0) -> pd.DataFrame:
    """Hide each effect in each person's second walk, and search the files."""
    everyone = [draw_one(f"X{one + 1:02d}", seed + one, "fm"[one % 2]) for one in range(1 if quick else people)]
    hiddens = ["spring"] if quick else RIGHT
    return pd.DataFrame([found_in(one, hidden, fit, trials) for one in everyone for hidden in hiddens])


def found_in(person: Person, hidden: str, fit: bool, trials: int) -> dict[str, object]:
    """One study of one person, one search: what it says beside what is true."""
    with TemporaryDirectory() as folder:
        study = write_person(person, hidden, Path(folder), trials)
        found = None if fit else discover_study(study, person.name)["exo"][0]
        effects, beside = (found.effects, dict(found.beside)) if found else (fitted(study, person.name), {})
    *wanted, truth = RIGHT[hidden]
    own = [next(iter(one.estimates.values())) for one in effects if [one.name, one.place] == wanted]
    right, named = bool(own) if wanted[0] else not effects, ", ".join(one.place for one in effects)
    row: dict[str, object] = {"person": person.name, "hidden": hidden, "right": right, "named": named, "truth": truth}
    row |= {key: getattr((own or [None])[0], key, np.nan) for key in ("value", "low", "high")}
    return row | beside


def fitted(study: Path, who: str) -> tuple[FoundEffect, ...]:
    """What the fit of both walks says: at the ankle, or where nothing changed there, of the foot."""
    read = load_study(study)
    walks = PersonWalks(read, read.participant(who))
    changed = walks.calibrated("exo").changed
    if changed is None:
        mass = weigh_foot({joint: walks.at("exo", joint) for joint in FOOT_SHOWS_AT})
        return (FoundEffect("", "added_foot_mass", "wrong_parameter", "", {"value": mass}),) if mass else ()
    half = NORMAL_95 * changed.spread
    number = Estimate(changed.value, changed.value - half, changed.value + half)
    return (FoundEffect("", changed.change.place, changed.change.name, "", {changed.change.number: number}),)


def write_person(person: Person, hidden: str, folder: Path, trials: int = 0) -> Path:
    """Write both walks of a person as a study."""
    spring, late_s = Spring(STIFFNESS) if hidden == "spring" else None, 0.04 if hidden == "late EMG" else 0.0
    weak, kilograms = (0.75 if hidden == "weak plantarflexor" else 1.0), (0.8 if hidden == "foot mass" else 0.0)
    changed = person.adapt_to(spring) if spring else replace(person, plantarflexors=weak, foot_kg=kilograms)
    planned = []
    for number, (word, walker, device) in enumerate((("nominal", person, None), ("exo", changed, spring))):
        walk = walked(walker, device, WALK_S, 1000 * round(person.mass_kg) + number)
        trial = measure(walk, f"{person.name}_{word}", word, late_s * number)
        markers = marker_trial(walk, trial.name, word).stream("markers")
        files = angles, analog, net = f"{word}_ik.mot", f"{word}.c3d", f"{word}_id.sto"
        write_storage(trial.stream("kinematics"), folder / angles)
        write_c3d((trial.stream("emg"), trial.stream("forces"), markers), folder / analog)
        write_storage(moments(walk), folder / net)
        parts = [(start, start + TRIAL_S) for start in np.linspace(0.0, WALK_S - TRIAL_S, trials).tolist()]
        planned += [PlannedTrial(condition=word, files=files, crop_s=part) for part in parts or [None]]
    mine = (Participant(id=person.name, mass_kg=round(person.mass_kg, 1), trials=tuple(planned)),)
    study = Study(title=hidden, conditions=CONDITIONS, channels=CHANNELS, participants=mine)
    write_study(study.placed(folder), folder / "study.toml")
    return folder / "study.toml"


def moments(walk: TrueWalk) -> gd.Recording:
    """Net moments of inverse dynamics that knows no mass at the foot, its centre of pressure 3 mm off."""
    white = np.random.default_rng([walk.seed, 31]).normal(size=len(walk.slow_s))
    wander = sosfiltfilt(butter(4, ERROR_HZ, fs=100, output="sos"), white)
    load = np.interp(walk.slow_s, walk.quick_s, walk.force[:, 0, 1])
    net = walk.moments[:, 0] + np.outer(walk.spring[:, 0], (0, 0, 1)) - walk.person.foot_kg * moments_per_foot_kg(walk)
    net += np.outer(PRESSURE_M * wander / wander.std() * load, (1.0, -1.0, 1.0))
    names = ("hip_flexion_r_moment", "knee_angle_r_moment", "ankle_angle_r_moment")
    return gd.Recording(walk.slow_s, net, tuple(gd.Channel(name, "moment", "N m", "r") for name in names))


if __name__ == "__main__":
    table = run(GIVEN.people, GIVEN.seed, GIVEN.quick, GIVEN.fit, GIVEN.trials)
    print(table.round(3).to_string(), summary(table).round(3).to_string(), sep="\n")
    if GIVEN.out:
        table.to_csv(GIVEN.out, index=False)
