"""How the amounts and effects of a discovery are said, and which recording would separate two explanations."""

import math
import re

from gaitdisc.discovery.candidate import Candidate
from gaitdisc.discovery.result import Discovery, Estimate, FoundEffect
from gaitdisc.words import with_unit

LONGEST, FIGURES = 4, 6  # digits behind the point, digits in all
MINUS = "\N{MINUS SIGN}"
_RAD = re.compile(r"^rad(?=$|/s)")
SPRINGS = frozenset(
    {
        "linear_stiffness",
        "quadratic_stiffness",
        "cubic_stiffness",
        "one_sided_spring",
        "dead_zone_spring",
        "gravity_moment",
    }
)
LOSSES = frozenset({"viscous_damping", "one_sided_damper", "contact_damper", "quadratic_drag", "coulomb_friction"})
MEMORY = frozenset({"hysteresis", "series_elasticity"})
CLOCKED = frozenset({"periodic_forcing", "phase_locked_moment"})
LATE = frozenset({"input_delay", "input_lag", "sensor_lag", "delayed_feedback"})
SENSORS = frozenset({"sensor_gain", "sensor_offset", "sensor_lag", "sensor_drift"})
STEADY = frozenset({"constant_load", "sensor_offset", "sensor_drift", "linear_stiffness"})
# the first that fits, of two names one in each of two groups
APART = (
    (STEADY, STEADY, "the system at rest in two known positions"),
    (SPRINGS, SPRINGS, "movement through a wider range, in both directions from rest"),
    (LOSSES, LOSSES, "the same movement at clearly different speeds"),
    (MEMORY, MEMORY, "the same movement at clearly different speeds: hysteresis does not depend on the speed"),
    (CLOCKED, CLOCKED, "the same movement at another cadence, or started at another time"),
    (LATE, LATE, "a sharp push that both the drive and the sensor record, or a second sensor of the same movement"),
    (SENSORS, SENSORS | {"wrong_parameter", "input_gain"}, "a calibration of the sensor against a known movement"),
    (
        frozenset({"wrong_parameter"}),
        SPRINGS | LOSSES | {"linear_coupling", "constant_load"},
        "a separate measurement of the parameter, because both candidates may produce the same term",
    ),
    (
        MEMORY,
        SPRINGS,
        "a step that is then held still: an effect with memory relaxes or stays deflected, but a spring does neither",
    ),
    (MEMORY, LOSSES, "slow and fast movement of several amplitudes, reversed half-way"),
    (SPRINGS, LOSSES, "slow movement through the entire range, in which only a spring acts"),
    (CLOCKED, SPRINGS | LOSSES | LATE, "the same movement at another cadence"),
    (SENSORS, SPRINGS | LOSSES | {"constant_load", "linear_coupling"}, "a second sensor of the same movement"),
    (frozenset({"input_gain"}), frozenset({"wrong_parameter"}), "movement with the drive switched off"),
    (frozenset({"input_gain", "input_delay"}), SPRINGS | LOSSES, "movement with the drive switched off"),
)


def display_unit(unit: str) -> tuple[str, float]:
    """Return the unit in which a person reads a number, and the factor to it: degrees for an angle or its rates.

    >>> display_unit("N m/rad"), display_unit("rad/s")[0], round(display_unit("rad")[1], 3)
    (('N m/rad', 1.0), 'deg/s', 57.296)
    """
    if _RAD.match(unit):
        return _RAD.sub("deg", unit), math.degrees(1.0)
    return ("" if unit == "1" else unit), 1.0


def display_channel(discovery: Discovery, channel: str) -> tuple[str, float]:
    """Return the unit in which a person reads a channel, and the factor to it."""
    return display_unit(dict(zip(discovery.channels, discovery.units, strict=True))[channel])


