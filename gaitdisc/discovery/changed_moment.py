"""What changed at a joint between two walks of a person: the gains of both walks and the change, estimated together.

Gains that come from the Nominal walk alone carry their error into whatever the device walk is said to hold: where a
device relieves a muscle, a gain too small by a fifth hides a fifth of the relief. So each possible change is fitted
together with the gains to the strides of both walks, the gains being those of one person; a change that lowers the
error of device strides that were left out is kept, and its number gets an interval from blocks of strides drawn anew
from both walks (Efron B (1979). Bootstrap methods. Ann Stat 7(1), 1-26) and from what nobody measured.

References
----------
McGinley JL, Baker R, Wolfe R, Morris ME (2009). The reliability of three-dimensional kinematic gait measurements: a
systematic review. Gait Posture 29(3), 360-369.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gaitdisc.processing.muscle_moment import (
    FIRMNESS,
    GAIN_RIDGE,
    USUAL_HARMONICS,
    Driven,
    Form,
    MuscleMoment,
    Sums,
    cycle,
    make_model,
    parts_of_stride,
    solve_signed,
    solved,
    sum_pieces,
    tied,
    usual_angle,
)
from gaitdisc.recording.arrays import Values

LEARNED = 0.75  # of the device walk's strides, from its beginning
CLOSES = 0.10  # of the squared error on device strides that were left out, to be kept
DRAWS, BLOCK = 60, 3  # of the bootstrap, and strides that are drawn together
# what nobody measured, of which the number's move joins the spread: the fastest speed of a muscle, the lag of its
# activation, and how alike its gains are at both ends of the angle, each so many times what the model takes
SPEEDS, LAGS, RESPECTS = (0.7, 1.4), (0.5, 2.0), (1 / 3, 3.0)
# usual stride of the device walk [rad], root mean square of its change in the first harmonics: what the mean ankle
# curve of a person moves by from one session to the next (McGinley et al. 2009: 2 deg and less)
SHIFT_RAD, SHIFT_HARMONICS, SHIFTS = np.radians(1.0), 4, 12
NORMAL_95 = 1.96
UNSEEN_HARMONICS = 8  # of the curve over the stride that no electrode sees, where a mass at the foot is weighed
PARTS = (1, 3)  # of the stride, each of which may resist a departure differently; what either says counts half
FINER = np.linspace(-1.5, 1.5, 7)  # steps of a grid about its best value


class Walk(NamedTuple):
    """One walk at a joint; a stride of -1 is outside."""

    driven: Driven
    moment: Values  # [N m]
    stride: NDArray[np.intp]


@dataclass(frozen=True, eq=False)
class Change:
    """One way in which a walk may differ; `values` is the grid of the number that is not linear, else one value."""

    name: str
    place: str
    number: str  # whose estimate the change is known by
    values: Values
    driven: Callable[[Driven, float], Driven] = field(default_factory=lambda: lambda driven, _: driven)
    columns: Callable[[Driven, float], Values] = field(default_factory=lambda: lambda d, _: np.empty((len(d.angle), 0)))
    neutral: float = 0.0  # its number where nothing changed
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


def find_change(model: MuscleMoment, nominal: Walk, device: Walk, changes: Sequence[Change]) -> Changed | None:
    """Return the change that explains both walks best.

    None where strides left out do not bear it out, or its interval holds that nothing changed.
    """
    both = _Both.of(model.form, nominal, device)
    tried = [(both.misfit(change, value), change, float(value)) for change in changes for value in change.values]
    misfit, best, value = min(tried, key=lambda attempt: attempt[0])
    others = [attempt for attempt in tried if (attempt[1].name, attempt[1].place) != (best.name, best.place)]
    rival_misfit, rival, _ = min(others, key=lambda attempt: attempt[0], default=(np.nan, None, 0.0))
    nothing = Change("", "", "", np.zeros(1))
    closed = 1 - both.held_out(best, value) / both.held_out(nothing, 0.0)
    if closed < CLOSES:
        return None
    coefficients, number, draws = _draw_anew(both, best, value, DRAWS)
    errors = [float(np.std(draws)), _doubt_number(model.form, nominal, device, best, value)]
    if len(best.values) > 1 and not best.columns(device.driven, value).shape[1]:  # known to a step of the finer grid
        errors.append((FINER[1] - FINER[0]) * abs(best.values[1] - best.values[0]) / np.sqrt(12))
    spread = float(np.linalg.norm(errors))
    if abs(number - best.neutral) < NORMAL_95 * spread:
        return None
    changed = make_model(model.form, coefficients, model.gains.shape[0], model.left_nm, model.before_nm)
    return Changed(best, changed, number, spread, closed, rival=rival, rival_leaves=rival_misfit / misfit)


def _doubt_number(form: Form, nominal: Walk, device: Walk, change: Change, about: float) -> float:
    """Standard deviation of a number by what nobody measured: the muscles' form, and the device walk's usual stride."""
    both = _Both.of(form, nominal, device)
    number = _draw_anew(both, change, about, 0)[1]
    alternatives = [
        [_Both.of(replace(form, fastest=pace * form.fastest), nominal, device) for pace in SPEEDS],
        [_Both.of(replace(form, lag_s=more * form.lag_s), nominal, device) for more in LAGS],
        [replace(both, respect=more * both.respect) for more in RESPECTS],
        [replace(both, device_form=replace(form, usual=form.usual + shift)) for shift in shifts_of_usual()],
    ]
    moved = [[_draw_anew(variant, change, about, 0)[1] - number for variant in kind] for kind in alternatives]
    return float(np.linalg.norm([np.sqrt(np.mean(np.square(shifts))) for shifts in moved]))


def shifts_of_usual() -> list[Values]:
    """Changes that the usual stride of a person may have between two walks, as the coefficients of its curve [rad]."""
    order = np.arange(1, SHIFT_HARMONICS + 1)
    size = SHIFT_RAD / np.sqrt(np.sum(order**-2.0))
    shifts = np.zeros((SHIFTS, 2, USUAL_HARMONICS))
    shifts[:, :, :SHIFT_HARMONICS] = np.random.default_rng(0).normal(size=(SHIFTS, 2, SHIFT_HARMONICS)) * size / order
    return [np.concatenate([[0.0], *shift]) for shift in shifts]


@dataclass(frozen=True, eq=False)
class _Both:
    """Both walks as normal equations of strides."""

    nominal: Sums
    device: Walk
    learned: Values  # (device stride,) 1 where learned from
    device_form: Form  # of the device walk, whose usual stride may be another one
    respect: float = GAIN_RIDGE

    @classmethod
    def of(cls, form: Form, nominal: Walk, device: Walk) -> _Both:
        """Sum up the strides of the Nominal walk."""
        sums = sum_pieces(form.columns(nominal.driven), nominal.moment, nominal.stride, int(nominal.stride.max()) + 1)
        count = int(device.stride.max()) + 1
        return cls(sums, device, (np.arange(count) < LEARNED * count).astype(float), form)

    def sums(self, change: Change, value: float) -> tuple[Sums, Sums]:
        """Of both walks with a change, which the Nominal walk has not."""
        driven = self.device.driven
        more = change.columns(driven, value)
        columns = np.hstack([self.device_form.columns(change.driven(driven, value)), more])
        mine = sum_pieces(columns, self.device.moment, self.device.stride, len(self.learned))
        wide = more.shape[1]
        squares = np.pad(self.nominal.squares, ((0, 0), (0, wide), (0, wide)))
        return Sums(squares, np.pad(self.nominal.match, ((0, 0), (0, wide))), self.nominal.power), mine

    def solve(self, sums: Sequence[Sums], weights: Sequence[Values]) -> tuple[Values, float]:
        """Coefficients and what they leave, strides so many times."""
        coefficients = solved(together(sums, weights), len(self.device.driven.signs), self.respect)
        misfit = sum(float(weight @ walk.left(coefficients)) for walk, weight in zip(sums, weights, strict=True))
        return coefficients, misfit

    @property
    def once(self) -> tuple[Values, Values]:
        """Each stride once, those of the device walk that are learned from."""
        return np.ones(len(self.nominal.power)), self.learned

    def misfit(self, change: Change, value: float) -> float:
        """What is left of the strides that are learned from [(N m)2]."""
        return self.solve(self.sums(change, value), self.once)[1]

    def held_out(self, change: Change, value: float) -> float:
        """What is left of the device strides that are not [(N m)2]."""
        sums = self.sums(change, value)
        return float((1 - self.learned) @ sums[1].left(self.solve(sums, self.once)[0]))


def _draw_anew(both: _Both, change: Change, about: float, draws: int) -> tuple[Values, float, list[float]]:
    """The coefficients, the number of a change, and that number from blocks of strides drawn anew."""
    step = change.values[1] - change.values[0] if len(change.values) > 1 else 0.0
    values = about + step * (FINER if step else np.zeros(1))
    sums = [both.sums(change, value) for value in values]
    linear = change.columns(both.device.driven, about).shape[1] > 0

    def best(weights: Sequence[Values]) -> tuple[Values, float]:
        tried = [both.solve(value_sums, weights) for value_sums in sums]
        at = int(np.argmin([misfit for _, misfit in tried]))
        return tried[at][0], float(tried[at][0][-1]) if linear else float(values[at])

    coefficients, number = best(both.once)
    return coefficients, number, [best(weights)[1] for weights in draw_blocks(both.once)[:draws]]


def together(walks: Iterable[Sums], weights: Iterable[Values]) -> Sums:
    """Normal equations of several walks, their strides so many times."""
    parts = [walk.of(weight) for walk, weight in zip(walks, weights, strict=True)]
    return Sums(*(a + b for a, b in zip(*parts, strict=True)))


def draw_blocks(once: Sequence[Values]) -> list[list[Values]]:
    """How often each stride of each walk is drawn, blocks of neighbours together; `DRAWS` times (Efron 1979)."""
    rng, blocks = np.random.default_rng(0), [np.arange(len(ones)) // BLOCK for ones in once]
    counts = [block[-1] + 1 for block in blocks]
    drawn = ([np.bincount(rng.integers(0, n, n), minlength=n) for n in counts] for _ in range(DRAWS))
    return [[ones * draws[block] for ones, block, draws in zip(once, blocks, times, strict=True)] for times in drawn]


def foot_mass(model: MuscleMoment, nominal: Walk, device: Walk, per_kg: Values) -> tuple[float, float]:
    """Mass at the foot in the device walk and its standard deviation [kg]: inverse dynamics knows nothing of it.

    What inverse dynamics computes without the mass is what muscles make, less what carries the mass along the measured
    path. Most of what muscles make in its stead no electrode sees: the leg departs from its usual path, and stiffness
    and damping resist. Strides of one walk hardly show these in swing, where whatever pushes a joint away moves its
    moment as well; the departure of the one walk's mean stride from the other's does. So gains, stiffness and damping
    against that departure, a curve over the stride that is the same in both walks, and the mass are fitted together to
    both.

    The deviation holds strides of both walks drawn anew, the usual stride of the device walk unknown by a degree, and
    what the number of parts of the stride makes of the mass.

    per_kg: what each kg adds to the net moment of the device walk (sample,) [N m/kg]
    """
    values, spreads = zip(*(_weigh_mass(model.form, nominal, device, per_kg, parts) for parts in PARTS), strict=True)
    return float(np.mean(values)), float(np.hypot(np.mean(spreads), np.std(values)))


def _weigh_mass(form: Form, nominal: Walk, device: Walk, per_kg: Values, parts: int) -> tuple[float, float]:
    """Mass and its standard deviation with stiffness in some parts of the stride."""
    muscles = len(nominal.driven.signs)
    own_form = replace(form, usual=usual_angle(device.driven, device.stride >= 0))
    signed = np.zeros(2 * muscles + FIRMNESS + parts + 1 + 1 + 2 * UNSEEN_HARMONICS + 1, bool)
    signed[: 2 * muscles + FIRMNESS + parts + 1] = True
    once = [np.ones(int(walk.stride.max()) + 1) for walk in (nominal, device)]

    def sums(walk: Walk, usual: Form, carried: Values, expected: Values) -> Sums:
        columns = _columns(usual, walk.driven, expected, parts)
        return sum_pieces(np.column_stack([columns, -carried]), walk.moment, walk.stride, int(walk.stride.max()) + 1)

    def mass(walks: Iterable[Sums], weights: Iterable[Values]) -> float:
        total = together(walks, weights)
        return float(solve_signed(tied(total.squares, muscles), total.match, signed)[-1])

    first = sums(nominal, form, np.zeros(len(nominal.moment)), form.usual)
    both = first, sums(device, own_form, per_kg, form.usual)
    value = mass(both, once)
    drawn = [mass(both, weights) for weights in draw_blocks(once)]
    shifted = [mass((first, sums(device, own_form, per_kg, form.usual + shift)), once) for shift in shifts_of_usual()]
    return value, float(np.hypot(np.std(drawn), np.std(shifted)))


def _columns(form: Form, driven: Driven, expected: Values, parts: int) -> Values:
    """Gains, firmness about the own mean stride, stiffness and damping against its departure, unseen waves."""
    behind = cycle(driven.phase, USUAL_HARMONICS) @ (expected - form.usual)
    slow_by = np.gradient(behind) * driven.rate_hz
    stiff = parts_of_stride(driven.phase, parts) * behind[:, None]
    return np.hstack(
        [form.muscles(driven), form.firm(driven), stiff, slow_by[:, None], cycle(driven.phase, UNSEEN_HARMONICS)]
    )
