"""Five systems that `discover` was not built with, with something hidden in them or nothing: is it named.

    python studies/joints_and_chains.py [--seeds N] [--noise SHARE] [--off SHARE] [--lowpass HZ] [--system NAME]

A two-link leg with a stop at its knee, an ankle with an exoskeleton's spring, an elbow with dry friction, a standing
person with delayed feedback, a chain of four masses with a spring that stiffens; and each of them with nothing hidden.
Numbers are drawn anew for each seed. As measured records come: white noise, every number of the file off within its
bounds, the record low-passed (Butterworth of order 2, forwards and back) and the filter not stated. Four trials of 8 s
at 100 Hz, the last one held out.
"""

from __future__ import annotations

from command_line import QUICK, argument, command_line

GIVEN = command_line(
    __name__,
    __doc__,
    argument("--seeds", "how often each is hidden", 3),
    argument("--noise", "standard deviation of the noise over that of each channel", 0.02),
    argument("--off", "standard deviation by which each number of the file is wrong, as a share", 0.05),
    argument("--lowpass", "cut-off of the record's filter [Hz]; 0 for none", 6.0),
    argument("--system", "one of them alone", ""),
    QUICK,
)  # before the slow imports

import sys
import time
from typing import NamedTuple

import numpy as np
import pandas as pd
from driven_trials import Driven, Sensed
from driven_trials import recorded as trials_of
from hidden_in_systems import KNOWN, Hidden, complete, model_of, put_off

import gaitdisc as gd


class Record(NamedTuple):
    """How a record comes: noise and error of the numbers as shares, cut-off [Hz], 0 for none."""

    noise: float
    off: float
    lowpass_hz: float


def recorded(truth: gd.Simulation, hidden: Hidden, record: Record, rng: np.random.Generator) -> pd.DataFrame:
    """Trials of the true system, driven by sums of sines, as they come from a laboratory."""
    driven = Driven(tuple(hidden.driven_by), 0.2, hidden.fastest_hz)
    return trials_of(truth, driven, Sensed(record.noise, record.lowpass_hz), rng)


def answer(name: str, seed: int, record: Record, nothing: bool) -> tuple[str, float]:
    """What is named, `nothing` where the model agrees, and the seconds that it took."""
    hidden, rng = KNOWN[name], np.random.default_rng([seed, list(KNOWN).index(name), nothing])
    model = model_of(hidden)
    truth = model if nothing else complete(model, hidden, rng)
    measured = recorded(truth, hidden, record, rng)
    started = time.process_time()
    found, _ = gd.discover(put_off(model, record.off, rng), measured)
    names = " and ".join(one.name for one in found.effects)
    return names or found.verdict.replace("no_gap", "nothing"), time.process_time() - started


def run(names: list[str], seeds: int, record: Record) -> list[str]:
    """A line for each system, with what was named instead, and the processor time of an answer."""
    lines = []
    for name in names:
        for nothing, wanted in ((False, KNOWN[name].effect), (True, "nothing")):
            answers = [answer(name, seed, record, nothing) for seed in range(seeds)]
            others = [found for found, _ in answers if found != wanted]
            median = np.median([seconds for _, seconds in answers])
            said = f"; instead: {', '.join(others)}" if others else ""
            lines.append(
                f"{name}, {wanted.replace('_', ' ')}: {seeds - len(others)} of {seeds}, median {median:.0f} s{said}"
            )
            print(lines[-1], file=sys.stderr, flush=True)
    return lines


if __name__ == "__main__":
    record = Record(GIVEN.noise, GIVEN.off, GIVEN.lowpass)
    names = [GIVEN.system] if GIVEN.system else list(KNOWN)
    print("\n".join(run(names, 1 if GIVEN.quick else GIVEN.seeds, record)))
