"""Every cell of a system: methods by approaches by noises by seeds."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

from .cell import cell_of
from .discrepancy_cell import DiscrepancyCell
from .error_signal import APPROACHES, Approach
from .methods import Method, MethodSettings
from .record import Conditions, recorded
from .system import System

NOISES = (0.0, 0.001, 0.01, 0.1)
WARMING = 600  # samples
ALL_METHODS: tuple[Method, ...] = ("sindy", "dmd", "bopdmd", "gp", "nn")


def grid(
    system: System,
    conditions: Conditions,
    noises: Sequence[float] = NOISES,
    seeds: Sequence[int] = (0,),
    chosen: tuple[Sequence[Method], Sequence[Approach]] = (ALL_METHODS, APPROACHES),
    settings: MethodSettings | None = None,
    computed: Callable[[DiscrepancyCell], None] = lambda _: None,
) -> tuple[DiscrepancyCell, ...]:
    """Compute the cells; without noise one seed is enough.

    Before the first, each method is fitted to a short record, so that no cell's seconds hold importing and compiling.
    """
    _warmed(system, conditions, chosen, settings)
    found = []
    for noise in noises:
        for seed in seeds if noise else seeds[:1]:
            record = recorded(system, replace(conditions, noise=noise, seed=seed))
            for approach in chosen[1]:
                for method in chosen[0]:
                    found.append(cell_of(record, method, approach, settings))
                    computed(found[-1])
    return tuple(found)


def _warmed(
    system: System,
    conditions: Conditions,
    chosen: tuple[Sequence[Method], Sequence[Approach]],
    settings: MethodSettings | None,
) -> None:
    short = recorded(system, replace(conditions, noise=0.0, duration_s=WARMING * conditions.dt_s))
    for method in chosen[0]:
        cell_of(short, method, chosen[1][0], settings)
