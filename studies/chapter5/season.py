"""The course that a field takes every year, as its training part has it: what is known without any sensor."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from gaitdisc.recording import Field
from gaitdisc.recording.arrays import read_only


@dataclass(frozen=True, eq=False)
class Season:
    """Mean field of every time of the year."""

    # (time of the year, point, quantity) [each quantity's unit], one time of the year where the field has no season:
    # its mean
    course: NDArray[np.float32]

    def __post_init__(self) -> None:
        """Freeze the numbers."""
        object.__setattr__(self, "course", read_only(self.course, np.float32))

    def at(self, snapshots: NDArray[np.intp]) -> NDArray[np.float32]:
        """Mean field at the time of year of snapshots, (snapshot, point, quantity) [each quantity's unit]."""
        return self.course[snapshots % len(self.course)]

    def departures(self, field: Field) -> Field:
        """Departures of every snapshot from the mean of its time of year."""
        return replace(field, values=field.values - self.at(np.arange(len(field))))


def season_of(field: Field, snapshots: NDArray[np.intp], period: int) -> Season:
    """Mean of every time of the year over some snapshots; their mean of all where a time of year is not among them."""
    mean = field.values[snapshots].mean(axis=0, dtype=float)
    if not period:
        return Season(mean[None])
    of_year = [field.values[snapshots[snapshots % period == k]] for k in range(period)]
    return Season(np.stack([part.mean(axis=0, dtype=float) if len(part) else mean for part in of_year]))
