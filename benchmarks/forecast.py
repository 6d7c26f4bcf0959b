"""Error of the states forecast some time ahead, against that time; persistence and the mean stride beside it.

    python benchmarks/forecast.py treadmill|cohort [--people 4] [--networks]

RMSE over the angles that no sensor measures [deg], root of the mean square over people; temporal split. Persistence
knows all states at the time of the forecast; the mean stride knows the contacts up to then; models know three sensors.
"""

from __future__ import annotations

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "studies"))
from command_line import argument, command_line

GIVEN = command_line(
    __name__,
    __doc__,
    argument("walks", "which walks", choices=("treadmill", "cohort")),
    argument("--people", "the first so many of the cohort", 4),
    argument("--networks", "networks as well as ridge regressions", False),
)  # before the slow imports

import os
from dataclasses import replace

os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np
from sensing_walks import LAGS, Person, chosen_walks

from gaitdisc.reconstruction.reconstruct import Fits, reconstruct
from gaitdisc.reconstruction.window_model import sensing

AHEAD = (0, 5, 10, 20, 30, 50)  # samples


def main() -> None:
    people = chosen_walks(GIVEN.walks, GIVEN.people)
    kinds = ("linear", "delay ridge", "fourier ridge") + (("shred",) if GIVEN.networks else ())
    for ahead in AHEAD:
        found = [errors(person, ahead, kinds) for person in people]
        mean = {name: np.sqrt(np.mean([each[name] for each in found])) for name in found[0]}
        print(f"{ahead / 100:.2f} s: " + ", ".join(f"{name} {value:.2f}" for name, value in mean.items()), flush=True)


def errors(person: Person, ahead: int, kinds: tuple[str, ...]) -> dict[str, float]:
    """Mean squared error of every model over the angles that no sensor measures [deg2]."""
    names = tuple(channel.name for channel in person.walks.channels)
    what = sensing(names, person.what.sensors, replace(LAGS, ahead=ahead), person.what.rate_hz)
    ahead_of = replace(person, what=what)
    done = reconstruct(person.name, ahead_of.parts(), what, ahead_of.channels, Fits(kinds))
    angles = [c.name for c in ahead_of.channels if c.unit == "deg" and c.name not in what.sensors]
    table = done.errors[done.errors["state"].isin(angles)]
    squares = (table["rmse"] ** 2).groupby(table["model"], sort=False).mean()
    return {str(name): float(value) for name, value in squares.items()}


if __name__ == "__main__":
    main()
