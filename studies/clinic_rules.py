"""What the rules of a person's page find: gait planted into made walks, healthy made people, and real ones left out.

    python studies/clinic_rules.py [--controls N] [--people N] [--run FOLDER] [--quick]

Made people walk 16 s on a treadmill; cycles are cut of them as of any recording. Controls make the reference. A stiff
knee bends 20 deg less in swing, a dropped foot hangs by 15 deg (gaitdisc/cohort/demonstration.py); children of eight
walk as adults of their size would, and nothing is to be said of them.
"""

from __future__ import annotations

from command_line import QUICK, argument, command_line

SEEN = command_line(
    __name__,
    __doc__,
    argument("--controls", "made controls", 20),
    argument("--people", "made people of each kind", 40),
    argument("--run", "folder of a run of real people, each read beside all others", type=str, default=None),
    QUICK,
)

from collections.abc import Iterator
from pathlib import Path

from gaitdisc import PooledCycles
from gaitdisc.clinic.clinical_reference import ClinicalReference
from gaitdisc.clinic.demonstration import CONDITION, Visit, describe_participant, draw_person, make_walk
from gaitdisc.clinic.reading import read_beside
from gaitdisc.clinic.reference import make_reference
from gaitdisc.cohort.demonstration import FOUND_AS
from gaitdisc.ingest.study import Conditions, PlannedTrial, Study
from gaitdisc.processing.pooled import pool_cycles
from gaitdisc.response.participant_response import load_run
from gaitdisc.saved.provenance import provenance_now

CONTROLS_SEED, PEOPLE_SEED = 50_000, 70_000
KINDS = ("", *FOUND_AS, "child")


def cycles_of(visit: Visit, seed: int) -> PooledCycles:
    """Cycles of one made person."""
    made = draw_person(visit, seed)
    planned = PlannedTrial(condition=CONDITION, files=("made",), speed_m_per_s=made.speed_m_per_s)
    person = describe_participant(made, (planned,))
    study = Study(title="made", conditions=Conditions(nominal=CONDITION), participants=(person,))
    return pool_cycles(study, person, lambda _: make_walk(visit, seed))[0]


def made_reference(count: int) -> ClinicalReference:
    """Reference of so many made controls."""
    own = [cycles_of(Visit(f"C{k}", k), CONTROLS_SEED) for k in range(count)]
    return make_reference(own, "made", provenance_now({}, 0, {}, ""))


def row_of(kind: str, reference: ClinicalReference, people: int) -> dict[str, object]:
    """How many pages of a kind say what was planted, on the right side, and how many say anything else."""
    found = other = 0
    for k in range(people):
        side = "lr"[k % 2]
        number = k + 1000 * KINDS.index(kind)
        reading = read_beside(cycles_of(Visit(f"P{k}", number, "", kind, side), PEOPLE_SEED), reference)
        far = [one for one in reading.noted if one.tier > 1]
        found += any(one.side == side and one.rule == FOUND_AS.get(kind) for one in far)
        other += any(one.side != side or kind not in FOUND_AS for one in far)
    return {"planted": kind or "nothing", "pages": people, "found": found, "said elsewhere": other}


def left_out(run_folder: Path) -> list[dict[str, object]]:
    """Real people of a run, each beside all the others of the condition."""
    run = load_run(run_folder)
    reference = make_reference(run.cycles, run.title, run.provenance)
    numbers = {name: k + 1 for k, name in enumerate(dict.fromkeys(one.subject for one in run.cycles if len(one.kept)))}
    rows = []
    for one in run.cycles:
        reading = read_beside(one, reference.without(numbers[one.subject]))
        score = reading.profile.both.value if reading.profile and reading.profile.both else None
        rows.append({"person": one.subject, "condition": one.condition, "values": len(reading.numbers),
                     "noted": len(reading.noted), "profile score [deg]": score})  # fmt: skip
    return rows


def run(controls: int = 20, people: int = 40, quick: bool = False) -> Iterator[dict[str, object]]:
    """Rows of the table of made people, as they are known."""
    controls, people = (8, 2) if quick else (controls, people)
    reference = made_reference(controls)
    for kind in KINDS:
        yield {"controls": controls, **row_of(kind, reference, people)}


if __name__ == "__main__":
    for row in left_out(Path(SEEN.run)) if SEEN.run else run(SEEN.controls, SEEN.people, SEEN.quick):
        print(" | ".join(f"{name}: {value}" for name, value in row.items()), flush=True)
