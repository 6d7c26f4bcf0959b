"""Five systems that `discover` was not built with, with something hidden in them or nothing: is it named.

    python studies/joints_and_chains.py [--seeds N] [--noise SHARE] [--off SHARE] [--lowpass HZ] [--system NAME]

A two-link leg with a stop at its knee, an ankle with an exoskeleton's spring, an elbow with dry friction, a standing
person with delayed feedback, a chain of four masses with a spring that stiffens; and each of them with nothing hidden.
Numbers are drawn anew for each seed. Four trials of 8 s at 100 Hz, the last one held out.
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
import tomllib
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np
from driven_trials import Driven, Sensed, recorded

import gaitdisc as gd

SYSTEMS = Path(__file__).parent / "systems"


class Hidden(NamedTuple):
    """What is missing in a model; `{a}` and `{b}` of its term are drawn between their limits."""

    model: str
    port: str
    effect: str
    term: str
    a: list[float]
    b: list[float]
    driven_by: list[float]
    fastest_hz: float


FILE = Path(__file__).with_suffix(".toml")
KNOWN = {name: Hidden(**each) for name, each in tomllib.loads(FILE.read_text(encoding="utf-8")).items()}


def model_of(hidden: Hidden) -> gd.Simulation:
    """The model as its author believes it."""
    own = SYSTEMS / f"{hidden.model}.toml"
    return gd.read_simulation(own) if own.is_file() else gd.bundled_simulation(hidden.model)


def complete(model: gd.Simulation, hidden: Hidden, rng: np.random.Generator) -> gd.Simulation:
    """The model with what is hidden in it."""
    a, b = (f"{rng.uniform(low, high):.4g}" for low, high in (hidden.a, hidden.b))
    return model.with_effect(gd.Term(hidden.port, "port", hidden.effect, hidden.term.format(a=a, b=b)))


def put_off(model: gd.Simulation, share: float, rng: np.random.Generator) -> gd.Simulation:
    """The model with each number a little wrong, and bounds that say so."""
    wrong = []
    for one in model.parameters:
        value = one.value * (1 + share * float(np.clip(rng.standard_normal(), -2, 2)))
        low, high = sorted((value * (1 - 2.5 * share), value * (1 + 2.5 * share)))
        wrong.append(replace(one, value=value, low=low, high=high))
    return replace(model, parameters=tuple(wrong)) if share else model


class Record(NamedTuple):
    """How a record comes: noise and error of the numbers as shares, cut-off [Hz], 0 for none."""

    noise: float
    off: float
    lowpass_hz: float


def answer(name: str, seed: int, record: Record, nothing: bool) -> tuple[str, float]:
    """What is named, `nothing` where the model agrees, and the seconds that it took."""
    hidden, rng = KNOWN[name], np.random.default_rng([seed, list(KNOWN).index(name), nothing])
    model = model_of(hidden)
    truth = model if nothing else complete(model, hidden, rng)
    driven = Driven(tuple(hidden.driven_by), 0.2, hidden.fastest_hz)
    measured = recorded(truth, driven, Sensed(record.noise, record.lowpass_hz), rng)
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
            said = f"; instead: {', '.join(others)}" if others else ""
            right = f"{seeds - len(others)} of {seeds}, median {np.median([one[1] for one in answers]):.0f} s"
            lines.append(f"{name}, {wanted.replace('_', ' ')}: {right}{said}")
            print(lines[-1], file=sys.stderr, flush=True)
    return lines


if __name__ == "__main__":
    record = Record(GIVEN.noise, GIVEN.off, GIVEN.lowpass)
    names = [GIVEN.system] if GIVEN.system else list(KNOWN)
    print("\n".join(run(names, 1 if GIVEN.quick else GIVEN.seeds, record)))
