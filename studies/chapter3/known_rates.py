"""The right-hand side of a simulation file, run without a Python call per step, alone or with a learned term."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gaitdisc.simulation.compiled_simulation import Compiled
from gaitdisc.simulation.drive import Drive, Rows
from gaitdisc.simulation.refusal import SimulationError
from gaitdisc.simulation.running import compile_simulation
from gaitdisc.simulation.simulation import Simulation

STEP_S = 5e-4  # of Runge-Kutta order 4: the Lorenz system loses 1e-12 a second to it


@dataclass(frozen=True)
class KnownRates:
    """Rates of a simulation without inputs; `chapter3.system.Rates`."""

    simulation: Simulation

    def __post_init__(self) -> None:
        """Refuse what cannot be run from a state alone."""
        if self.simulation.inputs or self.compiled.right_hand_side.delays:
            raise SimulationError(
                "the two approaches of chapter 3 are for systems whose rates follow from the state",
                f"{self.simulation.title!r} has inputs or delays",
                "Use `gaitdisc discover`, which takes measured inputs and delays.",
            )

    @property
    def compiled(self) -> Compiled:
        """The simulation, ready to run."""
        return compile_simulation(self.simulation)

    def __call__(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """Rates (point, state) at states (point, state)."""
        return self.compiled.rates(np.zeros(len(x)), np.asarray(x, float), np.empty((len(x), 0)))

    def run(self, starts: NDArray[np.float64], dt_s: float, steps: int) -> NDArray[np.float64]:
        """States (start, steps + 1, state) from many starts; NaN from where one diverged."""
        drive = Drive.of([np.empty((steps + 1, 0))], 1.0 / dt_s)
        none = np.zeros(len(starts), int)
        rows = Rows(none, none, np.asarray(starts, float))
        return self.compiled.run(drive, rows, steps, substeps=max(1, round(dt_s / STEP_S)))[0]
