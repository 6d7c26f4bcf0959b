"""A system of chapter 3: what is known of it, what it truly is, what pushes it, and what of it is measured."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from gaitdisc.simulation.compiled_simulation import Compiled
from gaitdisc.simulation.drive import Drive, Rows
from gaitdisc.simulation.parts import Term
from gaitdisc.simulation.refusal import SimulationError
from gaitdisc.simulation.running import compile_simulation
from gaitdisc.simulation.simulation import Simulation

LONGEST_STEP_S = 5e-3  # of Runge-Kutta order 4 on a field: the fastest wave decays with 253 /s at a viscosity of 0.1
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


def rk4_step(rates: Callable, x: NDArray[np.float64], h: float) -> NDArray[np.float64]:
    """States (point, state) one step on, or back, by Runge-Kutta of order 4."""
    one = rates(x)
    two = rates(x + 0.5 * h * one)
    three = rates(x + 0.5 * h * two)
    return x + h / 6 * (one + 2 * two + 2 * three + rates(x + h * three))


class Rates(Protocol):
    """Right-hand side of a system without inputs."""

    def __call__(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """Rates (point, state) at states (point, state)."""
        ...

    def run(self, starts: NDArray[np.float64], dt_s: float, steps: int) -> NDArray[np.float64]:
        """States (start, steps + 1, state) from many starts; NaN from where one diverged."""
        ...


@dataclass(frozen=True, eq=False)
class System:
    """Known dynamics f, true dynamics F = f + g, and the measured channels (Eqs. 3.1-3.3, 3.15)."""

    name: str
    states: tuple[str, ...]
    known: Rates
    true: Rates
    start: NDArray[np.float64]  # (state,), where both begin
    observation: NDArray[np.float64]  # (channel, state), c of Eq. 3.15; the channels are the first states
    assumed: NDArray[np.float64] | None = None  # (state,), where the known model is thought to begin, if that is wrong
    units: tuple[str, ...] = ()  # of the states; empty where they have none

    @property
    def channels(self) -> tuple[str, ...]:
        """Names of what is measured."""
        return self.states[: len(self.observation)]


def system_of(
    known: Simulation, hidden: Term | None = None, start: tuple[float, ...] = (), gain: tuple[float, ...] = ()
) -> System:
    """System of a simulation file and the effect that is hidden from it."""
    states = tuple(state.name for state in known.states)
    true = known.with_effect(hidden) if hidden else known
    first = start or tuple(float(state.initial or 0.0) for state in known.states)
    observation = np.eye(len(states)) if not gain else np.diag([*gain, *[0.0] * (len(states) - len(gain))])[: len(gain)]
    units = tuple(state.unit for state in known.states)
    return System(known.title, states, KnownRates(known), KnownRates(true), np.array(first), observation, None, units)


@dataclass(frozen=True)
class StochasticRates:
    """Rates with a random push of every state between any two samples; a `system.Rates`."""

    rates: Rates
    # of each state: standard deviation of the pushes of a second [unit of the state/sqrt(s)]
    strength: tuple[float, ...]
    seed: int = 0

    def __call__(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """Rates (point, state) at states (point, state), without the pushes."""
        return self.rates(x)

    def run(self, starts: NDArray[np.float64], dt_s: float, steps: int) -> NDArray[np.float64]:
        """States (start, steps + 1, state), all starts under the same pushes."""
        sizes = np.asarray(self.strength) * np.sqrt(dt_s)
        pushes = sizes * np.random.default_rng(self.seed).standard_normal((steps, len(sizes)))
        found = np.empty((len(starts), steps + 1, len(sizes)))
        found[:, 0] = starts
        for step, push in enumerate(pushes):
            found[:, step + 1] = self.rates.run(found[:, step], dt_s, 1)[:, 1] + push
        return found
