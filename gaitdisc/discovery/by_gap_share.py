"""Selection where no explanation leaves mere noise: the plainest set that closes most of the gap."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from gaitdisc.discovery.beam import Beam, errs_more
from gaitdisc.discovery.candidate_model import CandidateModel, Part, fit_model
from gaitdisc.discovery.case import Case
from gaitdisc.discovery.criteria import CRITERIA
from gaitdisc.discovery.forward_selection import leaves
from gaitdisc.discovery.gap_share import CONVERGED, TURNS, CrossValidated, GapScale, cross_validated
from gaitdisc.discovery.noise import sensor_noise, white_noise
from gaitdisc.discovery.paired_test import PairedTest
from gaitdisc.discovery.scored_model import ScoredModel
from gaitdisc.discovery.shooting import Shooting
from gaitdisc.discovery.unnamed_terms import unnamed_terms

LISTED = 6  # sets beside the answer
TIED = 0.02  # of the gap, by which another set may cost more
WORTH_HALVING = 0.7  # of the error, which shorter runs must leave at most
HALF_PERIOD = 0.5
FEWEST = 12  # samples


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
    near: tuple[ScoredModel, ...]  # sets that cost hardly more
    others: tuple[ScoredModel, ...]  # the cheapest sets of all, whatever they cost


def scale_of(case: Case) -> GapScale:
    """Return what gaps are measured against."""
    observed = case.measured.observed
    spread = np.nanstd(observed, axis=(0, 1))
    known = case.sensor_noise
    noise = np.where(np.isnan(known), sensor_noise(observed), known)
    return GapScale(noise, np.where(spread > 0, spread, 1.0))


def leaves_noise(case: Case, now: ScoredModel) -> bool:
    """Whether what a model leaves is no larger than the noise of the sensors.

    Where this is not known (a filtered record whose file does not say it), whether it is autocorrelated no further than
    by the filter; where the simulation itself errs, and its errors with it, whether it is a small share of the spread.
    """
    if case.search.base.inexact and scale_of(case).relative(now.model.fit) < CRITERIA.inexact:
        return True
    known = np.isfinite(case.sensor_noise)
    if not known.all():
        return not now.noise.is_autocorrelated
    return leaves(now, case.sensor_noise) < CRITERIA.mere_noise


def closing_most(case: Case, scale: GapScale, also: tuple[tuple[Part, ...], ...]) -> Outcome | None:
    """Search the plainest set of explanations that closes most of the gap; None where none closes enough.

    First on runs on which the simulation as read stays near the data, then on longer ones, where losses show that are
    small in a short run.

    also: sets that another search found, weighed beside those that are found here
    """
    search = case.search
    search = replace(search, candidates=(*search.candidates, *unnamed_terms(search.base, search.places)))
    as_read = near_runs(case, scale)
    if scale.agrees(as_read.model.fit) or not as_read.gap:
        return None
    beam = Beam(search, scale, as_read)
    beam.fit(also)
    best = beam.select_forward(as_read)
    longer = on_longer_runs(case, scale, best) if best.model.explanations else None
    if longer:
        beam = Beam(search, scale, as_read_on(case, scale, as_read, longer))
        if not beam.as_read.gap:
            return None
        best = beam.select_forward(longer)
    now, small = beam.material(best)
    now = beam.plainest(now)
    if not now.model.explanations:
        return None
    near, others = (tuple(one.scored for one in beam.near(now, within)) for within in (TIED, np.inf))
    closed = 1 - now.gap / beam.as_read.gap
    p = min(len(search.candidates) * errs_more(beam.as_read, now), 1.0)
    test = PairedTest(p, len(now.errors), float((beam.as_read.errors - now.errors).sum()), case.alpha)
    return Outcome(beam.as_read.scored, now.scored, closed, test, tuple(small), near, others[:LISTED])


def near_runs(case: Case, scale: GapScale) -> CrossValidated:
    """Fit the simulation as read to runs that are halved until it stays near the data.

    Of runs on which it never does, the longest are taken that halving makes hardly better.
    """
    period = min(case.rhythm.period, case.rhythm.duration / 2) * case.rhythm.rate
    samples, tried = case.longest, []
    while True:
        shooting = case.learned_runs(samples)
        now = cross_validated(scale, shooting, case.search.base, (), _as_read(case, scale, shooting))
        tried.append((scale.relative(now.model.fit), now))
        if tried[-1][0] < CRITERIA.near or samples / 2 < max(FEWEST, HALF_PERIOD * period):
            break
        samples //= 2
    least = min(error for error, _ in tried)
    return next(now for error, now in tried if error * WORTH_HALVING <= least)


def _as_read(case: Case, scale: GapScale, shooting: Shooting) -> CandidateModel:
    """Fit from the guessed start states, as if the simulation erred by the whole spread of the channels."""
    enough = CONVERGED * shooting.seen.size
    base, plain = case.search.base, shooting.with_noise(white_noise(scale.spread))
    return fit_model(plain, base, (), case.guess.starts(shooting.segments), TURNS, enough)


def on_longer_runs(case: Case, scale: GapScale, now: CrossValidated) -> CrossValidated | None:
    """Fit what was found to runs ever twice as long, while it stays near the data; None if none is longer."""
    longest, guess, found = case.longest, case.guess, None
    samples = now.shooting.segments.span
    while samples < longest:
        before, samples = found or now, min(2 * samples, longest)
        guess = guess.with_run(before.shooting.segments, before.model.fit.states)
        shooting = replace(case.learned_runs(samples), past=guess.states)
        shooting = shooting.with_noise(scale.error_of(before.model.fit))
        starts = guess.starts(shooting.segments)
        begun = fit_model(shooting, case.search.base, before.model.parts, starts, TURNS, like=before.model)
        longer = cross_validated(scale, shooting, case.search.base, begun.parts, begun)
        if not scale.relative(longer.model.fit) < CRITERIA.near:
            break
        found = longer
    return found


def as_read_on(case: Case, scale: GapScale, as_read: CrossValidated, longer: CrossValidated) -> CrossValidated:
    """Run the simulation as read over the runs of what was found; an error beyond the spread counts as the spread.

    as_read, longer: the simulation as read on shorter runs, and what was found on longer ones
    """
    shooting = longer.shooting.with_noise(scale.error_of(as_read.model.fit))
    starts = longer.model.fit.starts
    model = fit_model(shooting, case.search.base, (), starts, TURNS, like=as_read.model)
    most = CRITERIA.lost * (scale.spread / scale.size) ** 2
    square = np.fmin((model.fit.residual / scale.size) ** 2, most)  # the greater where a run has failed
    mean = float(square[shooting.known].mean())
    return CrossValidated(model, shooting, np.full(len(longer.errors), mean), scale.gap_above(mean))
