"""The penalty of an explanation: the more kinds of motion it can imitate, the more of a gap it has to close."""

from __future__ import annotations

from collections.abc import Mapping

from gaitdisc.discovery.candidate import Candidate

PLAIN = 0.03  # of the gap
PENALTIES = {
    "input_gain": 0.04,
    "input_delay": 0.04,
    "input_lag": 0.05,
    "sensor_gain": 0.04,
    "sensor_offset": 0.04,
    "sensor_lag": 0.05,
    "sensor_drift": 0.05,
    "quadratic_stiffness": 0.05,
    "linear_coupling": 0.05,
    "one_sided_spring": 0.05,
    "dead_zone_spring": 0.05,
    "one_sided_damper": 0.06,
    "contact_damper": 0.08,
    "hysteresis": 0.08,
    "series_elasticity": 0.08,
    "phase_locked_moment": 0.08,
    "unnamed": 0.08,
    "input_saturation": 0.08,
    "input_product": 0.10,
    "periodic_forcing": 0.10,
    "delayed_feedback": 0.10,
    "product_coupling": 0.10,
}
LOSSES = (
    "viscous_damping",
    "coulomb_friction",
    "quadratic_drag",
    "contact_damper",
    "hysteresis",
    "series_elasticity",
)
DRIVES = 0.05  # more, for a friction that drives the motion


def penalty_of(candidate: Candidate, values: Mapping[str, float]) -> float:
    """Return the share of the gap that an explanation must close to be worth its statement.

    values: its numbers: a friction that drives costs more than one that resists
    """
    drives = candidate.name in LOSSES and values.get("factor", 0.0) > 0
    return PENALTIES.get(candidate.name, PLAIN) + DRIVES * drives
