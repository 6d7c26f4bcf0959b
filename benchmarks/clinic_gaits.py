"""What a person's page names of gaits planted at the sizes of patients, and what it says of healthy people.

    python benchmarks/clinic_gaits.py [--controls 20] [--people 40] [--kinds all] [--seed 90000] [--controls-seed 50000]

Made people walk 16 s on a treadmill (gaitdisc/cohort), cycles are cut of them as of any recording, and each is read
beside made controls. What is planted is added to the angles, over the true phase of the walk. A page is right where
every leg with the gait has the sentence of its pattern in the tier that the distance of its farthest number, or of its
difference to the other leg, from a hundred healthy people calls for, and no leg has a sentence of the second tier that
does not belong to the pattern. Of the six kinds three were looked at while the rules were written; equinus,
Trendelenburg and slow were kept back and run once (seed 70000: 88, 38 and 95 % right); the rule of the pelvis was
corrected then, and with those of hip and ankle by the people of seeds 810000 and 820000; seed 910000 was kept back.

Sizes, after abstracts
----------------------
stiff knee     largest knee flexion in swing of 19 adults after a stroke: 26 ± 13 deg, of healthy people 60 (Stoquart
               2008, Arch Phys Med Rehabil 89:56)
drop foot      lengthening and tendon shortening gave 26 people back 11.7 deg of dorsiflexion in swing (Tsang 2016, Gait
               Posture 50:23): that much is missing, ± 4 deg
crouch         knee flexion in mid stance beyond 19 deg is the criterion of O'Sullivan, French, Horgan (progression
               of flexed-knee gait in bilateral cerebral palsy), healthy 5 deg: 22 ± 5 deg more, hip and ankle by half;
               both legs
equinus        dorsiflexion in stance is missing by 18 ± 6 deg, a judgement: a healthy 12 deg becomes −6 (one child in
               Case Rep Med 2010:417806 has −45)
Trendelenburg  the pelvis drops by 7 ± 2 deg more in single support, and the hip adducts by as much (general knowledge)
slow           .60 to .75 of the own speed, with the cadence and the habit of that speed, else healthy
"""

from __future__ import annotations

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "studies"))
from command_line import argument, command_line

GIVEN = command_line(
    __name__,
    __doc__,
    argument("--controls", "made controls", 20),
    argument("--people", "made people of each kind", 40),
    argument("--kinds", "which, with commas between: stiff_knee,crouch", "all"),
    argument("--seed", "of the people", 90_000),
    argument("--controls-seed", "of the controls", 50_000),
)  # before the slow imports

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from gaitdisc import PooledCycles
from gaitdisc.clinic.clinical_reference import ClinicalReading, ClinicalReference, Limits, Noted
from gaitdisc.clinic.demonstration import CONDITION, Visit, describe_participant, draw_person, make_habit, with_pelvis
from gaitdisc.clinic.reading import read_beside
from gaitdisc.clinic.reference import make_reference
from gaitdisc.clinic.rules import known_numbers, rules, sample_differences, sample_legs
from gaitdisc.cohort.measurement import measure
from gaitdisc.cohort.person import CADENCE, CADENCE_SPEED, Bump, Person
from gaitdisc.cohort.walk import QUICK_HZ, SLOW_HZ
from gaitdisc.ingest.study import Conditions, PlannedTrial, Study
from gaitdisc.processing.pooled import pool_cycles
from gaitdisc.recording import Trial
from gaitdisc.recording.trial import LEG_OF_STATURE
from gaitdisc.saved.provenance import provenance_now

CONTROLS_SEED, PEOPLE_SEED = 50_000, 90_000
TAKEN = (sample_legs, sample_differences)  # of a leg, and of it less the other
ALWAYS = 10.0  # half width of what lasts the whole stride
Bumps = tuple[tuple[str, float, float, float], ...]  # channel (of the leg, or `pelvis_list`), centre, half width, share


@dataclass(frozen=True)
class Kind:
    """A way of walking, its sizes, and what its page must and may say."""

    size: tuple[float, float, float, float]  # mean, standard deviation, smallest and largest [deg, or 1]
    bumps: Bumps
    rule: str  # that must speak, in the second tier
    groups: tuple[str, ...]  # sentence of that rule, and what else is the same pattern
    both: bool = False  # of both legs


