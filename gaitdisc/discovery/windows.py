"""How long the runs are on which explanations are weighed: as long as the simulation as read stays near the data."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from gaitdisc.discovery.candidate_model import CandidateModel, fit_model
from gaitdisc.discovery.gap_share import CONVERGED, TURNS, CrossValidated, GapScale, cross_validated
from gaitdisc.discovery.noise import white_noise
from gaitdisc.discovery.problem import Problem
from gaitdisc.discovery.shooting import Shooting

NEAR = 0.25  # of a channel's spread
WORTH_HALVING = 0.7  # of the error, which shorter runs must leave at most
HALF_PERIOD = 0.5
FEWEST = 12  # samples
MOST_ERROR = 2.0  # of the squared spread, which a run that has left the data counts as


def near_runs(problem: Problem, scale: GapScale) -> CrossValidated:
    """Fit the simulation as read to runs that are halved until it stays near the data.

    Of runs on which it never does, the longest are taken that halving makes hardly better.
    """
    period = min(problem.rhythm.period, problem.rhythm.duration / 2) * problem.rhythm.rate
    samples, tried = problem.longest, []
    while True:
        shooting = problem.learned_runs(samples)
        now = cross_validated(scale, shooting, problem.search.base, (), _as_read(problem, scale, shooting))
        tried.append((scale.relative(now.model.fit), now))
        if tried[-1][0] < NEAR or samples / 2 < max(FEWEST, HALF_PERIOD * period):
            break
        samples //= 2
    least = min(error for error, _ in tried)
    return next(now for error, now in tried if error * WORTH_HALVING <= least)


def _as_read(problem: Problem, scale: GapScale, shooting: Shooting) -> CandidateModel:
    """Fit from the guessed start states, as if the simulation erred by the whole spread of the channels."""
    enough = CONVERGED * shooting.seen.size
    base, plain = problem.search.base, shooting.with_noise(white_noise(scale.spread))
    return fit_model(plain, base, (), problem.guess.starts(shooting.segments), TURNS, enough)


def on_longer_runs(problem: Problem, scale: GapScale, now: CrossValidated) -> CrossValidated | None:
    """Fit what was found to runs ever twice as long, while it stays near the data; None if none is longer."""
    longest, guess, found = problem.longest, problem.guess, None
    samples = now.shooting.segments.span
    while samples < longest:
        before, samples = found or now, min(2 * samples, longest)
        guess = guess.with_run(before.shooting.segments, before.model.fit.states)
        shooting = replace(problem.learned_runs(samples), past=guess.states)
        shooting = shooting.with_noise(scale.error_of(before.model.fit))
        starts = guess.starts(shooting.segments)
        begun = fit_model(shooting, problem.search.base, before.model.parts, starts, TURNS, like=before.model)
        longer = cross_validated(scale, shooting, problem.search.base, begun.parts, begun)
        if not scale.relative(longer.model.fit) < NEAR:
            break
        found = longer
    return found


def as_read_on(problem: Problem, scale: GapScale, as_read: CrossValidated, longer: CrossValidated) -> CrossValidated:
    """Run the simulation as read over the runs of what was found; an error beyond the spread counts as the spread.

    as_read, longer: the simulation as read on shorter runs, and what was found on longer ones
    """
    shooting = longer.shooting.with_noise(scale.error_of(as_read.model.fit))
    starts = longer.model.fit.starts
    model = fit_model(shooting, problem.search.base, (), starts, TURNS, like=as_read.model)
    most = MOST_ERROR * (scale.spread / scale.size) ** 2
    square = np.fmin((model.fit.residual / scale.size) ** 2, most)  # the greater where a run has failed
    mean = float(square[shooting.known].mean())
    return CrossValidated(model, shooting, np.full(len(longer.errors), mean), scale.gap_above(mean))
