"""The price of an explanation: the more kinds of motion it can imitate, the more of a gap it has to close."""

from __future__ import annotations

from gaitdisc.discovery.account import Part

PLAIN = 0.03  # of the gap
PRICES = {
    "input_gain": 0.04,
    "input_delay": 0.04,
    "sensor_gain": 0.04,
    "sensor_offset": 0.04,
    "sensor_lag": 0.05,
    "sensor_drift": 0.05,
    "quadratic_stiffness": 0.05,
    "linear_coupling": 0.05,
    "one_sided_spring": 0.05,
    "dead_zone_spring": 0.05,
    "one_sided_damper": 0.06,
    "phase_locked_moment": 0.08,
    "unnamed": 0.08,
    "periodic_forcing": 0.10,
    "delayed_feedback": 0.10,
    "product_coupling": 0.10,
}
LOSSES = ("viscous_damping", "coulomb_friction", "quadratic_drag")
DRIVES = 0.05  # more, for a friction that drives the motion


def price_of(part: Part) -> float:
    """Return the share of the gap that an explanation must close to be worth its statement.

    Parameters
    ----------
    part : Part
        With its numbers: a friction that drives costs more than one that resists.
    """
    name = part.candidate.name
    drives = name in LOSSES and part.values.get("factor", 0.0) > 0
    return PRICES.get(name, PLAIN) + DRIVES * drives
