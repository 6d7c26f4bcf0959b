"""Cost of a clinic against its number of people: processor time and peak memory of the commands that a laboratory uses.

    python benchmarks/clinic_people.py [--people 6 20 100] [--controls 6] [--files 3000]

Controls of the demonstration (`gaitdisc demo --clinic`: 16 s, angles, belts, EMG) are written and made a reference, and
as many other people as are wanted walk once each. Timed, each in a fresh process on one thread: `gaitdisc run` with all
pages, once more after one new trial of one person, and once more with nothing new; `gaitdisc new` on so many C3D files.
Processor time is that of the command and of all processes that it starts, peak memory that of the largest of them.
"""

from __future__ import annotations

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "studies"))
from command_line import argument, command_line

GIVEN = command_line(
    __name__,
    __doc__,
    argument("--people", "numbers of people", [6, 20, 100]),
    argument("--controls", "who walk", 6),
    argument("--files", "C3D files of `gaitdisc new`; 0: none", 3000),
)  # before the slow imports

import os
import tempfile

from hundred_trials import timed

from gaitdisc.clinic.demonstration import (
    CONDITION,
    CONTROLS_SEED,
    Visit,
    describe_participant,
    draw_person,
    make_walk,
)
from gaitdisc.cohort.demonstration import FORCES, write_trial
from gaitdisc.ingest.study import Conditions, Participant, PlannedTrial, Study
from gaitdisc.ingest.study_file import write_study

GAITDISC = [sys.executable, "-m", "gaitdisc"]


def main() -> None:
    print(f"load {os.getloadavg()[0]:.1f} on {os.cpu_count()} cores")
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        controls = write_people(folder / "controls", GIVEN.controls, 0)
        say(f"{GIVEN.controls} controls", ["reference", str(controls.folder), "--out", str(folder / "reference")])
        for count in GIVEN.people:
            study = write_people(folder / f"people{count}", count, GIVEN.controls)
            run = ["run", str(study.folder), "--quiet"]
            say(f"{count} people", [*run, "--reference", str(folder / "reference")])
            add_trial(study)
            say("  one new trial", run)
            say("  nothing new", run)
        if GIVEN.files:
            recordings = folder / "recordings"
            sources = sorted(controls.folder.rglob("*.c3d"))
            for number in range(GIVEN.files):
                link(sources[number % len(sources)], recordings / f"P{number // 50:03d}" / f"walk{number % 50:02d}.c3d")
            say(f"new, {GIVEN.files} files", ["new", str(folder / "new"), "--from", str(recordings)])


def say(what: str, words: list[str]) -> None:
    print(f"{what:20} {timed([*GAITDISC, *words])[0]}", flush=True)


def write_people(folder: Path, count: int, first: int) -> Study:
    """Study of so many people who walk once, drawn from a number on."""
    people = []
    for number in range(first, first + count):
        visit = Visit(f"P{number:03d}", number)
        person = draw_person(visit, CONTROLS_SEED)
        files = write_trial(make_walk(visit, CONTROLS_SEED), folder, f"raw/{visit.name}/walking")
        trial = PlannedTrial(condition=CONDITION, files=files, speed_m_per_s=person.speed_m_per_s)
        people.append(describe_participant(person, (trial,)))
    labels = {name: f"{name} [N]" for name in FORCES}
    study = Study(title="People", conditions=Conditions(nominal=CONDITION), channels=labels, participants=tuple(people))
    return save(study, folder, study.participants)


def link(source: Path, place: Path) -> None:
    place.parent.mkdir(parents=True, exist_ok=True)
    os.link(source, place)


def add_trial(study: Study) -> None:
    """A second trial of the first of them."""
    first, *others = study.participants
    walk = make_walk(Visit("again", GIVEN.controls, session="again"), CONTROLS_SEED)
    files = write_trial(walk, study.folder, f"raw/{first.id}/again")
    trial = PlannedTrial(condition=CONDITION, files=files, speed_m_per_s=first.trials[0].speed_m_per_s)
    save(study, study.folder, (first.model_copy(update={"trials": (*first.trials, trial)}), *others))


def save(study: Study, folder: Path, people: tuple[Participant, ...]) -> Study:
    changed = study.model_copy(update={"participants": people}).placed(folder)
    write_study(changed, folder / "study.toml")
    return changed


if __name__ == "__main__":
    main()
