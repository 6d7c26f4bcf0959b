"""States that an effect brings along: no channel shows them, so they begin where the data before put them.

Along the states of the record, known already, each is a differential equation driven by measured signals; its course
over whole trials gives the start of every run, from which the fit goes on.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from gaitdisc.discovery.shooting import Shooting
from gaitdisc.simulation.compiled_simulation import SUBSTEPS, Compiled
from gaitdisc.simulation.drive import Drive, Rows
from gaitdisc.simulation.parts import Input
from gaitdisc.simulation.running import compile_simulation
from gaitdisc.simulation.simulation import Simulation


def with_own_states(
    shooting: Shooting, machine: Compiled, values: NDArray[np.float64], starts: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return start states (segment, state) with those of the effects' own states, where these are not yet among them.

    values (parameter,): its parameters
    starts (segment, state): of the simulation as read, first; what follows is replaced
    """
    if shooting.past is None or len(machine.states) == shooting.past.shape[2]:
        return starts[:, : len(machine.states)]
    segments = shooting.segments
    own = followed(shooting, machine.simulation, values[None])[0][segments.trial, segments.begin]
    return np.concatenate([starts[:, : shooting.past.shape[2]], own], axis=1)


def followed(shooting: Shooting, simulation: Simulation, values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the effects' own states along the states of the record (version, trial, sample, own state).

    values (version, parameter): its parameters, several versions of them
    """
    assert shooting.past is not None
    drive = shooting.measured.drive
    inputs = np.concatenate([_bridged(shooting.past, drive.samples), drive.inputs], axis=2)
    along = Drive(drive.rate, drive.time0, inputs, drive.samples)
    machine = compile_simulation(
        driven_by_others(simulation, tuple(range(shooting.past.shape[2], len(simulation.states))))
    )
    trials, versions = len(drive.samples), len(values)
    trial = np.tile(np.arange(trials), versions)
    starts = np.tile([state.initial or 0.0 for state in machine.simulation.states], (len(trial), 1))
    rows = Rows(trial, 0 * trial, starts, np.repeat(values, trials, axis=0))
    runs = np.nan_to_num(run_twice(machine, along, rows, shooting.substeps)[1], nan=0.0, posinf=0.0, neginf=0.0)
    return runs.reshape(versions, trials, runs.shape[1], -1)


def run_twice(
    machine: Compiled, drive: Drive, rows: Rows, substeps: int = SUBSTEPS
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Run over whole trials, and once more from where each ended: by then it has forgotten its start.

    returns: both runs (row, sample, state)
    """
    steps = int(drive.samples.max()) - 1
    first, _ = machine.run(drive, rows, steps, substeps=substeps)
    ends = first[np.arange(len(rows.trial)), drive.samples[rows.trial] - 1]
    again = replace(rows, starts=np.nan_to_num(ends, nan=0.0, posinf=0.0, neginf=0.0))
    return first, machine.run(drive, again, steps, substeps=substeps)[0]


def driven_by_others(simulation: Simulation, own: tuple[int, ...]) -> Simulation:
    """Return the equations of some of the states, the others being inputs before the rest; nothing acts at ports."""
    states, equations = [simulation.states[one] for one in own], dict(simulation.equations)
    others = [one for one in simulation.states if one not in states]
    return replace(
        simulation,
        states=tuple(states),
        inputs=(*(Input(state.name, state.unit) for state in others), *simulation.inputs),
        parameters=tuple(replace(one, low=None, high=None) for one in simulation.parameters),
        equations=tuple((state.name, equations[state.name]) for state in states),
        ports=(),
        definitions=(*((port.name, "0") for port in simulation.ports), *simulation.definitions),
        observations=(),
        sensors=(),
        effects=(),
    )


def _bridged(states: NDArray[np.float64], samples: NDArray[np.int64]) -> NDArray[np.float64]:
    """States of every trial, unknown samples bridged by straight lines, zero beyond the end (trial, sample, state)."""
    out = np.zeros(states.shape)
    for trial, length in enumerate(samples):
        at = np.arange(length)
        for state in range(states.shape[2]):
            known = np.isfinite(states[trial, :length, state])
            if known.any():
                out[trial, :length, state] = np.interp(at, at[known], states[trial, :length, state][known])
    return out
