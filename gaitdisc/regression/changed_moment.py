"""What changed at a joint between two walks of a person: the gains of both walks and the change, estimated together.

Gains that come from the Nominal walk alone carry their error into whatever the device walk is said to hold: where a
device relieves a muscle, a gain too small by a fifth hides a fifth of the relief. So each possible change is fitted
together with the gains to the strides of both walks, the gains being those of one person; a change that lowers the
error of device strides that were left out is kept, and its number gets an interval from blocks of strides drawn anew
from both walks (Efron B (1979). Bootstrap methods. Ann Stat 7(1), 1-26).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gaitdisc.regression.muscle_moment import Driven, Form, MuscleMoment, Sums, Values, model_of, solved, sums_of

LEARNED = 0.75  # of the device walk's strides, from its beginning
CLOSES = 0.10  # of the squared error on device strides that were left out, to be kept
DRAWS, BLOCK = 60, 3  # of the bootstrap, and strides that are drawn together
SPEEDS = (0.7, 1.4)  # times the fastest speed of a muscle, which nobody measured: what it moves joins the spread
FINER = np.linspace(-1.5, 1.5, 7)  # steps of a grid about its best value


class Walk(NamedTuple):
    """One walk at a joint; a stride of -1 is outside."""

    driven: Driven
    moment: Values  # [N m]
    stride: NDArray[np.intp]


def as_recorded(driven: Driven, _: float) -> Driven:
    """Return what drives the muscles of a walk in which they are as they were."""
    return driven


def no_columns(driven: Driven, _: float) -> Values:
    """Return the moments (sample, 0) of a change that adds none."""
    return np.empty((len(driven.angle), 0))


@dataclass(frozen=True, eq=False)
class Change:
    """One way in which a walk may differ; `values` is the grid of the number that is not linear, else one value."""

    name: str
    place: str
    number: str  # whose estimate the change is known by
    values: Values
    driven: Callable[[Driven, float], Driven] = as_recorded
    columns: Callable[[Driven, float], Values] = no_columns
    piece: str = ""  # with which the catalogue's expression begins, where two effects share a name


@dataclass(frozen=True, eq=False)
class Changed:
    """A change that device strides left out of the fit bear out, and the moment model of both walks beside it."""

    change: Change
    model: MuscleMoment
    value: float
    spread: float  # standard deviation over blocks of strides of both walks drawn anew
    closed: float  # share of the squared error on device strides left out
    rival: Change | None  # the next best of another name
    rival_leaves: float  # squared error beside the rival, of that beside the change


def changed_moment(model: MuscleMoment, nominal: Walk, device: Walk, changes: Sequence[Change]) -> Changed | None:
    """Return the change that explains both walks best; None where strides left out do not bear it out."""
    both = _Both.of(model.form, nominal, device)
    tried = [(both.misfit(change, value), change, float(value)) for change in changes for value in change.values]
    left, best, value = min(tried, key=lambda one: one[0])
    others = [one for one in tried if (one[1].name, one[1].place) != (best.name, best.place)]
    rival_left, rival, _ = min(others, key=lambda one: one[0], default=(np.nan, None, 0.0))
    nothing = Change("", "", "", np.zeros(1))
    held = 1 - both.held_out(best, value) / both.held_out(nothing, 0.0)
    if held < CLOSES:
        return None
    found, number, draws = _drawn_anew(both, best, value, DRAWS)
    forms = [replace(model.form, fastest=pace * model.form.fastest) for pace in SPEEDS]
    at_speeds = [_drawn_anew(_Both.of(form, nominal, device), best, value, 0)[1] for form in forms]
    errors = [float(np.std(draws)), float(np.std([number, *at_speeds])), _coarseness(both, best, value)]
    spread = float(np.linalg.norm(errors))
    changed = model_of(model.form, found, model.gains.shape[0], model.left_nm, model.before_nm)
    return Changed(best, changed, number, spread, held, rival, rival_left / left)


def linear_number(model: MuscleMoment, nominal: Walk, device: Walk, change: Change) -> tuple[float, float]:
    """Return the number of a change that is linear, borne out or not, and its standard deviation over drawn blocks."""
    _, number, draws = _drawn_anew(_Both.of(model.form, nominal, device), change, float(change.values[0]), DRAWS)
    return number, float(np.std(draws))


@dataclass(frozen=True, eq=False)
class _Both:
    """Both walks as normal equations of strides."""

    form: Form
    nominal: Sums
    device: Walk
    learned: Values  # (device stride,) 1 where learned from

    @classmethod
    def of(cls, form: Form, nominal: Walk, device: Walk) -> _Both:
        """Sum up the strides of the Nominal walk."""
        own = sums_of(form.columns(nominal.driven), nominal.moment, nominal.stride, int(nominal.stride.max()) + 1)
        count = int(device.stride.max()) + 1
        return cls(form, own, device, (np.arange(count) < LEARNED * count).astype(float))

    def sums(self, change: Change, value: float) -> tuple[Sums, Sums]:
        """Of both walks with a change, which the Nominal walk has not."""
        driven = self.device.driven
        more = change.columns(driven, value)
        columns = np.hstack([self.form.columns(change.driven(driven, value)), more])
        mine = sums_of(columns, self.device.moment, self.device.stride, len(self.learned))
        wide = more.shape[1]
        squares = np.pad(self.nominal.squares, ((0, 0), (0, wide), (0, wide)))
        return Sums(squares, np.pad(self.nominal.match, ((0, 0), (0, wide))), self.nominal.power), mine

    def found(self, sums: tuple[Sums, Sums], weights: tuple[Values, Values]) -> tuple[Values, float]:
        """Coefficients and what they leave, strides so many times."""
        parts = [one.of(weight) for one, weight in zip(sums, weights, strict=True)]
        found = solved(Sums(*(a + b for a, b in zip(*parts, strict=True))), len(self.device.driven.signs))
        left = sum(float(weight @ one.left(found)) for one, weight in zip(sums, weights, strict=True))
        return found, left

    @property
    def once(self) -> tuple[Values, Values]:
        """Each stride once, those of the device walk that are learned from."""
        return np.ones(len(self.nominal.power)), self.learned

    def misfit(self, change: Change, value: float) -> float:
        """What is left of the strides that are learned from [(N m)2]."""
        return self.found(self.sums(change, value), self.once)[1]

    def held_out(self, change: Change, value: float) -> float:
        """What is left of the device strides that are not [(N m)2]."""
        sums = self.sums(change, value)
        return float((1 - self.learned) @ sums[1].left(self.found(sums, self.once)[0]))


def _drawn_anew(both: _Both, change: Change, about: float, draws: int) -> tuple[Values, float, list[float]]:
    """The coefficients, the number of a change, and that number from blocks of strides drawn anew."""
    step = change.values[1] - change.values[0] if len(change.values) > 1 else 0.0
    values = about + step * (FINER if step else np.zeros(1))
    sums = [both.sums(change, value) for value in values]
    linear = change.columns(both.device.driven, about).shape[1] > 0

    def best(weights: tuple[Values, Values]) -> tuple[Values, float]:
        tried = [both.found(one, weights) for one in sums]
        at = int(np.argmin([left for _, left in tried]))
        return tried[at][0], float(tried[at][0][-1]) if linear else float(values[at])

    rng = np.random.default_rng(0)
    found, number = best(both.once)
    drawn = [best((_weights(rng, both.once[0]), _weights(rng, both.learned)))[1] for _ in range(draws)]
    return found, number, drawn


def _coarseness(both: _Both, change: Change, about: float) -> float:
    """Standard deviation of a number that is known to a step of the finer grid; 0 where it is linear."""
    if len(change.values) < 2 or change.columns(both.device.driven, about).shape[1]:
        return 0.0
    return float((FINER[1] - FINER[0]) * abs(change.values[1] - change.values[0]) / np.sqrt(12))


def _weights(rng: np.random.Generator, once: Values) -> Values:
    """How often each stride is drawn, blocks of neighbours together."""
    block = np.arange(len(once)) // BLOCK
    return once * np.bincount(rng.integers(0, block[-1] + 1, block[-1] + 1), minlength=block[-1] + 1)[block]
