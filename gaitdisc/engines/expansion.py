"""A model of an engine as a simulation that runs at once: its accelerations expanded along the measured motion.

At every sample of the record the engine gives the accelerations and their slopes by each coordinate, speed, control and
parameter; what a force on a coordinate changes is exact, as forces enter linearly. Runs that stay near the record then
need no call of the engine: what is left out is of second order in their distance from the smoothed record.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from gaitdisc.engines.engine import Engine, Motion
from gaitdisc.simulation.drive import Drive
from gaitdisc.simulation.measured import Measured
from gaitdisc.simulation.parts import Input
from gaitdisc.simulation.simulation import Simulation

NUDGE = 1e-4  # of a state's or a parameter's size
STILL = 1e-9  # of a column's size, below which it is one number

Columns = dict[str, NDArray[np.float64]]  # name of what an acceleration is multiplied by, "" for what is by itself


def expanded(
    simulation: Simulation,
    engine: Engine,
    measured: Measured,
    states: NDArray[np.float64],
    values: Mapping[str, float] | None = None,
) -> tuple[Simulation, Measured]:
    """Simulation that is expanded along a record, and the record with what the engine computed along it.

    Parameters
    ----------
    simulation : Simulation
        As the mapping file has it: the names, the observations, the ports.
    measured : Measured
        Driven by its inputs.
    states : ndarray (trial, sample, state)
        Smoothed: coordinates, then speeds.
    values : mapping of str to float, optional
        Parameters around which to expand; the simulation's own where absent.
    """
    own = simulation.values() | dict(values or {})
    drive, count = measured.drive, len(engine.coordinates)
    motions = []
    for trial, samples in enumerate(drive.samples):
        along = states[trial, :samples]
        u = engine.acting(drive.inputs[trial, :samples], drive.rate, along[:, :count])
        motions.append(Motion(along[:, :count], along[:, count:], u))
    at = Motion(*(np.concatenate([getattr(one, name) for one in motions]) for name in ("q", "v", "u")))
    table = _columns(simulation, engine, at, own)
    equations, computed = dict(simulation.equations), {}
    for number, one in enumerate(engine.coordinates):
        equations[one.name] = one.speed
        terms = []
        for factor, column in table.items():
            values_here = column[:, number]
            text = _factor(simulation, factor, own)
            if np.ptp(values_here) <= STILL * max(float(np.abs(column).max()), 1e-12):
                mean = float(values_here.mean())
                terms += [f"{mean!r}*{text}" if text else repr(mean)] if mean else []
                continue
            name = f"{one.speed}_by_{factor}" if factor else f"{one.speed}_rate"
            computed[name] = values_here
            terms.append(f"{name}*{text}" if text else name)
        equations[one.speed] = " + ".join(terms) or "0"
    inputs = (*simulation.inputs, *(Input(name, "", "computed along the record", True) for name in computed))
    ends = np.cumsum(drive.samples)[:-1]
    driven = [np.split(column, ends) for column in (*at.u.T, *computed.values())]
    trials = [np.column_stack([column[trial] for column in driven]) for trial in range(len(drive.samples))]
    if not driven:
        trials = [np.empty((int(samples), 0)) for samples in drive.samples]
    lines = tuple((state.name, equations[state.name]) for state in simulation.states)
    linear = replace(simulation, inputs=inputs, equations=lines, model="", layout="", source=None)
    return linear, replace(measured, drive=Drive.of(trials, drive.rate, drive.time0))


def _factor(simulation: Simulation, name: str, values: Mapping[str, float]) -> str:
    """What a column is multiplied by: a state, a port, or how far a parameter is from where the engine had it."""
    return f"({name} - {values[name]!r})" if name in simulation.values() else name


def _columns(simulation: Simulation, engine: Engine, at: Motion, values: Mapping[str, float]) -> Columns:
    """Columns (point, coordinate): slopes by everything that the accelerations depend on, and what is left."""
    base = engine.accelerations(at, values)
    table: Columns = {}
    rest = base.copy()
    for name, along, ahead, behind, size in _nudged(engine, at):
        slope = (engine.accelerations(ahead, values) - engine.accelerations(behind, values)) / (2 * size)
        table[name] = slope
        rest -= slope * along[:, None]
    for parameter in simulation.parameters:
        size = NUDGE * max(abs(values[parameter.name]), 1e-2)
        pair = (
            engine.accelerations(at, {**values, parameter.name: values[parameter.name] + each})
            for each in (size, -size)
        )
        ahead, behind = pair
        table[parameter.name] = (ahead - behind) / (2 * size)
    ports = {port.name for port in simulation.ports}
    for number, one in enumerate(engine.coordinates):
        if one.port in ports:
            force = np.zeros_like(base)
            force[:, number] = 1.0
            table[one.port] = engine.accelerations(at, values, force) - base
    return {"": rest, **table}


def _nudged(engine: Engine, at: Motion) -> Iterator[tuple[str, NDArray[np.float64], Motion, Motion, float]]:
    """Yield each coordinate, speed and control with the motion a little to either side."""
    for field, names in (
        ("q", [one.name for one in engine.coordinates]),
        ("v", [one.speed for one in engine.coordinates]),
        ("u", [one.name for one in engine.controls]),
    ):
        whole = getattr(at, field)
        for column, name in enumerate(names):
            size = NUDGE * max(float(np.abs(whole[:, column]).max()), 1e-2)
            step = np.zeros(whole.shape[1])
            step[column] = size
            yield (
                name,
                whole[:, column],
                replace(at, **{field: whole + step}),
                replace(at, **{field: whole - step}),
                size,
            )
