"""A trial that goes with no explanation of the others: a gain, an offset, a sensor that stood still, another person."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from gaitdisc.discovery.forward_selection import leaves
from gaitdisc.discovery.gap_share import MODEL_ERROR
from gaitdisc.discovery.odd_trials import KIND
from gaitdisc.discovery.problem import Problem
from gaitdisc.discovery.scored_model import ScoredModel
from gaitdisc.recording import Finding
from gaitdisc.simulation.measured import Measured

FEWEST_TRIALS, MOST_TRIALS = 4, 8
APART = 2.0  # times the error must stay whichever other trial is left out


def without_trial_apart(problem: Problem) -> Measured:
    """Return the trials without the one that goes with no explanation of the others, with a finding.

    The simulation as read is fitted to all trials. What the best single explanation would leave of all but one of them
    follows from its slopes, to first order, for each trial in turn: this finds the one to suspect. The others are then
    searched without it, and for comparison without the next.

    problem: the simulation as read and all trials, which leave more than noise whatever is named
    returns: the trials as they were where none stands apart, or there are too few or too many to say
    """
    measured = problem.measured
    count = len(measured.trials)
    if not FEWEST_TRIALS <= count <= MOST_TRIALS:
        return measured
    spread = np.nanstd(measured.observed, axis=(0, 1))
    as_read = replace(problem, learned=tuple(range(count))).as_read()
    trial, other = np.argsort(_promised(problem, as_read))[:2].tolist()
    least = _left_without(problem, trial, spread)
    wanted = max(APART * least, MODEL_ERROR)
    if _as_read_left(as_read, other, spread) < wanted:  # what a search leaves of the same trials is no more
        return measured
    next_least = _left_without(problem, other, spread)
    if next_least < wanted:
        return measured
    what = (
        f"trial {measured.trials[trial]!r} goes with no explanation of the others: without it the best one leaves "
        f"{least:.2g} standard deviations, without trial {measured.trials[other]!r}, the next best to leave out, "
        f"{next_least:.2g}"
    )
    source = measured.source or problem.search.base.title
    spoils = "this trial, which was left out: look at its gain, its offset and whether a channel stood still"
    kept = measured.selected([one for one in range(count) if one != trial])
    return replace(kept, findings=(*kept.findings, Finding("warning", KIND, source, what, spoils)))


def _promised(problem: Problem, as_read: ScoredModel) -> NDArray[np.float64]:
    """Mean square that the best single explanation leaves of all other trials, to first order (trial,)."""
    search, model = problem.search, as_read.model
    return search.scorer(as_read.shooting, model).left_without_each(search.open_beside(model))


def _as_read_left(as_read: ScoredModel, trial: int, spread: NDArray[np.float64]) -> float:
    """Root mean square that the simulation as read leaves of all other trials [standard deviations]."""
    others = as_read.shooting.segments.trial != trial
    return float(np.sqrt(np.nanmean((as_read.model.fit.residual[others] / spread) ** 2)))


def _left_without(problem: Problem, trial: int, spread: NDArray[np.float64]) -> float:
    """Root mean square that the best single explanation of all other trials leaves [standard deviations]."""
    others = tuple(other for other in range(len(problem.measured.trials)) if other != trial)
    part = replace(problem, learned=others)
    as_read = part.as_read()
    return float(np.sqrt(min(leaves(one, spread) for one in (as_read, *part.search.extended(as_read)))))
