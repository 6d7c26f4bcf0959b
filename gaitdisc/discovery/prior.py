"""Prior of a file's numbers: those with bounds are fitted within them, in every explanation alike."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from gaitdisc.simulation.simulation import Simulation


@dataclass(frozen=True)
class Prior:
    """Normal distributions of parameters around the file's values, cut off at the file's bounds.

    Half the width between the bounds is two standard deviations.
    """

    names: tuple[str, ...] = ()
    # (number,), where they stand among the parameters
    places: NDArray[np.intp] = field(default_factory=lambda: np.zeros(0, dtype=np.intp))
    # (number,), as in the file [each parameter's unit]
    value: NDArray[np.float64] = field(default_factory=lambda: np.zeros(0))
    # (number,), as in the file [each parameter's unit]
    low: NDArray[np.float64] = field(default_factory=lambda: np.zeros(0))
    # (number,), as in the file [each parameter's unit]
    high: NDArray[np.float64] = field(default_factory=lambda: np.zeros(0))

    @property
    def sd(self) -> NDArray[np.float64]:
        """Standard deviations (number,)."""
        return (self.high - self.low) / 4

    def left(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return how far numbers are from the file's, in standard deviations (number,): file minus number.

        values (parameter,): all parameters
        """
        return (self.value - values[self.places]) / self.sd

    def among(self, free: tuple[str, ...]) -> Prior:
        """Return the prior of those of its parameters that are fitted."""
        kept = np.array([name in free for name in self.names], bool)
        names = tuple(name for name in self.names if name in free)
        return Prior(names, self.places[kept], self.value[kept], self.low[kept], self.high[kept])

    def within(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return parameters with those that have bounds put inside them (parameter,).

        values (parameter,): all parameters
        """
        inside = values.copy()
        inside[self.places] = np.clip(values[self.places], self.low, self.high)
        return inside


def prior_of(simulation: Simulation, exact: frozenset[str] = frozenset()) -> Prior:
    """Read the prior off a simulation's bounds.

    simulation: a parameter with `low` and `high` has a prior; one with a single bound or none is exact

    >>> from gaitdisc.simulation.simulation_file import bundled
    >>> prior = prior_of(bundled("ankle"), frozenset(["b"]))
    >>> prior.names, prior.sd.round(3).tolist()
    (('inertia', 'k'), [0.049, 19.5])
    """
    found = [
        (place, one.name, one.value, one.low, one.high)
        for place, one in enumerate(simulation.parameters)
        if one.low is not None and one.high is not None and one.low < one.high and one.name not in exact
    ]
    if not found:
        return Prior()
    places, names, *numbers = zip(*found, strict=True)
    return Prior(names, np.array(places, dtype=np.intp), *(np.array(each, float) for each in numbers))
