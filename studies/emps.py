"""A motor axis whose linear model lacks dry friction: what is named first, its size, and what is left.

    python studies/emps.py [DATA] [--quick]

DATA holds DATA_EMPS.mat of Janot, Gautier and Brunot (2019), nonlinearbenchmark.org, and DATA_EMPS_PULSES.mat where it
was got too: there the motor gives pulses that the first record has not. The record is cut into stretches of half a
second; the last quarter of them, and all of the second file, are never fitted: in each only the start is found.
"""

from __future__ import annotations

from command_line import QUICK, SHARED, argument, command_line

DATA = argument("data", "folder that holds DATA_EMPS.mat", SHARED / "hidden_effect" / "emps")
GIVEN = command_line(__name__, __doc__, DATA, QUICK)  # before the slow imports

from dataclasses import dataclass
from pathlib import Path

import numpy as np

import gaitdisc as gd
from gaitdisc.discovery.case import Case, set_up_case
from gaitdisc.discovery.discover import discover
from gaitdisc.discovery.forward_selection import select_forward
from gaitdisc.discovery.held_out import run_trials
from gaitdisc.discovery.scored_model import ScoredModel
from gaitdisc.simulation.measured import Measured, TrialColumns, check_measured

MODEL = Path(__file__).with_name("emps.toml")
PUBLISHED_N = 20.3935
EVERY, RATE_HZ, STRETCH_S = 10, 100.0, 0.5


@dataclass(frozen=True, eq=False)
class Result:
    """What was found."""

    named: str
    place: str
    friction_n: float  # [N]
    left_mm: dict[str, tuple[float, ...]]  # free-run error before and after, held-out stretches and pulses
    whole: gd.Discovery | None


def run(quick: bool, data: Path) -> Result:
    """Search the first record; test on its end, and on the pulses where they are there."""
    simulation = gd.read_simulation(MODEL)
    measured = stretches(data / "DATA_EMPS.mat", simulation)
    case = set_up_case(simulation, measured)
    as_read = case.as_read()
    first, _ = select_forward(case.search, as_read, 1)
    part = first.parts[0]
    left = {"held-out stretches": errors_mm(case, case.held_out, as_read, first)}
    if (data / "DATA_EMPS_PULSES.mat").exists():
        pulses = set_up_case(simulation, stretches(data / "DATA_EMPS_PULSES.mat", simulation))
        left["pulses"] = errors_mm(pulses, (*pulses.learned, *pulses.held_out), as_read, first)
    whole = None if quick else discover(simulation, measured)[0]
    friction_n = -part.values.get("factor", float("nan"))
    return Result(part.candidate.name, part.candidate.place, friction_n, left, whole)


def stretches(path: Path, simulation: gd.Simulation) -> Measured:
    """Trials of half a second: force of the motor [N], position [mm]."""
    from scipy.io import loadmat
    from scipy.signal import decimate

    record = loadmat(path)
    force = record["vir"].ravel() * record["gtau"].item()
    slow = np.column_stack([decimate(one, EVERY, ftype="fir") for one in (force, 1000 * record["qm"].ravel())])
    length = int(STRETCH_S * RATE_HZ)
    cuts = [np.arange(at, at + length) for at in range(0, len(slow) - length, length)]
    trials = [TrialColumns(str(n), cut / RATE_HZ, slow[cut, :1], slow[cut, 1:]) for n, cut in enumerate(cuts, 1)]
    return check_measured(trials, ("force",), tuple(name for name, _ in simulation.observations), path.name)


def errors_mm(case: Case, trials: tuple[int, ...], *models: ScoredModel) -> tuple[float, ...]:
    """Root mean square of free runs of the model as read and with what was named, on trials not fitted [mm]."""
    runs = (run_trials(case, model, trials, models[-1]) for model in models)
    return tuple(float(np.sqrt(np.mean(run.fit.residual**2))) for run in runs)


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
