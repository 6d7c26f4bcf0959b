"""Two files to try `gaitdisc discover` on: a simulation of an ankle, and a walk with a spring that it does not know of.

    python studies/hidden_spring.py OUT
    gaitdisc discover OUT/ankle.toml OUT/walk.csv --out OUT/found

One person of the embedded cohort walks 24 s on the exoskeleton, 286.5 N m/rad on each ankle, one-sided. The inputs are
the walk's own muscle moments with errors added that moments from EMG and inverse dynamics have at their best: those of
the plantarflexors waver by 10 %, those of all other muscles by 3 N m (standard deviations), and the centre of pressure
by 3 mm. The simulation is `tracked_ankle.toml` with that person's mass of the foot, and it states these errors: none
changes faster than 6 Hz, a memory of 0.04 s.
"""

from __future__ import annotations

from pathlib import Path

from command_line import argument, command_line

OUT = argument("out", "folder that gets ankle.toml and walk.csv", type=Path)
GIVEN = command_line(__name__, __doc__, OUT)  # before the slow imports

from dataclasses import replace

import numpy as np
import pandas as pd
from ankle_records import INPUTS, ankle_trials, own_foot_kg

import gaitdisc as gd
from gaitdisc.cohort.cohort import the_twelve
from gaitdisc.cohort.person import STIFFNESS, Spring
from gaitdisc.cohort.walk import walked

MODEL = Path(__file__).with_name("tracked_ankle.toml")
WALK_S, STARTING_S = 24.0, 4.0
EMG_ERROR, OTHERS_NM = 0.10, 3.0
PRESSURE_NM, MEMORY_S = 2.4, 0.04


def with_stated_errors(simulation: gd.Simulation, emg_error: float, others_nm: float) -> gd.Simulation:
    """The simulation that states the errors of its inputs."""
    stated = {"recorded": {"sd": PRESSURE_NM}, "plantarflexors": {"gain": emg_error}, "others": {"sd": others_nm}}
    inputs = (
        replace(one, wander=MEMORY_S, **stated[one.name]) if one.name in stated else one for one in simulation.inputs
    )
    return replace(simulation, inputs=tuple(inputs))


def run(folder: Path) -> tuple[Path, Path]:
    """Write `ankle.toml` and `walk.csv` into the folder."""
    person, spring = the_twelve()[0], Spring(STIFFNESS)
    walk = walked(person.adapt_to(spring), spring, WALK_S + STARTING_S, seed=1)
    simulation = gd.read_simulation(MODEL).with_values({"foot_mass": own_foot_kg(person)})
    gd.write_simulation(with_stated_errors(simulation, EMG_ERROR, OTHERS_NM), folder / "ankle.toml", overwrite=True)
    measured, tables = ankle_trials(walk, 0.0, EMG_ERROR, OTHERS_NM), []
    for number, trial in enumerate(measured.trials):
        count = int(measured.drive.samples[number])
        time, inputs = np.arange(count) / measured.rate, measured.drive.inputs[number, :count]
        values = np.column_stack([time, inputs, measured.observed[number, :count]])
        names = ["time", *INPUTS, *measured.channels]
        tables.append(pd.DataFrame(values, columns=pd.Index(names)).assign(trial=trial))
    pd.concat(tables).to_csv(folder / "walk.csv", index=False, float_format="%.6g")
    return folder / "ankle.toml", folder / "walk.csv"


if __name__ == "__main__":
    print(*run(GIVEN.out))
