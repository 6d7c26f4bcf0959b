"""The two error signals of a known model against measurements: in its rates, and in its states."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from gaitdisc.errors import ShapeError
from gaitdisc.model import Model
from gaitdisc.recording import Samples

from .record import Record, edge_samples
from .system import rk4_step

Approach = Literal["dynamics", "state"]
APPROACHES: tuple[Approach, ...] = ("dynamics", "state")
TIME = "t"
SEAM_S = 1.0  # between two records that are learned from as one
FLOW_STEPS = 8  # of Runge-Kutta, between two samples


def error_samples(record: Record, approach: Approach, of_time: bool = False) -> Samples:
    """Samples of an error signal, that any method is fitted to."""
    x, y, first, last = _dynamics(record) if approach == "dynamics" else _state(record)
    time = record.time[first : first + len(y)][: last - first]
    inputs = (TIME,) if of_time else record.system.states
    outputs = record.system.states if approach == "dynamics" else record.system.channels
    return Samples(time[:, None] if of_time else x, y, inputs, outputs, time, np.full(len(time), np.nan))


def _dynamics(record: Record) -> tuple[NDArray[np.float64], NDArray[np.float64], int, int]:
    """Return states, error, first and last sample."""
    system, made = record.system, record.conditions
    if len(system.channels) < len(system.states):
        raise ShapeError(
            f"the dynamical error needs all {len(system.states)} states measured",
            f"{len(system.channels)} are: {', '.join(system.channels)}",
            "Learn the residual of what is measured, or use `gaitdisc discover`, which needs no rates.",
        )
    y = np.asarray(record.filtered)
    if made.published:
        return y, np.gradient(y, made.dt_s, axis=0) - system.known(y), 0, len(y)
    edge = edge_samples(1.0 / made.dt_s) if made.noise else 0
    inner = slice(edge + 1, len(y) - edge - 1)
    error = flow_error(system.known, y, made.dt_s)[inner.start - 1 : inner.stop - 1]
    return y[inner], error, inner.start, inner.stop


def one_after_another(parts: Sequence[Samples]) -> Samples:
    """Samples of several records as of one, each record's time going on where the last one's ended."""
    first, *others = parts
    if not others:
        return first
    time, begins = [first.time], first.time[-1]
    for part in others:
        begins = begins + SEAM_S
        time.append(begins + part.time - part.time[0])
        begins = time[-1][-1]
    whole = {name: np.concatenate([getattr(part, name) for part in parts]) for name in ("x", "y", "phi")}
    return replace(first, time=np.concatenate(time), **whole)


def known_rates_samples(record: Record) -> Samples:
    """Samples of the known model's rates at the measured states, with the time that they belong to.

    The weak form of SINDy compares them with the states themselves. States are those that noise was filtered from: what
    noise squares and cubes of the states would add is no longer in the terms.
    """
    states, _, first, last = _dynamics(record)
    time = record.time[first:last]
    names = record.system.states
    return Samples(states, record.system.known(states), names, names, time, np.full(len(time), np.nan))


def refined_samples(record: Record, samples: Samples, learned: Model) -> Samples:
    """Samples of the dynamical error, measured again from the model that was augmented once.

    What the flow misses is then small, and so is the error of order dt^2 that stood in the first samples.
    """
    first = round((samples.time[0] - record.time[0]) / record.conditions.dt_s)
    y = np.asarray(record.filtered)[first - 1 : first + len(samples) + 1]
    error = flow_error(lambda x: record.system.known(x) + learned(x), y, record.conditions.dt_s)
    return samples.with_outputs(error + learned(samples.x))


def flow_error(known: Callable, y: NDArray[np.float64], dt_s: float) -> NDArray[np.float64]:
    """Rate that the known model lacks, from how far it misses the neighbours of each sample, (sample - 2, state).

    The known model runs from the state at k forwards to k + 1 and backwards to k - 1; half the difference of what it
    misses there, over the step, is what was missing in its rates at k. Error: of order dt^2 in the *missing* rate,
    while a central difference has it in the *whole* rate, which for the Lorenz system at 0.01 s is larger than what is
    to be found.
    """
    ahead = y[2:] - flow(known, y[1:-1], dt_s)
    behind = y[:-2] - flow(known, y[1:-1], -dt_s)
    return (ahead - behind) / (2 * dt_s)


def flow(rates: Callable, x: NDArray[np.float64], dt_s: float, steps: int = FLOW_STEPS) -> NDArray[np.float64]:
    """Run all states (point, state) one sample on, or back, by Runge-Kutta of order 4."""
    h = dt_s / steps
    for _ in range(steps):
        x = rk4_step(rates, x, h)
    return x


def _state(record: Record) -> tuple[NDArray[np.float64], NDArray[np.float64], int, int]:
    system, made = record.system, record.conditions
    run = system.known.run(record.start(forecast=False)[None], made.dt_s, record.split - 1)[0]
    seen = run[:, : len(system.channels)]
    # no derivative is taken, so no low-pass is needed: it would colour the noise, which every method takes for white
    y = record.filtered if made.published else record.measured[: record.split]
    return run, y - seen, 0, len(run)
