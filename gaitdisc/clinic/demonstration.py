"""A week of a clinic, made: controls, healthy people, and some with gait planted that their pages must find."""

import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from scipy.ndimage import gaussian_filter1d

from gaitdisc.channel import Channel
from gaitdisc.cohort.demonstration import FORCES, plant, write_trial
from gaitdisc.cohort.habit import habitual
from gaitdisc.cohort.measurement import measure
from gaitdisc.cohort.person import Person, draw_one
from gaitdisc.cohort.walk import QUICK_HZ, SLOW_HZ, TrueWalk, walked
from gaitdisc.ingest.study import Conditions, Participant, PlannedTrial, Study
from gaitdisc.ingest.study_file import write_study
from gaitdisc.recording import Recording, Trial
from gaitdisc.recording.recording import join_recordings
from gaitdisc.whole_file import write_whole

WALK_S = 16.0
CONTROLS_SEED = 52_000  # twenty whose spreads are those of a hundred; 50_000: a third less at the knee
WEEK_SEED = 60_000
CONDITION = "walking"
# between healthy people, of the mean [deg] (Kadaba 1990, about); the feet point outwards by some 7 deg
PELVIS_SD = {"pelvis_tilt": 4.0, "pelvis_obliquity": 1.0, "pelvis_rotation": 1.5}
TOES_OUT_DEG, TOES_SD = -7.0, 4.0
SWAY_DEG, SWAY_STEPS = 0.4, 12  # from cycle to cycle, over 0.12 s


@dataclass(frozen=True)
class Visit:
    """One walk of a made person."""

    name: str
    number: int  # of the person, who is drawn by it
    session: str = ""
    # what is planted; empty for a healthy walk, `bad file` for a recording that cannot be read, `child` for somebody of
    # eight years and that size
    what: str = ""
    side: str = "r"


WEEK = (
    Visit("P01", 0),
    Visit("P02", 1, what="stiff knee", side="l"),
    Visit("P03", 2),
    Visit("P04", 3, what="drop foot", side="r"),
    Visit("P05", 4, "before", "stiff knee", "r"),
    Visit("P05", 4, "after"),
    Visit("P06", 5, what="bad file"),
    Visit("P07", 6),
    Visit("P08", 8, what="child"),
)
LABORATORY = """laboratory = "Gait laboratory (simulated)"
pdf = true

[people.P02]
affected = "left"
"""
CHILD = {"age_years": 8.0, "height_m": 1.26, "mass_kg": 26.0}
NO_GAIT = ("bad file", "child")  # planted, but not into the way of walking


def draw_person(visit: Visit, seed: int) -> Person:
    """Somebody drawn; a child walks as fast as the grown person of the same draw, for its size (Hof 1996)."""
    person = draw_one(visit.name, seed + visit.number, "fm"[visit.number % 2])
    if visit.what != "child":
        return person
    smaller = (CHILD["height_m"] / person.height_m) ** 0.5
    return replace(person, **CHILD, speed_m_per_s=smaller * person.speed_m_per_s, stride_s=smaller * person.stride_s)


def make_walk(visit: Visit, seed: int) -> Trial:
    """Walk of a visit on a treadmill, measured, with what is planted."""
    walk = make_habit(draw_person(visit, seed), visit, seed)
    what = "" if visit.what in NO_GAIT else visit.what
    return plant(with_pelvis(walk, measure(walk, f"{visit.name}_{CONDITION}", CONDITION)), what, visit.side)


def make_habit(person: Person, visit: Visit, seed: int) -> TrueWalk:
    """What happens while somebody walks."""
    return walked(person, None, WALK_S, seed=seed + 7 * visit.number + len(visit.session))