KINDS = {
    "healthy": Kind((0.0, 0.0, 0.0, 0.0), (), "", ()),
    "stiff knee": Kind(
        (34.0, 13.0, 15.0, 50.0), (("knee_angle", 0.72, 0.20, -1.0),), "knee flexion in swing", ("knee_flexion less",)
    ),
    "drop foot": Kind(
        (11.7, 4.0, 8.0, 20.0),
        (("ankle_angle", 0.86, 0.24, -1.0),),
        "dorsiflexion in swing",
        ("ankle_dorsiflexion less",),
    ),
    "crouch": Kind(
        (22.0, 5.0, 15.0, 35.0),
        (("knee_angle", 0.0, ALWAYS, 1.0), ("hip_flexion", 0.0, ALWAYS, 0.5), ("ankle_angle", 0.0, ALWAYS, 0.5)),
        "knee extension in stance",
        ("knee_flexion more", "hip_flexion more", "ankle_dorsiflexion more"),
        both=True,
    ),
    "equinus": Kind(
        (18.0, 6.0, 10.0, 35.0),
        (("ankle_angle", 0.0, ALWAYS, -1.0),),
        "dorsiflexion in stance",
        ("ankle_dorsiflexion less",),
    ),
    "Trendelenburg": Kind(
        (7.0, 2.0, 5.0, 12.0),
        (("pelvis_list", 0.30, 0.30, 1.0), ("hip_adduction", 0.30, 0.30, 1.0)),
        "pelvis in single support",
        ("pelvic drop more",),
    ),
    "slow": Kind((0.68, 0.04, 0.60, 0.75), (), "walking speed", (), both=True),
}


def draw_size(kind: Kind, number: int) -> float:
    """Size of a person of a kind."""
    mean, sd, low, high = kind.size
    return float(np.clip(mean + sd * np.random.default_rng([number, 77]).normal(), low, high))


def slow_down(person: Person, share: float) -> Person:
    """Person at a share of the own speed, with the cadence that goes with it (Schwartz 2008)."""
    leg = LEG_OF_STATURE * person.height_m
    cadence = CADENCE * (share * person.dimensionless_speed / CADENCE_SPEED) ** 0.5
    return replace(
        person, speed_m_per_s=share * person.speed_m_per_s, stride_s=2 / cadence * float((leg / 9.81) ** 0.5)
    )


def walk_with(kind: Kind, visit: Visit, seed: int) -> tuple[Person, Trial]:
    """Somebody of a kind and the measured walk."""
    size, person = draw_size(kind, visit.number), draw_person(visit, seed)
    if kind.rule == "walking speed":
        person = slow_down(person, size)
    walk = make_habit(person, visit, seed)
    trial = with_pelvis(walk, measure(walk, f"{visit.name}_{CONDITION}", CONDITION))
    kinematics, phase = trial.stream("kinematics"), walk.phase[:: round(QUICK_HZ / SLOW_HZ)]
    values = np.array(kinematics.values)
    for side in "rl" if kind.both else visit.side:
        for stem, centre, half_width, share in kind.bumps:
            bump = Bump(0, 0, centre, half_width, share * size)
            name, sign = (stem, {"r": -1.0, "l": 1.0}[side]) if stem == "pelvis_list" else (f"{stem}_{side}", 1.0)
            values[:, kinematics.index(name)] += sign * bump.at(phase + 0.5 * (side == "l"))
    return person, replace(trial, streams={**trial.streams, "kinematics": kinematics.with_values(values)})


def cycles_of(kind: Kind, visit: Visit, seed: int) -> PooledCycles:
    """Cycles of one made person."""
    made, trial = walk_with(kind, visit, seed)
    planned = PlannedTrial(condition=CONDITION, files=("made",), speed_m_per_s=made.speed_m_per_s)
    person = describe_participant(made, (planned,))
    study = Study(title="made", conditions=Conditions(nominal=CONDITION), participants=(person,))
    return pool_cycles(study, person, lambda _: trial)[0]


