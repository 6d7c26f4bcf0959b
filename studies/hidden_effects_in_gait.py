"""Effects hidden in the walks of the embedded cohort: which are named, and how near to the truth.

    python studies/hidden_effects_in_gait.py [OUT.csv] [--people N] [--stated] [--hidden nothing,spring] [--seed N]

Each of the twelve walks with one thing hidden that the simulation (tracked_ankle.toml) does not know: the spring of the
exoskeleton, weak plantarflexors, EMG that is 40 ms late, 0.8 kg on the foot, a spring of 0.6 of its moment; and the
Nominal walk, in which nothing is hidden. Eight stretches of one walk, two held out.
"""

from __future__ import annotations

from pathlib import Path

from command_line import QUICK, argument, command_line

GIVEN = command_line(
    __name__,
    __doc__,
    argument("out", "CSV that gets the table (default: none)", nargs="?", type=Path),
    argument("--people", "how many of the twelve", 12),
    argument("--emg-error", "error of the plantarflexors' moment, sd as a share of it", 0.05),
    argument("--others-nm", "error of all other muscles' moment, sd [N m]", 1.5),
    argument("--stated", "the simulation states these errors", False),
    argument("--hidden", "which, with commas between (default: all)", ""),
    argument("--seed", "of the walks", 0),
    QUICK,
)  # before the slow imports

from dataclasses import dataclass, replace

import numpy as np
import pandas as pd
from ankle_records import ankle_trials, own_foot_kg
from hidden_spring import with_stated_errors

import gaitdisc as gd
from gaitdisc.cohort.cohort import the_twelve
from gaitdisc.cohort.person import STIFFNESS, Person, Spring
from gaitdisc.cohort.walk import walked
from gaitdisc.discovery.discover import discover

MODEL = Path(__file__).with_name("tracked_ankle.toml")
WALK_S = 24.0
LATE_S, ADDED_KG, WEAK, SCALED = 0.04, 0.8, 0.75, 0.6
# what is hidden -> name and place that are right; a number that may move within its bounds is corrected, no finding
RIGHT = {
    "nothing": ("no_gap", ""),
    "spring": ("one_sided_spring", "ankle_moment"),
    "scaled moment": ("one_sided_spring", "ankle_moment"),
    "weak plantarflexor": ("correction", "strength"),
    "foot mass": ("correction", "foot_mass"),
    "late EMG": ("input_delay", "plantarflexors"),
}


def summary(table: pd.DataFrame) -> pd.DataFrame:
    """What is right, and how far off, by what was hidden."""
    rows = table.assign(off_percent=100 * (table["value"] / table["truth"] - 1).abs())
    groups = rows.assign(inside=rows["truth"].between(rows["low"], rows["high"])).groupby("hidden", sort=False)
    counts = groups.agg(n=("right", "size"), right=("right", "sum"), inside=("inside", "sum"))
    return counts.join(groups[["off_percent", "before", "after", "floor"]].median())


@dataclass(frozen=True)
class Setting:
    """How large the errors of the moments are (as in `ankle_trials`), whether they are stated, and which walks."""

    emg_error: float = 0.05
    others_nm: float = 1.5
    stated: bool = False
    seed: int = 0


def run(people_count: int, hidden: tuple[str, ...], setting: Setting) -> pd.DataFrame:
    """Hide each effect in each person's walk, and search; `before`, `after` and `floor` are errors held out [deg]."""
    people = the_twelve()[:people_count]
    return pd.DataFrame([found_in(person, effect, setting) for person in people for effect in hidden])


def found_in(person: Person, hidden: str, setting: Setting) -> dict[str, object]:
    """One walk, one search: what it says beside what is true."""
    size = {"spring": 1.0, "scaled moment": SCALED}.get(hidden, 0.0)
    spring = Spring(STIFFNESS * size) if size else None
    strength, added = WEAK if hidden == "weak plantarflexor" else 1.0, ADDED_KG if hidden == "foot mass" else 0.0
    walker = person.adapt_to(spring) if spring else replace(person, plantarflexors=strength, foot_kg=added)
    walk = walked(walker, spring, WALK_S + 4.0, seed=setting.seed + list(RIGHT).index(hidden))
    kg = own_foot_kg(person)
    measured = ankle_trials(walk, LATE_S if hidden == "late EMG" else 0.0, setting.emg_error, setting.others_nm)
    simulation = gd.read_simulation(MODEL).with_values({"foot_mass": kg})
    stated = with_stated_errors(simulation, setting.emg_error, setting.others_nm)
    found = discover(stated if setting.stated else simulation, measured)[0]
    moved = [one for one in found.corrections if not one.found.low <= one.given <= one.found.high]
    named = [(each.name, each.place) for each in found.effects] + [("correction", one.parameter) for one in moved]
    right = not named if hidden == "nothing" else RIGHT[hidden] in named
    row: dict[str, object] = {"person": person.name, "hidden": hidden, "verdict": found.verdict}
    row["named"] = ", ".join(f"{name} at {place}" for name, place in named)
    row |= {"right": right, "alone": right and len(named) <= 1}
    truth = {"weak plantarflexor": WEAK, "foot mass": kg + added, "late EMG": -LATE_S}
    row["truth"] = np.degrees(STIFFNESS) * size if size else truth.get(hidden, np.nan)
    effect = next((each for each in found.effects if (each.name, each.place) == RIGHT[hidden]), None)
    numbers = [next(iter(effect.estimates.values()))] if effect else []
    numbers += [one.found for one in moved if one.parameter == RIGHT[hidden][1]]
    if numbers:
        row |= {"value": numbers[0].value, "low": numbers[0].low, "high": numbers[0].high}
    if effect:
        if "engagement" in effect.estimates:
            row["engaged_rad"] = effect.estimates["engagement"].value
            row["engaged_truth_rad"] = np.radians(person.engaged_deg + person.style.offset_deg[0, 4])
        row["phase"] = next((each.phase for each in found.where if each.place == effect.place), ())
    sizes = zip(("before", "after", "floor"), np.degrees(found.held_out.channels["theta"]), strict=True)
    return dict.fromkeys(("value", "low", "high"), np.nan) | row | dict(sizes)


if __name__ == "__main__":
    effects = tuple(GIVEN.hidden.split(",")) if GIVEN.hidden else tuple(RIGHT)
    setting = Setting(GIVEN.emg_error, GIVEN.others_nm, GIVEN.stated, GIVEN.seed)
    table = run(1, ("spring",), Setting()) if GIVEN.quick else run(GIVEN.people, effects, setting)
    print(table.round(4).to_string(), summary(table).round(3).to_string(), sep="\n")
    if GIVEN.out:
        table.to_csv(GIVEN.out, index=False)
