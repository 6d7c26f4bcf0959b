"""Outputs of a program at many points."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gaitdisc.simulation.program import Program
from gaitdisc.simulation.refusal import SimulationError


def leaf_columns(
    t: ArrayLike, x: NDArray[np.float64], u: NDArray[np.float64], values: NDArray[np.float64]
) -> list[NDArray[np.float64]]:
    """Values of time, states, inputs and parameters in the order in which a program takes them.

    Parameters
    ----------
    t : ndarray (point,)
        Time [s].
    x, u : ndarray (point, state), (point, input)
        States and inputs.
    values : ndarray (parameter,) or (point, parameter)
        Parameters.
    """
    return [np.asarray(t, float), *np.asarray(x, float).T, *np.asarray(u, float).T, *np.asarray(values, float).T]


def at_points(
    program: Program,
    columns: Sequence[NDArray[np.float64]],
    late: NDArray[np.float64] | None = None,
    points: int | None = None,
) -> NDArray[np.float64]:
    """Outputs of a program at many points, (output, point).

    Parameters
    ----------
    program : Program
        Compiled expressions.
    columns : sequence of ndarray (point,) or ()
        Values of its leaves; one number serves all points.
    late : ndarray (point, delay), optional
        Delayed signals, where the program has any.
    points : int, optional
        How many; the length of the first column by default.
    """
    from gaitdisc.simulation.machine import BLOCK, evaluate_blocks

    if program.delays and (late is None or np.shape(late)[-1] != len(program.delays)):
        raise SimulationError(
            f"delayed signals are needed at each point: {', '.join(signal for signal, _ in program.delays)}",
            "they were not given",
            "Run the simulation, or give `late`.",
        )
    count = int(np.size(columns[0])) if points is None else points
    sources = [*columns, *(np.asarray(late).T if program.delays else ())]
    spread = np.full(program.registers, 2, np.int64)
    table = np.zeros((len(sources), count))
    for k, (source, used) in enumerate(zip(sources, program.used(), strict=True)):
        if used:
            spread[k] = int(np.ndim(source) > 0)
            table[k, : count if np.ndim(source) else 1] = source
    into = np.empty((program.outputs, count))
    evaluate_blocks(program.placed(BLOCK), program.constants, table, spread, into)
    return into
