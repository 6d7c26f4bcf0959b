"""A simulation that leaves all bounds before it can be compared with anything is refused, with place and parameter."""

from __future__ import annotations

import numpy as np

from gaitdisc.discovery.problem import FEWEST_SAMPLES, set_up_problem
from gaitdisc.discovery.spiked_samples import without_spikes
from gaitdisc.simulation.divergence import refuse_divergence
from gaitdisc.simulation.drive import Rows
from gaitdisc.simulation.measured import Measured
from gaitdisc.simulation.running import compile_simulation
from gaitdisc.simulation.simulation import Simulation

MOST_LOST = 0.2  # of the shortest runs; a few may begin at a bad guess of what is not measured


def refuse_blow_up(simulation: Simulation, measured: Measured) -> None:
    """Refuse a simulation that does not stay finite over runs of a few samples that begin at the data."""
    problem, machine = set_up_problem(simulation, without_spikes(measured)), compile_simulation(simulation)
    segments = problem.segments((*problem.learned, *problem.held_out), 0.0)
    rows = Rows(segments.trial, segments.begin, problem.guess.starts(segments))
    drive = problem.measured.drive
    states, ok = machine.run(drive, rows, FEWEST_SAMPLES - 1)
    if np.mean(~ok) > MOST_LOST:
        refuse_divergence(machine, drive, rows, states, ok)
