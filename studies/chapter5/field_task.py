"""What is reconstructed of a field, the same for every route and model of a study, and which cell each answer is."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

from gaitdisc.sensing.windows import Lags

from .modes import ENERGY


class Label(NamedTuple):
    """Which cell it is."""

    field: str
    route: str
    split: str
    model: str
    run: int


@dataclass(frozen=True)
class FieldTask:
    """What is the same for every route and model of a study."""

    name: str
    lags: Lags  # readings of a window, snapshots from one to the next, and how far ahead the field is forecast
    rule: str = "temporal"
    energy: float = ENERGY  # share of the training snapshots' energy that the modes keep
    season: int = 0  # snapshots of a year, whose mean course is a floor of its own; 0 where there is none
    positions: bool = False  # whether each sensor gives its place
    # whether sensors read, and models reconstruct, departures from the training part's mean at the place and time of
    # year: what a reading means then depends less on where the sensor is. The season is added afterwards
    departures: bool = False
    seed: int = 0

    def label(self, route: str, model: str) -> Label:
        """Return which cell a route and a model are."""
        return Label(self.name, route, self.rule, model, self.seed)

    def named(self, kind: str) -> str:
        """Return what a kind of model is called in this task."""
        return f"{kind}, departures" if self.departures else kind