def with_pelvis(walk: TrueWalk, trial: Trial) -> Trial:
    """Trial whose angles are also those of the pelvis and of the feet in the laboratory: the nine of a profile score.

    The pelvis moves by the habit of the person's speed with an offset of the person's own; signs are OpenSim's.
    """
    person, kinematics = walk.person, trial.stream("kinematics")
    person_rng, noise = (np.random.default_rng([round(person.mass_kg * 1e6), seed]) for seed in (61, walk.seed + 62))
    phase = walk.phase[:: round(QUICK_HZ / SLOW_HZ)]
    habit = {name: habitual(name, person.dimensionless_speed).at(phase) for name in PELVIS_SD}
    tilt, obliquity, rotation = (habit[name] + sd * person_rng.normal() for name, sd in PELVIS_SD.items())
    toes = TOES_OUT_DEG + TOES_SD * person_rng.normal() + 1.5 * person_rng.normal(size=2)
    columns = {"pelvis_tilt": -tilt, "pelvis_list": -obliquity, "pelvis_rotation": rotation}
    columns |= {
        f"foot_progression_angle_{side}": np.full(len(phase), toe) for side, toe in zip("rl", toes, strict=True)
    }
    added = np.column_stack([*columns.values()])
    sway = gaussian_filter1d(noise.normal(size=added.shape), SWAY_STEPS, axis=0)
    added = added + SWAY_DEG * sway / sway.std(axis=0)
    channels = tuple(Channel(name, "angle", "deg", name[-1] if name[-2] == "_" else "") for name in columns)
    both = replace(join_recordings(kinematics, Recording(kinematics.time, added, channels)), suspect=None)
    return replace(trial, streams={**trial.streams, "kinematics": both})


def write_week(
    folder: Path, controls: int = 20, progress: Callable[[str], None] = lambda _: None
) -> tuple[Study, Study, dict[str, str]]:
    """Write `controls/` and `week/`, and apart from them what was planted by person and session, "" for the healthy."""
    visits = [Visit(f"C{k + 1:02d}", k) for k in range(controls)]
    control_study = _write(folder / "controls", visits, "Controls, made", CONTROLS_SEED, progress)
    truth = {}
    for visit in WEEK:
        what, side = visit.what, "left" if visit.side == "l" else "right"
        truth[f"{visit.name} {visit.session}".strip()] = what if what in ("", *NO_GAIT) else f"{what} {side}"
    cases = "; ".join(f"{who} {what}" for who, what in truth.items() if what)
    week = _write(folder / "week", WEEK, f"A simulated clinic week with gait deviations: {cases}", WEEK_SEED, progress)
    write_whole(folder / "week" / "clinic.toml", LABORATORY)
    write_whole(folder / "planted.json", json.dumps(truth, indent=1))
    return control_study, week, truth


def _write(folder: Path, visits: Sequence[Visit], title: str, seed: int, progress: Callable[[str], None]) -> Study:
    trials: dict[str, list[PlannedTrial]] = {}
    people: dict[str, Person] = {}
    sessions = tuple(word for word in ("before", "after") if any(visit.session == word for visit in visits))
    for visit in visits:
        stem = f"raw/{visit.name}/{visit.session or 'only'}/{CONDITION}"
        files = write_trial(make_walk(visit, seed), folder, stem)
        if visit.what == "bad file":
            for file in files:
                content = (folder / file).read_bytes()
                write_whole(folder / file, content[: len(content) // 3])
        people[visit.name] = person = draw_person(visit, seed)
        planned = PlannedTrial(
            condition=CONDITION, session=visit.session or None, files=files, speed_m_per_s=person.speed_m_per_s
        )
        trials.setdefault(visit.name, []).append(planned)
        progress(visit.name)
    study = Study(
        title=title,
        sessions=sessions,
        conditions=Conditions(nominal=CONDITION),
        channels={name: f"{name} [N]" for name in FORCES},
        participants=tuple(describe_participant(people[name], tuple(walks)) for name, walks in trials.items()),
    ).placed(folder)
    write_study(study, folder / "study.toml")
    return study


def describe_participant(person: Person, trials: tuple[PlannedTrial, ...]) -> Participant:
    """What a study says of a made person."""
    return Participant(
        id=person.name, height_m=round(person.height_m, 3), age_years=int(person.age_years), trials=trials
    )
