"""SHRED from five seeds: error of one and of their mean, coverage, and whether their spread shows where the error is.

    python benchmarks/ensemble.py treadmill|cohort [--people 3]

Temporal split, angles that no sensor measures. The rank correlation is of the spread among the members and the absolute
error of their mean, over windows, mean over states.
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
    argument("--people", "the first so many of the cohort", 3),
)  # before the slow imports

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np
from scipy.stats import spearmanr
from sensing_walks import Person, chosen_walks

from gaitdisc.reconstruction.state_errors import coverage, half_widths
from gaitdisc.reconstruction.window_model import ENSEMBLE, Ensemble, fit_reconstructor


def main() -> None:
    for person in chosen_walks(GIVEN.walks, GIVEN.people):
        print(line(person), flush=True)


def line(person: Person) -> str:
    """What is found for one person."""
    what = person.what
    parts, angles = person.parts(), person.angles
    check, test = parts.checked(), parts.tested()
    done = fit_reconstructor(ENSEMBLE, what, parts.fitted(), check)
    ridge = fit_reconstructor("fourier ridge", what, parts.fitted(), check)
    assert isinstance(done.model, Ensemble)
    errors = (done(test) - test.y)[:, angles]
    single = [np.sqrt(np.mean((member(test.x) - test.y)[:, angles] ** 2)) for member in done.model.members]
    other = np.sqrt(np.mean((ridge(test) - test.y)[:, angles] ** 2))
    spread = done.model.spread(test.x)[:, angles]
    ranks = [float(np.asarray(spearmanr(spread[:, k], np.abs(errors[:, k])))[0]) for k in range(len(angles))]
    inside = coverage(errors, half_widths((done(check) - check.y)[:, angles])).mean()
    return (
        f"{person.name}: one {np.mean(single):.2f} ({min(single):.2f} to {max(single):.2f}), mean of five "
        f"{np.sqrt(np.mean(errors**2)):.2f}, fourier ridge {other:.2f} deg; inside {100 * inside:.0f} %; spread "
        f"{np.sqrt(np.mean(spread**2)):.2f} deg, rank correlation with the error {np.mean(ranks):.2f}; "
        f"{done.seconds:.0f} s"
    )


if __name__ == "__main__":
    main()
