"""Seconds and memory of `gaitdisc discover` on a model of many states and on a record of many rows.

    python benchmarks/large_models.py [--masses 10] [--noise 0.02] [--seed 1]

A chain of masses between springs and dampers (20 states with ten masses) in four trials of 10 s at 100 Hz, 4,000 rows,
and one mass in four trials of 250 s, 100,000 rows; each mass' place is observed. Each once with a stiffening spring at
the third (or only) mass left out of the model and once with nothing left out; the last trial is held out. Every answer
is a process of its own: its processor seconds, its clock and its peak memory.
"""

from __future__ import annotations

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "studies"))
from command_line import argument, command_line

GIVEN = command_line(
    __name__,
    __doc__,
    argument("--masses", "of the chain, two states each", 10),
    argument("--noise", "standard deviation of the noise over that of each channel", 0.02),
    argument("--seed", "of drives and noise", 1),
)  # before the slow imports

import resource
import time
from itertools import pairwise
from multiprocessing import get_context

import numpy as np
from driven_trials import Driven, Sensed, recorded

import gaitdisc as gd
from gaitdisc.simulation.parts import Input, Parameter, Port, State, Term
from gaitdisc.simulation.simulation import Simulation

STIFFENING = 300.0  # N/m^3


def chain(masses: int) -> Simulation:
    """Masses in a row between springs and dampers, both ends held, the first one driven."""
    links = [("0", "0"), *((f"x{k}", f"v{k}") for k in range(1, masses + 1)), ("0", "0")]
    pull = [f"(k*({b} - {a}) + c*({d} - {c}))" for (a, c), (b, d) in pairwise(links)]
    driven = {1: "force + "}
    equations = [(f"x{k}", f"v{k}") for k in range(1, masses + 1)]
    for k in range(1, masses + 1):
        equations.append((f"v{k}", f"({driven.get(k, '')}load_{k} - {pull[k - 1]} + {pull[k]})/m"))
    return Simulation(
        f"Chain of {masses}",
        tuple(State(name, "m" if name[0] == "x" else "m/s") for name, _ in equations),
        inputs=(Input("force", "N"),),
        parameters=(Parameter("m", 1.0, "kg"), Parameter("k", 40.0, "N/m"), Parameter("c", 0.6, "N s/m")),
        ports=tuple(Port(f"load_{k}", "N") for k in range(1, masses + 1)),
        equations=tuple(equations),
        observations=tuple((f"x{k}", f"x{k}") for k in range(1, masses + 1)),
    )


def answered(masses: int, seconds: float, hidden: bool, noise: float, seed: int) -> str:
    """What is said of one record, with its cost."""
    model, place = chain(masses), min(3, masses)
    term = Term(f"load_{place}", "port", "cubic_stiffness", f"-{STIFFENING}*x{place}**3")
    driven = Driven((12.0,), 0.2, 2.0, seconds=seconds)
    truth = model.with_effect(term) if hidden else model
    measured = recorded(truth, driven, Sensed(noise), np.random.default_rng(seed))
    wall, processor = time.perf_counter(), time.process_time()
    found, _ = gd.discover(model, measured)
    wall, processor = time.perf_counter() - wall, time.process_time() - processor
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    said = ", ".join(f"{one.name} at {one.place}" for one in found.effects) or found.verdict
    wanted = f"cubic_stiffness at load_{place}" if hidden else "no_gap"
    rows = int(measured.samples.sum())
    return (
        f"{2 * masses} states, {rows:,} rows, {wanted}: {said}; {processor:.1f} s of the processor, {wall:.1f} s by "
        f"the clock, {peak:.0f} MB"
    )


if __name__ == "__main__":
    for masses, seconds in ((GIVEN.masses, 10.0), (1, 250.0)):
        for hidden in (True, False):
            with get_context("spawn").Pool(1) as pool:
                print(pool.apply(answered, (masses, seconds, hidden, GIVEN.noise, GIVEN.seed)), flush=True)
