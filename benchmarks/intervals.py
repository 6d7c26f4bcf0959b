"""Share of test states inside the 90 % interval: temporal split, and one person left out.

    python benchmarks/intervals.py treadmill|cohort [--people 12] [--split temporal|subject] [--kinds "delay ridge,..."]

Mean over all reconstructed states and people, and the least and largest of the people; `plain` is the split conformal
quantile that takes every window for an independent one, and for a person left out the checked person alone.
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
    argument("--people", "the first so many of the cohort", 12),
    argument("--split", "what is held out", "temporal", choices=("temporal", "subject")),
    argument("--kinds", "models, with commas between", "linear,delay ridge,fourier ridge"),
    argument("--every", "test every n-th person", 1),
)  # before the slow imports

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np
from numpy.typing import NDArray
from sensing_walks import Person, chosen_walks

from gaitdisc.reconstruction.reconstruct import cross_widths
from gaitdisc.reconstruction.state_errors import LEVEL, coverage, half_widths
from gaitdisc.reconstruction.window_model import fit_reconstructor
from gaitdisc.reconstruction.windows import PERSON_OUT, Parts, split_by_subject, split_within
from gaitdisc.recording import Samples


def main() -> None:
    people = chosen_walks(GIVEN.walks, GIVEN.people)
    windows = [person.windows() for person in people]
    for kind in GIVEN.kinds.split(","):
        tested = range(0, len(people), GIVEN.every)
        found = np.array([shares(kind, people[k], parts_of(windows, k, GIVEN.split)) for k in tested])
        said = [f"{name} {100 * v.mean():.1f} % ({100 * v.min():.0f} to {100 * v.max():.0f})"
                for name, v in zip(("plain", "ours"), found.T, strict=True)]  # fmt: skip
        print(f"{GIVEN.walks}, {GIVEN.split}, {kind}: {', '.join(said)}", flush=True)


def parts_of(windows: list[list[Samples]], tested: int, split: str) -> Parts:
    """Parts of one person's windows, or of everybody's."""
    if split == "subject":
        return split_by_subject(windows, tested)
    return split_within(windows[tested], split, 1.0)


def shares(kind: str, person: Person, parts: Parts) -> tuple[float, float]:
    """Coverage of the plain interval and of ours."""
    what, check, test = person.what, parts.checked(), parts.tested()
    done = fit_reconstructor(kind, what, parts.fitted(), check)
    missed, errors = done(check) - check.y, done(test) - test.y
    half = cross_widths(kind, what, parts, missed) if parts.rule == PERSON_OUT else half_widths(missed)
    return float(coverage(errors, plain(missed)).mean()), float(coverage(errors, half).mean())


def plain(missed: NDArray[np.float64]) -> NDArray[np.float64]:
    """Quantile of the absolute errors, every one of them counted."""
    return np.sort(np.abs(missed), axis=0)[int(np.ceil((len(missed) + 1) * LEVEL)) - 1]


if __name__ == "__main__":
    main()
