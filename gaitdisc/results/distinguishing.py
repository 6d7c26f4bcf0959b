"""Which recording would separate two explanations that fit the data at hand alike."""

from __future__ import annotations

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
REMEMBERING = frozenset({"hysteresis", "series_elasticity"})
CLOCKED = frozenset({"periodic_forcing", "phase_locked_moment"})
LATE = frozenset({"input_delay", "input_lag", "sensor_lag", "delayed_feedback"})
SENSORS = frozenset({"sensor_gain", "sensor_offset", "sensor_lag", "sensor_drift"})
STEADY = frozenset({"constant_load", "sensor_offset", "sensor_drift", "linear_stiffness"})
# from the narrowest; both names must be in a group, or one in each of two
WITHIN = (
    (STEADY, "a recording at rest in two known positions"),
    (SPRINGS, "movement through a wider range, to both sides of rest"),
    (LOSSES, "the same movement at clearly different speeds"),
    (REMEMBERING, "the same movement at clearly different speeds: hysteresis does not depend on them"),
    (CLOCKED, "the same movement at another cadence, or begun at another time"),
    (LATE, "a sharp push that both the drive and the sensor see, or a second sensor of the same movement"),
    (SENSORS, "a calibration of the sensor against a known movement"),
)
BETWEEN = (
    (
        frozenset({"wrong_parameter"}),
        SPRINGS | LOSSES | {"linear_coupling", "constant_load"},
        "a measurement of the parameter itself, since both may write the same term",
    ),
    (
        REMEMBERING,
        SPRINGS,
        "movement held still after a step: what remembers relaxes or stays bent, a spring does neither",
    ),
    (REMEMBERING, LOSSES, "slow and fast movement of several amplitudes, turned back half-way"),
    (SPRINGS, LOSSES, "slow movement through the whole range, where only a spring is left"),
    (CLOCKED, SPRINGS | LOSSES | LATE, "the same movement at another cadence"),
    (SENSORS, frozenset({"wrong_parameter", "input_gain"}), "a calibration of the sensor against a known movement"),
    (SENSORS, SPRINGS | LOSSES | {"constant_load", "linear_coupling"}, "a second sensor of the same movement"),
    (frozenset({"input_gain"}), frozenset({"wrong_parameter"}), "a recording with the drive switched off"),
    (frozenset({"input_gain", "input_delay"}), SPRINGS | LOSSES, "a recording with the drive switched off"),
)


def would_distinguish(name: str, other: str) -> str:
    """Return which recording would separate two explanations.

    >>> would_distinguish("coulomb_friction", "viscous_damping")
    'the same movement at clearly different speeds'
    """
    if name == other:
        return "movement in which what the two places see differs"
    pair = {name, other}
    for group, recording in WITHIN:
        if pair <= group:
            return recording
    for one, two, recording in BETWEEN:
        if (name in one and other in two) or (other in one and name in two):
            return recording
    return "longer trials of larger and more varied movement"
