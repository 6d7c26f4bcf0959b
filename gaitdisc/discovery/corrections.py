"""Numbers that moved within their bounds: no finding, but what the rest of an answer was fitted with."""

from __future__ import annotations

import numpy as np

from gaitdisc.discovery.candidate import Candidate
from gaitdisc.discovery.candidate_model import CandidateModel
from gaitdisc.discovery.estimates import NORMAL_95
from gaitdisc.results.discovery import Correction, Estimate
from gaitdisc.simulation.simulation import Simulation


def corrections_of(model: CandidateModel, base: Simulation) -> tuple[Correction, ...]:
    """List the numbers that were fitted within their bounds and moved, each with its 95 % interval inside these."""
    prior, free = model.fit.prior, model.fit.free
    error = np.sqrt(np.diag(model.fit.covariance))
    units, found = {one.name: one.unit for one in base.parameters}, []
    for name, place, given, low, high in zip(
        prior.names, prior.places, prior.value, prior.low, prior.high, strict=True
    ):
        value, half = float(f"{model.fit.values[place]:.6g}"), NORMAL_95 * float(error[free.index(name)])
        if value != float(f"{given:.6g}"):
            interval = max(value - half, float(low)), min(value + half, float(high))
            found.append(Correction(name, float(given), Estimate(value, *interval, units[name])))
    return tuple(found)


def file_bounds(base: Simulation, candidate: Candidate) -> tuple[float, ...]:
    """Return the bounds that the file gives a wrong parameter, infinite where it has but one."""
    for one in base.parameters if candidate.verdict == "wrong_parameter" else ():
        if one.name == candidate.place and (one.low is not None or one.high is not None):
            return (-np.inf if one.low is None else one.low, np.inf if one.high is None else one.high)
    return ()


def corrected(base: Simulation, corrections: tuple[Correction, ...]) -> Simulation:
    """Return a simulation with corrected numbers."""
    return base.with_values({one.parameter: one.found.value for one in corrections})
