"""Wrong starts: states whose `initial` in the file is not where the trials begin."""

from __future__ import annotations

import numpy as np

from gaitdisc.discovery.criteria import CRITERIA
from gaitdisc.discovery.estimates import NORMAL_95
from gaitdisc.discovery.scored_model import ScoredModel
from gaitdisc.results.discovery import Estimate
from gaitdisc.simulation.simulation import Simulation


def wrong_starts(simulation: Simulation, as_read: ScoredModel) -> dict[str, Estimate]:
    """Find the states that begin elsewhere than the file says.

    Where trials begin at unlike places, no number of the file can be where they all begin: the error of the mean holds
    their spread (the ratio of Birge 1932, Phys. Rev. 40, 207).

    returns: state -> where the trials begin on average, weighted by how well each shows it, with its 95 % interval
    """
    fit, segments = as_read.model.fit, as_read.shooting.segments
    first = np.flatnonzero(segments.begin == 0)
    slopes = fit.slopes[first][..., : fit.starts.shape[1]]
    variance = np.stack([np.diag(np.linalg.pinv(one.T @ one)) for one in slopes])
    weight = 1 / np.maximum(variance, 1e-300)
    mean = (weight * fit.starts[first]).sum(axis=0) / weight.sum(axis=0)
    unlike = (weight * (fit.starts[first] - mean) ** 2).sum(axis=0) / max(len(first) - 1, 1)
    error = np.sqrt(np.maximum(unlike, 1.0) / weight.sum(axis=0))
    return {
        state.name: Estimate(float(at), float(at - NORMAL_95 * off), float(at + NORMAL_95 * off), state.unit)
        for state, at, off in zip(simulation.states, mean, error, strict=True)
        if state.initial is not None and abs(at - state.initial) > CRITERIA.start * off
    }


def begun_at(simulation: Simulation, starts: dict[str, Estimate]) -> Simulation:
    """Return the simulation with other starts."""
    return simulation.with_starts({name: float(f"{start.value:.6g}") for name, start in starts.items()})
