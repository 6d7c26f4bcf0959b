"""Error of reconstruction against the share of readings that are missing, on walks of which models saw another part.

    python benchmarks/missing_values.py treadmill|cohort [--people 4] [--seed 0]

Readings of each sensor go missing by themselves, one by one or in drop-outs of 0.2 s on average, in the test part
(temporal split). Ridge regression and SHRED read the training mean or the last known value in their place. `masked
shred` is given which are missing, and was fitted to windows of which every second had lost up to 60 %; so was `fourier
ridge, marks given`, its rival: the same values and marks as columns. RMSE [deg] over angles that no sensor measures.
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
    argument("--seed", "of what goes missing and of the fits", 0),
)  # before the slow imports

import os
from collections.abc import Callable
from dataclasses import replace

os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np
from numpy.typing import NDArray
from sensing_walks import Person, chosen_walks

from gaitdisc.models.fourier_ridge import fit_fourier_ridge
from gaitdisc.reconstruction.window_model import FEATURES, MASKED, WindowModel, fit_reconstructor
from gaitdisc.reconstruction.windows import Parts, fill_readings, hidden, split_within, with_missing
from gaitdisc.recording import Samples

SHARES = (0.0, 0.1, 0.2, 0.3, 0.4, 0.5)
RUNS_S = (0.0, 0.2)
FILLED = [("delay ridge", "mean"), ("delay ridge", "last"), ("fourier ridge", "mean"), ("fourier ridge", "last")]
FILLED += [("shred", "mean"), ("shred", "last")]
Reconstruct = Callable[[Samples], NDArray[np.float64]]


def main() -> None:
    people = chosen_walks(GIVEN.walks, GIVEN.people)
    found = np.array([curves(person, GIVEN.seed) for person in people])  # (person, run, share, model)
    names = [*(f"{kind}, {way}" for kind, way in FILLED), "fourier ridge, marks given", MASKED]
    for run, table in zip(RUNS_S, np.sqrt(np.mean(found, axis=0)), strict=True):
        print(f"{len(people)} people; drop-outs of {run:g} s; RMSE [deg] at {', '.join(f'{s:.0%}' for s in SHARES)}")
        for name, row in zip(names, table.T, strict=True):
            print(f"  {name:<27}" + "".join(f"{value:8.2f}" for value in row))


def curves(person: Person, seed: int) -> NDArray[np.float64]:
    """Mean squared error over the angles (run, share, model) [deg2]."""
    what = person.what
    whole = parts(person, 0.0, 0.0, seed)
    kinds = dict.fromkeys([*(kind for kind, _ in FILLED), MASKED])
    fitted = {kind: fit_reconstructor(kind, what, whole.fitted(), whole.checked(), seed) for kind in kinds}
    count = len(what.sensors)
    training, check = (hidden(part, count, seed + k) for k, part in enumerate((whole.fitted(), whole.checked())))
    means = np.nanmean(training.x, axis=0)
    ridge = fit_fourier_ridge(with_marks(training, means), with_marks(check, means), FEATURES, seed)
    angles = person.angles
    found = np.empty((len(RUNS_S), len(SHARES), len(FILLED) + 2))
    for i, run_s in enumerate(RUNS_S):
        for j, share in enumerate(SHARES):
            lost = parts(person, share, run_s, seed).tested()
            for k, (kind, way) in enumerate(FILLED):
                test = parts(person, share, run_s, seed, (fitted[kind], way)).tested()
                found[i, j, k] = np.mean((fitted[kind](test) - test.y)[:, angles] ** 2)
            masked = ridge(with_marks(lost, means).x), fitted[MASKED](lost)
            found[i, j, -2:] = [np.mean((each - lost.y)[:, angles] ** 2) for each in masked]
    return found


def parts(
    person: Person, share: float, run_s: float, seed: int, filling: tuple[WindowModel, str] | None = None
) -> Parts:
    """Windows of all walks that have lost readings, filled or not, and parted in time."""
    what, windows = person.what, []
    for number, walk in enumerate(person.walks.people[person.name]):
        recording = with_missing(walk.recording, what.sensors, share, run_s, 100 * seed + number)
        if filling:
            recording = fill_readings(recording, what.sensors, filling[1], filling[0].sensor_means)
        windows.append(what.windows(recording, walk.phi, missing=True))
    return split_within(windows, "temporal", what.reach_s)


def with_marks(samples: Samples, means: NDArray[np.float64]) -> Samples:
    """Values, or means where they are missing, and marks of that: inputs of a rival that is given them, too."""
    lost = np.isnan(samples.x)
    x = np.hstack([np.where(lost, means, samples.x), lost])
    return replace(samples, x=x, inputs=(*samples.inputs, *(f"{name} missing" for name in samples.inputs)))


if __name__ == "__main__":
    main()
