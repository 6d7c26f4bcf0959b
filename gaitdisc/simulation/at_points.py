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

    t (point,): time [s]
    x, u (point, state), (point, input): states and inputs
    values (parameter,) or (point, parameter): parameters
    """
    return [np.asarray(t, float), *np.asarray(x, float).T, *np.asarray(u, float).T, *np.asarray(values, float).T]


def at_points(
    program: Program,
    columns: Sequence[NDArray[np.float64]],
    late: NDArray[np.float64] | None = None,
    points: int | None = None,
) -> NDArray[np.float64]:
    """Outputs of a program at many points, (output, point).

    columns each (point,) or (): values of its leaves; one number serves all points
    late (point, delay): delayed signals, where the program has any
    points: how many; the length of the first column by default
    """
    if program.delays and (late is None or np.shape(late)[-1] != len(program.delays)):
        raise SimulationError(
            f"delayed signals are needed at each point: {', '.join(signal for signal, _ in program.delays)}",
            "they were not given",
            "Run the simulation, or give `late`.",
        )
    table = PointTable(program, int(np.size(columns[0])) if points is None else points)
    table.fill(0, [*columns, *(np.asarray(late).T if program.delays else ())])
    return table.outputs()


class PointTable:
    """Values of a program's leaves at a number of points, to be filled in part and evaluated again and again."""

    def __init__(self, program: Program, points: int) -> None:
        from gaitdisc.simulation.machine import BLOCK, evaluate_blocks

        self._code, self._evaluated = program.placed(BLOCK), evaluate_blocks
        self._used = tuple(program.used())
        self._program, self._points = program, points
        self._spread = np.full(program.registers, 2, np.int64)
        self._table = np.zeros((len(self._used), points))

    def fill(self, first: int, columns: Sequence[NDArray[np.float64]]) -> None:
        """Put values in place of those of some leaves; what the program does not read is passed over.

        columns each (point,) or (): their values; one number serves all points
        """
        for leaf, column in enumerate(columns, first):
            if self._used[leaf]:
                self._spread[leaf] = int(np.ndim(column) > 0)
                self._table[leaf, : self._points if np.ndim(column) else 1] = column

    def outputs(self) -> NDArray[np.float64]:
        """Outputs of the program, (output, point)."""
        into = np.empty((self._program.outputs, self._points))
        self._evaluated(self._code, self._program.constants, self._table, self._spread, into)
        return into
