"""A motor axis whose linear model lacks dry friction: what is named first, its size, and what is left.

    python studies/emps.py [DATA] [--quick]

DATA holds DATA_EMPS.mat of Janot, Gautier and Brunot (2019), nonlinearbenchmark.org, by default
../shared/data/hidden_effect/emps (or GAITDISC_DATA/hidden_effect/emps), and DATA_EMPS_PULSES.mat where it was got too:
there the motor gives pulses that the first record has not. The record is cut into stretches of half a second; the last
quarter of them, and all of the second file, are never fitted: in each only the start is found.
"""

from __future__ import annotations

from command_line import QUICK, SHARED, argument, command_line

GIVEN = command_line(
    __name__, __doc__, argument("data", "folder that holds DATA_EMPS.mat", SHARED / "hidden_effect" / "emps"), QUICK
)  # before the slow imports

from dataclasses import dataclass
from pathlib import Path

import numpy as np

import gaitdisc as gd
from gaitdisc.discovery.discover import discover
from gaitdisc.discovery.forward_selection import select_forward
from gaitdisc.discovery.held_out import Trial, runs_of
from gaitdisc.discovery.problem import Problem, set_up_problem
from gaitdisc.discovery.scored_model import ScoredModel
from gaitdisc.simulation.measured import Measured, TrialColumns, measured_of_trials

MODEL = Path(__file__).with_name("emps.toml")
PUBLISHED_N = 20.3935
EVERY, RATE_HZ, STRETCH_S = 10, 100.0, 0.5


@dataclass(frozen=True, eq=False)
class Result:
    """What was found."""

    named: str
    place: str
    friction_n: float  # [N]
    left_mm: dict[str, tuple[float, float]]  # free-run error before and after, held-out stretches and pulses
    whole: gd.Discovery | None


def run(quick: bool, data: Path) -> Result:
    """Search the first record; test on its end, and on the pulses where they are there."""
    simulation = gd.read_simulation(MODEL)
    measured = stretches(data / "DATA_EMPS.mat", simulation)
    problem = set_up_problem(simulation, measured)
    as_read = problem.as_read()
    first, _ = select_forward(problem.search, as_read, 1)
    part = first.model.parts[0]
    runs = {"held-out stretches": free_runs(problem, problem.held_out, as_read, first)}
    if (data / "DATA_EMPS_PULSES.mat").exists():
        pulses = set_up_problem(simulation, stretches(data / "DATA_EMPS_PULSES.mat", simulation))
        runs["pulses"] = free_runs(pulses, (*pulses.learned, *pulses.held_out), as_read, first)
    left = {name: (rms(before), rms(after)) for name, (before, after) in runs.items()}
    whole = None if quick else discover(simulation, measured)[0]
    named, place = part.candidate.name, part.candidate.place
    return Result(named, place, -part.values.get("factor", float("nan")), left, whole)


def stretches(path: Path, simulation: gd.Simulation) -> Measured:
    """Trials of half a second: force of the motor [N], position [mm]."""
    from scipy.io import loadmat
    from scipy.signal import decimate

    record = loadmat(path)
    force = record["vir"].ravel() * record["gtau"].item()
    slow = np.column_stack([decimate(one, EVERY, ftype="fir") for one in (force, 1000 * record["qm"].ravel())])
    length = int(STRETCH_S * RATE_HZ)
    trials = [
        TrialColumns(
            str(n + 1), np.arange(at, at + length) / RATE_HZ, slow[at : at + length, :1], slow[at : at + length, 1:]
        )
        for n, at in enumerate(range(0, len(slow) - length, length))
    ]
    return measured_of_trials(trials, ("force",), tuple(name for name, _ in simulation.observations), path.name)


def free_runs(
    problem: Problem, trials: tuple[int, ...], before: ScoredModel, after: ScoredModel
) -> tuple[Trial, Trial]:
    """Runs of the model as read and with what was named, over trials that were not fitted."""
    return runs_of(problem, before, trials, after), runs_of(problem, after, trials, after)


def rms(runs: Trial) -> float:
    """Root mean square error of free runs [mm]."""
    return float(np.sqrt(np.mean(runs.fit.residual**2)))


def lines(found: Result) -> list[str]:
    """What is printed, to the digits that an older processor gives too: at the corner of sign(v) rounding decides."""
    off = 100 * (found.friction_n / PUBLISHED_N - 1)
    named = f"{found.named} at {found.place}"
    said = [f"named first: {named}, {found.friction_n:.0f} N ({off:+.0f} % of {PUBLISHED_N:g} N)"]
    for name, (before, after) in found.left_mm.items():
        less = 100 * (1 - after / before)
        said.append(f"{name}: free-run error {before:.2f} mm -> {after:.2f} mm ({less:.0f} % less)")
    if found.whole:
        said.append(found.whole.sentence)
        said += [f"  weighed too: {each.name} at {each.place}" for each in found.whole.rivals]
    return said


if __name__ == "__main__":
    print(*lines(run(GIVEN.quick, GIVEN.data)), sep="\n")
