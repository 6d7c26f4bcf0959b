"""Stated errors of inputs: one that stays as it is is a number of the simulation, one that wanders is random."""

from dataclasses import replace

import numpy as np
from scipy.signal import lfilter

from gaitdisc.simulation.measured import Measured
from gaitdisc.simulation.parts import Input, Parameter
from gaitdisc.simulation.simulation import Simulation

BOUNDS = 2.0  # standard deviations, as of every number with bounds (prior.py)


def wandering(simulation: Simulation) -> list[tuple[int, Input]]:
    """List the inputs whose stated error changes in time, each with its column."""
    return [(column, signal) for column, signal in enumerate(simulation.inputs) if signal.wander]


def with_constant_errors(simulation: Simulation) -> Simulation:
    """Return a simulation in which each stated error that stays as it is is a number with bounds.

    >>> from gaitdisc.simulation.parts import Input, State
    >>> fed = Simulation("fed", (State("x"),), (Input("u", "N", gain=0.1),), equations={"x": "u - x"})
    >>> with_constant_errors(fed).equations, with_constant_errors(fed).parameters[0].high
    ((('x', 'gain_of_u*u - x'),), 1.2)
    """
    for signal in simulation.inputs:
        text = signal.name
        for name, error, value, unit in (
            (f"gain_of_{signal.name}", signal.gain, 1.0, "1"),
            (f"offset_of_{signal.name}", signal.sd, 0.0, signal.unit),
        ):
            # a file that was written has it already
            if error and not signal.wander and name not in simulation.values():
                bounds = value - BOUNDS * error, value + BOUNDS * error
                simulation = simulation.with_parameter(Parameter(name, value, unit, *bounds))
                text = f"{name}*{text}" if value else f"{text} + {name}"
        simulation = simulation.with_input(signal.name, text) if text != signal.name else simulation
    return simulation


def with_drawn_errors(measured: Measured, simulation: Simulation, seed: int) -> Measured:
    """Return trials whose inputs err once more as stated: a stationary Markov process (Ornstein and Uhlenbeck)."""
    rng, inputs = np.random.default_rng(seed), measured.drive.inputs.copy()
    for column, signal in wandering(simulation):
        memory = float(np.exp(-1 / (measured.rate * (signal.wander or 0.0))))
        for size in (signal.sd or 0.0, (signal.gain or 0.0) * measured.drive.inputs[..., column]):
            new = rng.normal(size=inputs.shape[:2])
            new[:, 1:] *= np.sqrt(1 - memory**2)
            inputs[..., column] += size * np.asarray(lfilter([1.0], [1.0, -memory], new, axis=1))
    return replace(measured, drive=replace(measured.drive, inputs=inputs))
