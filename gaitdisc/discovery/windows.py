"""How long the runs are on which explanations are weighed: as long as the simulation as read stays near the data."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from gaitdisc.discovery.account import Account, account_for
from gaitdisc.discovery.gap_share import CONVERGED, TURNS, GapScale, Weighed, weighed
from gaitdisc.discovery.inquiry import Inquiry
from gaitdisc.discovery.noise import white_noise
from gaitdisc.discovery.shooting import Shooting

NEAR = 0.25  # of a channel's spread
WORTH_HALVING = 0.7  # of the error, which shorter runs must leave at most
HALF_PERIOD = 0.5
FEWEST = 12  # samples
MOST_ERROR = 2.0  # of the squared spread, which a run that has left the data counts as


def near_runs(inquiry: Inquiry, scale: GapScale) -> Weighed:
    """Fit the simulation as read to runs that are halved until it stays near the data.

    Of runs on which it never does, the longest are taken that halving makes hardly better.
    """
    period = min(inquiry.rhythm.period, inquiry.rhythm.duration / 2) * inquiry.rhythm.rate
    samples, tried = inquiry.longest, []
    while True:
        shooting = inquiry.learned_runs(samples)
        now = weighed(scale, shooting, inquiry.search.base, (), _as_read(inquiry, scale, shooting))
        tried.append((scale.relative(now.account.fit), now))
        if tried[-1][0] < NEAR or samples / 2 < max(FEWEST, HALF_PERIOD * period):
            break
        samples //= 2
    least = min(error for error, _ in tried)
    return next(now for error, now in tried if error * WORTH_HALVING <= least)


def _as_read(inquiry: Inquiry, scale: GapScale, shooting: Shooting) -> Account:
    """Fit from the guessed start states, as if the simulation erred by the whole spread of the channels."""
    enough = CONVERGED * shooting.seen.size
    base, plain = inquiry.search.base, shooting.with_noise(white_noise(scale.spread))
    return account_for(plain, base, (), inquiry.guess.starts(shooting.segments), TURNS, enough)


def on_longer_runs(inquiry: Inquiry, scale: GapScale, now: Weighed) -> Weighed | None:
    """Fit what was found to runs ever twice as long, while it stays near the data; None if none is longer."""
    longest, guess, found = inquiry.longest, inquiry.guess, None
    samples = now.shooting.segments.span
    while samples < longest:
        before, samples = found or now, min(2 * samples, longest)
        guess = guess.with_run(before.shooting.segments, before.account.fit.states)
        shooting = replace(inquiry.learned_runs(samples), past=guess.states)
        shooting = shooting.with_noise(scale.error_of(before.account.fit))
        starts = guess.starts(shooting.segments)
        begun = account_for(shooting, inquiry.search.base, before.account.parts, starts, TURNS, like=before.account)
        longer = weighed(scale, shooting, inquiry.search.base, begun.parts, begun)
        if not scale.relative(longer.account.fit) < NEAR:
            break
        found = longer
    return found


def as_read_on(inquiry: Inquiry, scale: GapScale, as_read: Weighed, longer: Weighed) -> Weighed:
    """Run the simulation as read over the runs of what was found; an error beyond the spread counts as the spread.

    as_read, longer: the simulation as read on shorter runs, and what was found on longer ones
    """
    shooting = longer.shooting.with_noise(scale.error_of(as_read.account.fit))
    starts = longer.account.fit.starts
    account = account_for(shooting, inquiry.search.base, (), starts, TURNS, like=as_read.account)
    most = MOST_ERROR * (scale.spread / scale.size) ** 2
    square = np.fmin((account.fit.residual / scale.size) ** 2, most)  # the greater where a run has failed
    mean = float(square[shooting.known].mean())
    return Weighed(account, shooting, np.full(len(longer.errors), mean), scale.gap_above(mean))