def amount(value: float, step: float = math.nan) -> str:
    """Write a number with three digits, or with those that a step of it leaves worth writing.

    >>> amount(0.0144), amount(285.9, 14), amount(2.003, 0.2), amount(-12345.6)
    ('0.0144', '286', '2.0', '−12346')
    """
    if not math.isfinite(value):
        return "not computed"
    size = step if math.isfinite(step) and step > 0 else abs(value) / 100 if value else 1.0
    digits = -math.floor(math.log10(size))
    if value and (abs(digits) > LONGEST):
        figures = max(1, min(math.floor(math.log10(abs(value))) + digits + 1, FIGURES))
        return f"{value:.{figures}g}".replace("-", MINUS)
    text = f"{value:.{max(digits, 0)}f}"
    return text.replace("-", MINUS)


def estimate_text(estimate: Estimate) -> str:
    """Write an estimate with its interval.

    >>> estimate_text(Estimate(286.0, 279.2, 292.8, "N m/rad"))
    '286 N m/rad (95 % CI 279 to 293)'
    >>> estimate_text(Estimate(-0.02, -0.03, -0.01, "rad"))
    '−1.1 deg (95 % CI −1.7 to −0.6)'
    """
    unit, factor = display_unit(estimate.unit)
    value, low, high = (factor * number for number in (estimate.value, estimate.low, estimate.high))
    if not (math.isfinite(low) and math.isfinite(high)):
        return with_unit(amount(value), unit)
    step = (high - low) / 2
    return f"{with_unit(amount(value, step), unit)} (95 % CI {amount(low, step)} to {amount(high, step)})"


def brief_text(estimate: Estimate) -> str:
    """Write an estimate without its interval.

    >>> brief_text(Estimate(0.035, 0.033, 0.037, "rad"))
    '2.0 deg'
    """
    unit, factor = display_unit(estimate.unit)
    return with_unit(amount(factor * estimate.value, factor * (estimate.high - estimate.low) / 2), unit)


def spoken(name: str) -> str:
    """Return an effect's name as it is said.

    >>> spoken("one_sided_spring"), spoken("coulomb_friction")
    ('one-sided spring', 'Coulomb friction')
    """
    return name.replace("one_sided", "one-sided").replace("coulomb", "Coulomb").replace("_", " ")


def at_place(kind: str, place: str) -> str:
    """Say where something enters.

    >>> at_place("port", "ankle_moment"), at_place("equation", "v")
    ('at the ankle_moment port', 'in the equation of v')
    """
    if kind == "port":
        return f"at the {place} port"
    return f"in the {kind} {place}" if kind != "equation" else f"in the equation of {place}"


def named_at(effect: FoundEffect | Candidate) -> str:
    """Name an effect and say where it enters."""
    return f"{spoken(effect.name)} {at_place(effect.kind, effect.place)}"


def outside_text(effect: FoundEffect, estimate: Estimate) -> str:
    """Say that a wrong parameter lies outside the bounds that the file gives it; nothing where it does not.

    >>> wrong = FoundEffect("parameter", "g", "wrong_parameter", "", bounds=(9.79, 9.83))
    >>> outside_text(wrong, Estimate(17.0, 14.0, 20.0, "m/s^2")), outside_text(wrong, Estimate(9.8, 9.7, 9.9, "m/s^2"))
    ('outside its bounds, 9.79 to 9.83 m/s^2', '')
    """
    if not effect.bounds or effect.bounds[0] <= estimate.value <= effect.bounds[1]:
        return ""
    unit, factor = display_unit(estimate.unit)
    low, high = (f"{factor * bound:.6g}" for bound in effect.bounds)
    if not (math.isfinite(effect.bounds[0]) and math.isfinite(effect.bounds[1])):
        above = estimate.value > effect.bounds[1]
        return f"{'above' if above else 'below'} its bound, {with_unit(high if above else low, unit)}"
    return f"outside its bounds, {with_unit(f'{low} to {high}', unit)}"


def would_distinguish(name: str, other: str) -> str:
    """Return which recording would separate two explanations.

    >>> would_distinguish("coulomb_friction", "viscous_damping")
    'the same movement at clearly different speeds'
    """
    if name == other:
        return "movement in which the inputs of the two places differ"
    for first, second, recording in APART:
        if (name in first and other in second) or (other in first and name in second):
            return recording
    return "longer trials of larger and more varied movement"
