"""A mass at the foot of which inverse dynamics knows nothing, weighed at one joint of both walks of a person.

What inverse dynamics computes without the mass is what muscles make, less what carries the mass along the measured
path. Most of what muscles make in its stead no electrode sees: the leg departs from its usual path, and stiffness and
damping resist. Strides of one walk hardly show these in swing, where whatever pushes a joint away moves its moment as
well; the departure of the one walk's mean stride from the other's does. So gains, stiffness and damping against that
departure, a curve over the stride that is the same in both walks, and the mass are fitted together to both.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from gaitdisc.discovery.changed_moment import Walk, drawn_blocks, shifts_of_usual
from gaitdisc.processing.muscle_moment import (
    FIRMNESS,
    USUAL_HARMONICS,
    Driven,
    Form,
    MuscleMoment,
    Sums,
    Values,
    bounded,
    cycle,
    parts_of_stride,
    sums_of,
    tied,
    usual_angle,
)

UNSEEN_HARMONICS = 8  # of the curve over the stride that no electrode sees
PARTS = (1, 3)  # of the stride, each of which may resist a departure differently; what either says counts half


def foot_mass(model: MuscleMoment, nominal: Walk, device: Walk, per_kg: Values) -> tuple[float, float]:
    """Mass at the foot in the device walk and its standard deviation [kg].

    The deviation holds strides of both walks drawn anew, the usual stride of the device walk unknown by a degree, and
    what the number of parts of the stride makes of the mass.

    per_kg: what each kg adds to the net moment of the device walk (sample,) [N m/kg]
    """
    values, spreads = zip(*(_weighed(model.form, nominal, device, per_kg, parts) for parts in PARTS), strict=True)
    return float(np.mean(values)), float(np.hypot(np.mean(spreads), np.std(values)))


def _weighed(form: Form, nominal: Walk, device: Walk, per_kg: Values, parts: int) -> tuple[float, float]:
    """Mass and its standard deviation with stiffness in some parts of the stride."""
    muscles = len(nominal.driven.signs)
    own = replace(form, usual=usual_angle(device.driven, device.stride >= 0))
    signed = np.zeros(2 * muscles + FIRMNESS + parts + 1 + 1 + 2 * UNSEEN_HARMONICS + 1, bool)
    signed[: 2 * muscles + FIRMNESS + parts + 1] = True
    once = [np.ones(int(walk.stride.max()) + 1) for walk in (nominal, device)]

    def sums(walk: Walk, usual: Form, carried: Values, expected: Values) -> Sums:
        columns = _columns(usual, walk.driven, expected, parts)
        return sums_of(np.column_stack([columns, -carried]), walk.moment, walk.stride, int(walk.stride.max()) + 1)

    def mass(each: Iterable[Sums], weights: Iterable[Values]) -> float:
        pieces = [one.of(weight) for one, weight in zip(each, weights, strict=True)]
        total = Sums(*(a + b for a, b in zip(*pieces, strict=True)))
        return float(bounded(tied(total.squares, muscles), total.match, signed)[-1])

    first = sums(nominal, form, np.zeros(len(nominal.moment)), form.usual)
    both = first, sums(device, own, per_kg, form.usual)
    value = mass(both, once)
    drawn = [mass(both, weights) for weights in drawn_blocks(once)]
    shifted = [mass((first, sums(device, own, per_kg, form.usual + one)), once) for one in shifts_of_usual()]
    return value, float(np.hypot(np.std(drawn), np.std(shifted)))


def _columns(own: Form, driven: Driven, expected: Values, parts: int) -> Values:
    """Gains, firmness about the walk's own mean stride, stiffness and damping against its departure, unseen waves.

    expected: mean angle and its harmonics over the stride that the person is used to
    """
    behind = cycle(driven.phase, USUAL_HARMONICS) @ (expected - own.usual)
    slow_by = np.gradient(behind) * driven.rate_hz
    stiff = parts_of_stride(driven.phase, parts) * behind[:, None]
    return np.hstack(
        [own.muscles(driven), own.firm(driven), stiff, slow_by[:, None], cycle(driven.phase, UNSEEN_HARMONICS)]
    )
