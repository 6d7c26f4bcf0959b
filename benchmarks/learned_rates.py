"""A network in the dynamics: ours compiled, beside `solve_ivp` with a network call in every stage, in one run.

    python benchmarks/learned_rates.py [--noise 0.001] [--seed 0] [--direct-s 20]

Van der Pol (text) and Lorenz, 30 s learned from, 20 s forecast, a network a state as in chapter 3's grid. Both ways
integrate the same known rates with the same weights from the same start. Printed: seconds of a core to fit, to run
the forecast by each way, network calls, how far both are apart over the first three seconds (Lorenz is chaotic), and
how much less RMSE the forecast has than that of the known model, beside the Gaussian process on the same record.
"""

from __future__ import annotations

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "studies"))
from command_line import argument, command_line

GIVEN = command_line(
    __name__,
    __doc__,
    argument("--noise", "of the record, share of the signal", 0.001),
    argument("--seed", "of the noise", 0),
    argument("--direct-s", "length of the run by solve_ivp [s]", 20.0),
)  # before the slow imports

import time as clock

import numpy as np
import pandas as pd
from chapter3.augmented_run import with_learned_rates
from chapter3.cell import ORACLE, learned_model, part
from chapter3.methods import MethodSettings
from chapter3.record import Conditions, Rates, Record, System, recorded, system_of
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from gaitdisc.model import Model
from gaitdisc.simulation.parts import Term
from gaitdisc.simulation.simulation_file import bundled

TOLERANCE = 1e-8  # of solve_ivp, RK45: its own default of 1e-3 is no match for what is learned
TOGETHER_S = 3.0


def systems() -> dict[str, System]:
    """Van der Pol as in the text, and Lorenz."""
    return {
        "Van der Pol": system_of(bundled("van_der_pol"), Term("y", "equation", "cubic_stiffness", "-0.01*x**3")),
        "Lorenz": system_of(bundled("lorenz"), Term("x", "equation", "cubic", "0.01*x**3")),
    }


def direct(
    known: Rates, learned: Model, start: NDArray[np.float64], time: NDArray[np.float64]
) -> tuple[NDArray[np.float64], int]:
    """States as a user's own script integrates them, and how often the network was called."""
    found = solve_ivp(
        lambda _, x: known(x[None])[0] + learned(x[None])[0],
        (time[0], time[-1]),
        start,
        t_eval=time,
        rtol=TOLERANCE,
        atol=TOLERANCE,
    )
    return found.y.T, found.nfev


def line(name: str, record: Record, direct_s: float) -> dict[str, object]:
    """All numbers of one system."""
    begun = clock.process_time()
    network = learned_model(record, "nn", "dynamics", MethodSettings())
    fitted = clock.process_time() - begun
    begun = clock.process_time()
    process = learned_model(record, "gp", "dynamics", MethodSettings())
    process_s = clock.process_time() - begun
    time, start = record.time[record.split - 1 :], record.start(forecast=True)
    time = time[time <= time[0] + direct_s]
    with_learned_rates(record.system.known, network, start, time[:10])  # compiles, where that was not done before
    begun = clock.process_time()
    ours = with_learned_rates(record.system.known, network, start, time).values
    ours_s = clock.process_time() - begun
    begun = clock.process_time()
    theirs, calls = direct(record.system.known, network, start, time)
    theirs_s = clock.process_time() - begun
    together = time[: len(theirs)] <= time[0] + TOGETHER_S
    apart = np.abs(ours[: len(theirs)][together] - theirs[together]).max() / ours[together].std()
    accuracy = [np.median(part(record, each, "dynamics", ORACLE).accuracy()) for each in (network, process)]
    return {
        "system": name,
        "fit network [s]": fitted,
        "fit Gaussian process [s]": process_s,
        "run, ours [s]": ours_s,
        "run, direct [s]": theirs_s,
        "network calls": calls,
        "times faster": theirs_s / ours_s,
        "apart in 3 s [SD]": apart,
        "network [%]": accuracy[0],
        "Gaussian process [%]": accuracy[1],
    }


if __name__ == "__main__":
    made = Conditions(noise=GIVEN.noise, seed=GIVEN.seed)
    lines = [line(name, recorded(system, made), GIVEN.direct_s) for name, system in systems().items()]
    print(pd.DataFrame(lines).set_index("system").T.to_string(float_format=lambda value: f"{value:.3g}"))
