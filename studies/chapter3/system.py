"""A system of chapter 3: what is known of it, what it truly is, and what of it is measured."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from gaitdisc.recording.arrays import read_only
from gaitdisc.simulation.parts import Term
from gaitdisc.simulation.simulation import Simulation

from .known_rates import KnownRates


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

    def __post_init__(self) -> None:
        """Freeze the numbers."""
        object.__setattr__(self, "start", read_only(self.start))
        object.__setattr__(self, "observation", read_only(self.observation))

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