def made_reference(
    count: int, cycles: Callable[[Kind, Visit, int], PooledCycles] = cycles_of, seed: int = CONTROLS_SEED
) -> ClinicalReference:
    """Reference of so many made controls."""
    own = [cycles(KINDS["healthy"], Visit(f"C{k}", k), seed) for k in range(count)]
    return make_reference(own, "made", provenance_now({}, 0, {}, ""))


def grade(kind: Kind, side: str, reading: ClinicalReading, truth: dict[tuple[str, bool], Limits]) -> dict[str, float]:
    """What a page names: pattern on the right legs, in the right tier; what else it says in each tier.

    truth: mean and spread of each rule's number, and of the difference of both legs, over a hundred healthy people
    """
    legs = ("l", "r") if kind.both else (side,)
    own = [one for one in reading.noted if one.rule != "gait profile score"]
    belongs = [one for one in own if one.rule == kind.rule or one.group in kind.groups]
    others = [one for one in own if one not in belongs]
    astray = [one for one in belongs if one.side not in legs]
    said = [one for one in own if one.rule == kind.rule or one.group in kind.groups[:1]]  # the farthest first
    hits = [next((one for one in said if one.side == leg), None) for leg in legs]
    found = {
        "named": all(hits),
        "right tier": all(hit and hit.tier in tiers_of(hit, truth[hit.rule, bool(hit.other)]) for hit in hits),
        "second tier": all(hit and hit.tier == 2 for hit in hits),
    }
    return {
        **(found if kind.rule else dict.fromkeys(found, float("nan"))),
        "other in the second tier": any(one.tier == 2 for one in (*others, *astray)),
        "wrong side": any(one.tier == 2 for one in astray),
        "first tier": len({one.group for one in reading.noted if one.tier == 1 and one not in belongs}),
    }


def tiers_of(one: Noted, truth: Limits) -> tuple[int, ...]:
    """Tiers that are right for a number; both near the limit of 3.9 sd: 20 controls know the spread within 16 %."""
    far = abs(one.value - truth.mean) / truth.sd
    return (2,) if far > 3.9 * 1.16 else (1,) if far < 3.9 / 1.16 else (1, 2)


def run(
    kinds: list[str],
    controls: int,
    people: int,
    seed: int = PEOPLE_SEED,
    cycles: Callable[[Kind, Visit, int], PooledCycles] = cycles_of,
    controls_seed: int = CONTROLS_SEED,
) -> Iterator[dict[str, object]]:
    """A row a kind: percent of pages."""
    reference = made_reference(controls, cycles, controls_seed)
    many = made_reference(100, cycles).of(CONDITION)
    truth = {}
    for rule in rules():
        known = known_numbers(rule, many)
        samples = ((bool(sides), take(known)) for sides, take in enumerate(TAKEN))
        truth |= {(rule.name, sides): sample.limits() for sides, sample in samples if sample}
    for word in kinds:
        kind, rows = KINDS[word], []
        for k in range(people):
            number = k + 1000 * list(KINDS).index(word)
            visit = Visit(f"P{k}", number, side="lr"[k % 2])
            rows.append(grade(kind, visit.side, read_beside(cycles(kind, visit, seed), reference), truth))
        columns = {name: np.array([row[name] for row in rows], float) for name in rows[0]}
        first = columns.pop("first tier")
        right = columns["named"] * columns["right tier"] * (1 - columns["other in the second tier"])
        yield {
            "kind": word,
            "pages": people,
            **{name: f"{100 * np.mean(one):.0f} %" for name, one in columns.items()},
            "right": f"{100 * np.mean(right):.0f} %",
            "other first-tier sentences, median": float(np.median(first)),
        }


if __name__ == "__main__":
    wanted = [*KINDS] if GIVEN.kinds == "all" else GIVEN.kinds.replace("_", " ").split(",")
    for row in run(wanted, GIVEN.controls, GIVEN.people, GIVEN.seed, controls_seed=GIVEN.controls_seed):
        print(" | ".join(f"{name}: {value}" for name, value in row.items()), flush=True)
