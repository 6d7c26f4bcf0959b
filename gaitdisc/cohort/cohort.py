"""The cohort: twelve people, two walks each, and what is true of them."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from gaitdisc.channel import check_word
from gaitdisc.cohort.person import PATTERNS, STIFFNESS, Person, Spring, draw_one, walking_with
from gaitdisc.recording import Trial

WALK_S = 240.0
CONDITIONS = ("nominal", "exo")
# people that are reported (the first twelve from 30000 on whose means and spreads are within 20 % of the text's),
# and those that constants were set on
REPORTED_SEED, CALIBRATION_SEED = 30_216, 10_000
CHANGES, CHANGE_SHARE = 6, 0.80  # who changes the way of walking late in the Exo trial, and after which share of it
HIDDEN = ("spring", "weak plantarflexor", "late EMG", "foot mass", "scaled moment", "none", *PATTERNS)


@dataclass(frozen=True, eq=False)
class Walks:
    """The two walks of one person, with the truth."""

    person: Person
    trials: dict[str, Trial]
    truth: dict[str, Any]  # what is true of both, for tests alone: plain numbers and lists, to be written as JSON


def the_twelve(calibration: bool = False) -> tuple[Person, ...]:
    """Six women and six men, one of whom changes gait late in the Exo trial.

    calibration: the other twelve, on whom the constants of the model were set; they are never reported

    >>> [person.sex for person in the_twelve()].count("f")
    6
    """
    seed = CALIBRATION_SEED if calibration else REPORTED_SEED
    letter = "C" if calibration else "W"
    people = [draw_one(f"{letter}{number + 1:02d}", seed + number, "fm"[number % 2]) for number in range(12)]
    people[CHANGES] = replace(people[CHANGES], change_s=CHANGE_SHARE * WALK_S)
    return tuple(people)


def make_walks(person: Person, duration_s: float = WALK_S, hidden: str = "spring", markers: bool = False) -> Walks:
    """Walk a person in both conditions and measure it.

    duration_s: length of each walk [s]; a late change of gait keeps its share of it
    hidden: what differs between the conditions: `spring`, with adaptation (the dissertation's); `weak plantarflexor`
        (soleus and gastrocnemius give 75 % of their moment), `late EMG` (40 ms), `foot mass` (0.8 kg on each foot),
        `scaled moment` (the spring's moment is 0.6 of what 5 N m/deg would give), `none`, or a pattern in which the
        second walk goes (`stiff knee`, `drop foot`, `crouch`, `asymmetric`)
    markers: whether the trials hold markers and belts with their point and sideways force in place of angles and
        forces
    """
    from gaitdisc.cohort.marker_trial import marker_trial
    from gaitdisc.cohort.measurement import measure
    from gaitdisc.cohort.walk import walked

    person = replace(person, change_s=person.change_s * duration_s / WALK_S)
    spring, changed, late_s = _with_effect(person, hidden)
    whose = round(person.mass_kg * 1e6)
    seeds = [int(np.random.SeedSequence([whose, number]).generate_state(1)[0]) for number in range(len(CONDITIONS))]
    both = walked(person, None, duration_s, seeds[0]), walked(changed, spring, duration_s, seeds[1])
    walks = dict(zip(CONDITIONS, both, strict=True))
    trials = {}
    for word, walk in walks.items():
        trial = measure(walk, f"{person.name}_{word}", word, late_s if word == "exo" else 0.0)
        if markers:
            seen = marker_trial(walk, trial.name, word)
            trial = replace(seen, streams={**seen.streams, "emg": trial.stream("emg")})
        trials[word] = trial
    truth = {
        "person": person.name,
        **{name: getattr(person, name) for name in ("sex", "age_years", "height_m", "mass_kg", "speed_m_per_s")},
        "hidden": hidden,
        "spring_nm_per_deg": spring.stiffness if spring else 0.0,
        "engaged_deg": person.engaged_deg,
        "relief": person.adaptation.relief,
        "habit_change_rms_deg": float(np.sqrt(np.mean(person.adaptation.habit_deg**2))),
        "effort_change": person.adaptation.effort.tolist(),
        "change_s": person.change_s if np.isfinite(person.change_s) else None,
        "emg_late_s": late_s,
        "contacts_r_s": {word: walk.contacts().tolist() for word, walk in walks.items()},
    }
    return Walks(person, trials, truth)


def _with_effect(person: Person, hidden: str) -> tuple[Spring | None, Person, float]:
    check_word(hidden, HIDDEN, "the hidden effect")
    spring = Spring(STIFFNESS * (0.6 if hidden == "scaled moment" else 1.0))
    if hidden in ("spring", "scaled moment"):
        return spring, person.adapt_to(spring), 0.0
    if hidden in PATTERNS:
        return None, walking_with(person, hidden), 0.0
    weak = replace(person, plantarflexors=0.75 if hidden == "weak plantarflexor" else 1.0)
    return None, replace(weak, foot_kg=0.8 if hidden == "foot mass" else 0.0), 0.04 if hidden == "late EMG" else 0.0
