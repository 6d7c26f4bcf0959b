"""The penalty of an explanation: the more kinds of motion it can imitate, the more of a gap it has to close."""

from __future__ import annotations

from collections.abc import Mapping

from gaitdisc.discovery.candidate import Candidate
from gaitdisc.discovery.criteria import CRITERIA

BENT = (
    "input_gain",
    "input_delay",
    "input_lag",
    "sensor_gain",
    "sensor_offset",
    "sensor_lag",
    "sensor_drift",
    "quadratic_stiffness",
    "linear_coupling",
    "one_sided_spring",
    "dead_zone_spring",
    "one_sided_damper",
)
FLEXIBLE = (
    "contact_damper",
    "hysteresis",
    "series_elasticity",
    "phase_locked_moment",
    "unnamed",
    "input_saturation",
    "input_product",
    "periodic_forcing",
    "delayed_feedback",
    "product_coupling",
)
LOSSES = ("viscous_damping", "coulomb_friction", "quadratic_drag", "contact_damper", "hysteresis", "series_elasticity")


def penalty_of(candidate: Candidate, values: Mapping[str, float]) -> float:
    """Return the share of the gap that an explanation must close to be worth its statement.

    values: its numbers: a friction that drives costs the least that is named more than one that resists
    """
    drives = candidate.name in LOSSES and values.get("factor", 0.0) > 0
    flexible, bent = candidate.name in FLEXIBLE, candidate.name in BENT
    price = CRITERIA.bent if bent else CRITERIA.plain
    return price + CRITERIA.bent * flexible + CRITERIA.matters * drives
