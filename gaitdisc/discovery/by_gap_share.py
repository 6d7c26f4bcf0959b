"""Selection where no explanation leaves mere noise: the plainest set that closes most of the gap."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from gaitdisc.discovery.beam import Beam, errs_more
from gaitdisc.discovery.candidate_model import Part
from gaitdisc.discovery.forward_selection import leaves
from gaitdisc.discovery.gap_share import CrossValidated, GapScale, cross_validated
from gaitdisc.discovery.held_out import proof_of
from gaitdisc.discovery.paired_test import PairedTest
from gaitdisc.discovery.problem import Problem
from gaitdisc.discovery.scored_model import ScoredModel
from gaitdisc.discovery.sensor_noise import sensor_noise
from gaitdisc.discovery.unnamed_terms import unnamed_terms
from gaitdisc.discovery.windows import as_read_on, near_runs, on_longer_runs

MERE_NOISE = 1.3  # times the variance of the sensors' noise: its own estimate errs
INEXACT_LEAVES = 0.05  # of a channel's spread, which a simulation that itself errs may leave beside the noise
LOST = 4.0  # squared spreads, which a run that has left the data errs by
TIED = 0.02  # of the gap, by which another set may cost more


@dataclass(frozen=True, eq=False)
class Outcome:
    """A set of explanations, and what was weighed beside it."""

    as_read: ScoredModel  # the simulation as read and with the set, on the same runs
    now: ScoredModel  # the simulation as read and with the set, on the same runs
    closed: float  # share of the gap that goes, on runs left out of the fit
    # of the errors left out of the fit, with and without the set; its p times the number of explanations that were open
    # (Bonferroni), for the same runs chose among these
    test: PairedTest
    small: tuple[Part, ...]  # explanations that close too little to be named, or not beyond chance
    near: tuple[ScoredModel, ...]


def scale_of(problem: Problem) -> GapScale:
    """Return what gaps are measured against."""
    observed = problem.measured.observed
    spread = np.nanstd(observed, axis=(0, 1))
    known = problem.sensor_noise
    noise = np.where(np.isnan(known), sensor_noise(observed), known)
    return GapScale(noise, np.where(spread > 0, spread, 1.0))


def leaves_noise(problem: Problem, now: ScoredModel) -> bool:
    """Whether what a model leaves is no larger than the noise of the sensors.

    Where this is not known (a filtered record whose file does not say it), whether it is autocorrelated no further than
    by the filter; where the simulation itself errs, and its errors with it, whether it is a small share of the spread.
    """
    if problem.search.base.inexact and scale_of(problem).relative(now.model.fit) < INEXACT_LEAVES:
        return True
    known = np.isfinite(problem.sensor_noise)
    if not known.all():
        return not now.noise.is_autocorrelated
    return leaves(now, problem.sensor_noise) < MERE_NOISE


def closing_most(problem: Problem, scale: GapScale, also: tuple[tuple[Part, ...], ...]) -> Outcome | None:
    """Search the plainest set of explanations that closes most of the gap; None where none closes enough.

    First on runs on which the simulation as read stays near the data, then on longer ones, where losses show that are
    small in a short run.

    also: sets that another search found, weighed beside those that are found here
    """
    search = problem.search
    search = replace(search, candidates=(*search.candidates, *unnamed_terms(search.base, search.places)))
    as_read = near_runs(problem, scale)
    if scale.agrees(as_read.model.fit):
        return None
    beam = Beam(search, scale, as_read)
    for parts in also:
        one = cross_validated(scale, as_read.shooting, search.base, parts, as_read.model)
        beam.known[one.model.explanations] = one
    best = beam.select_forward(as_read)
    longer = on_longer_runs(problem, scale, best) if best.model.explanations else None
    if longer:
        beam = Beam(search, scale, as_read_on(problem, scale, as_read, longer))
        best = beam.select_forward(longer)
    now, small = beam.material(best)
    now = beam.plainest(now)
    if not now.model.explanations or not whole_runs_err_less(problem, scale, beam.as_read, now):
        return None
    near = tuple(one.scored for one in beam.near(now, TIED))
    closed = 1 - now.gap / beam.as_read.gap
    p = min(len(search.candidates) * errs_more(beam.as_read, now), 1.0)
    test = PairedTest(p, len(now.errors), float((beam.as_read.errors - now.errors).sum()))
    return Outcome(beam.as_read.scored, now.scored, closed, test, tuple(small), near)


def whole_runs_err_less(problem: Problem, scale: GapScale, as_read: CrossValidated, now: CrossValidated) -> bool:
    """Whether held-out trials, run as a whole from the best start, err less with a set than without.

    A delay of what was measured observes the state and closes any gap of a short run.
    """
    whole = problem.learned_runs(problem.longest).segments
    like = ScoredModel(now.model, replace(now.shooting, segments=whole))
    proof = proof_of(problem, as_read.scored, now.scored, like)
    before, after = (
        np.fmin((one.fit.residual / scale.spread) ** 2, LOST).mean() for one in (proof.before, proof.after)
    )
    return bool(after < before)
