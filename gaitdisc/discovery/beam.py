"""A beam search over sets of explanations, by the share of the gap that each closes and the price of its statement."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from gaitdisc.discovery.account import Explanations, Part
from gaitdisc.discovery.borne_out import LEVEL, signed_rank_p, speaking
from gaitdisc.discovery.candidate import Identity
from gaitdisc.discovery.gap_share import GapScale, Weighed, weighed
from gaitdisc.discovery.price import price_of
from gaitdisc.discovery.score import Score
from gaitdisc.discovery.search import Search

WIDTH = 5  # sets that are extended side by side
MOST = 4  # explanations
FIRST, NEXT = 12, 6  # that are fitted beside nothing, and beside each set
LEAST_FALL = 0.02  # of the misfit, to first order
SLACK = 0.03  # of the gap: by how much a first-order promise may be beaten by the fit
MATTERS = 0.05  # of the gap: what an explanation must close to be named
ABOVE_PRICE = 1.5  # times its price
STOPS = 0.03  # of the gap: a step that costs so much more than it closes is the last
EXCHANGES = 2
DONE = 1.1  # times what a simulation that lacks nothing may leave
AS_MUCH = 0.8  # of what the best closes, a simpler set must close to stand in its place


@dataclass(frozen=True, eq=False)
class Beam:
    """Sets of explanations that were fitted to the same runs."""

    search: Search
    scale: GapScale
    as_read: Weighed  # the simulation as read, on these runs
    known: dict[Explanations, Weighed] = field(default_factory=dict)  # every set that was fitted so far

    def cost(self, now: Weighed) -> float:
        """Return what is left of the gap plus the price of what closes the rest, in shares of the gap as read."""
        return now.gap / self.as_read.gap + now.account.price

    @property
    def best(self) -> Weighed:
        """The set of least cost."""
        return min(self.known.values(), key=self.cost)

    def grown(self, begin: Weighed) -> Weighed:
        """Return the best set that is found from one by letting explanations in and exchanging them."""
        self.known.setdefault(self.as_read.account.explanations, self.as_read)
        self.known[begin.account.explanations] = begin
        most = min(MOST, max(1, len(begin.errors) // 3))
        beam = [begin]
        for _ in range(len(begin.account.explanations), most):
            longer = self._extended(beam)
            if not longer:
                break
            least, cheapest = min(one.gap for one in beam), min(map(self.cost, beam))
            beam = sorted(longer, key=self.cost)[:WIDTH]
            closes = least - beam[0].gap > 0.5 * MATTERS * self.as_read.gap
            if not closes or self.cost(beam[0]) > cheapest + STOPS:
                break
            if self.scale.mean_square(beam[0].account.fit) < DONE * self.scale.least:
                break
        for _ in range(EXCHANGES):
            best = self.best
            self._exchange(best)
            if self.best is best:
                break
        return self.best

    def _extended(self, beam: list[Weighed]) -> list[Weighed]:
        """Fit the most promising sets of one explanation more."""
        found: dict[Explanations, Weighed] = {}
        for now in beam:
            for score in self._promising(now, FIRST if len(beam) == 1 else NEXT):
                longer = self._with(now, score)
                if longer:
                    found[longer.account.explanations] = longer
        return list(found.values())

    def _promising(self, now: Weighed, most: int) -> list[Score]:
        """Explanations that could, to first order, make a set cheaper than the cheapest known."""
        fit, account = now.account.fit, now.account
        if not np.isfinite(now.gap):
            return []
        scores = self.search.scorer(now.shooting, account).scores(self.search.open_beside(account))
        whole = float((fit.projected[0] ** 2).sum())
        wanted = self.cost(self.best) + SLACK
        promising = []
        for score in scores:
            left = math.sqrt(max(1 - score.gain / whole, 0.0))
            promised = now.gap / self.as_read.gap * left + account.price + price_of(score.candidate, score.values)
            if score.gain > LEAST_FALL * whole and promised < wanted:
                promising.append(score)
        return promising[:most]

    def _with(self, now: Weighed, score: Score) -> Weighed | None:
        """Fit a set with one explanation more; None where its numbers would not mean what its name says."""
        wanted = now.account.explanations | {score.candidate.identity}
        if wanted not in self.known:
            parts = (*now.account.parts, Part(score.candidate, score.values))
            longer = weighed(self.scale, now.shooting, self.search.base, parts, now.account)
            if not self.search.sensible(longer.account):
                return None
            self.known[wanted] = longer
        return self.known[wanted]

    def without(self, now: Weighed, gone: Identity) -> Weighed:
        """Fit a set less one of its explanations."""
        wanted = now.account.explanations - {gone}
        if wanted not in self.known:
            parts = tuple(part for part in now.account.parts if part.candidate.identity != gone)
            self.known[wanted] = weighed(self.scale, now.shooting, self.search.base, parts, now.account)
        return self.known[wanted]

    def _exchange(self, best: Weighed) -> None:
        """Fit the sets with another explanation in the place of each of a set's own."""
        if len(best.account.explanations) < 2:
            return
        for gone in sorted(best.account.explanations):
            fewer = self.without(best, gone)
            for score in self._promising(fewer, NEXT):
                self._with(fewer, score)

    def material(self, now: Weighed) -> tuple[Weighed, list[Part]]:
        """Return a set less what closes too little of the gap, or not beyond chance; and what went, the last first."""
        small: list[Part] = []
        while now.account.explanations:
            losses = []
            for part in now.account.parts:
                fewer = self.without(now, part.candidate.identity)
                share = (fewer.gap - now.gap) / self.as_read.gap
                worth = max(MATTERS, ABOVE_PRICE * price_of(part.candidate, part.values))
                if share < worth or errs_more(fewer, now) >= LEVEL:
                    losses.append((share, part, fewer))
            if not losses:
                break
            _, part, now = min(losses, key=lambda one: one[0])
            small.insert(0, part)
        return now, small

    def plainest(self, now: Weighed) -> Weighed:
        """Return the cheapest set that closes nearly as much and that left-out pieces do not distinguish from a set."""
        closed = self.as_read.gap - now.gap
        equal = [
            one
            for one in self.known.values()
            if 0 < len(one.account.explanations) <= len(now.account.explanations)
            and one.account.price < now.account.price - 1e-9
            and self.as_read.gap - one.gap > AS_MUCH * closed
            and errs_more(one, now) >= LEVEL
        ]
        return min(equal, key=lambda one: (round(one.account.price, 3), one.gap)) if equal else now

    def near(self, now: Weighed, within: float) -> list[Weighed]:
        """Return other sets that cost hardly more, the cheapest first.

        within: how much more, in shares of the gap as read
        """
        others = [
            one
            for one in self.known.values()
            if one.account.explanations and one.account.explanations != now.account.explanations
        ]
        return sorted((one for one in others if self.cost(one) <= self.cost(now) + within), key=self.cost)


def errs_more(one: Weighed, other: Weighed) -> float:
    """Chance of so much greater left-out errors of one set if it were no worse than another (Wilcoxon, one-sided)."""
    if not np.isfinite(one.errors).all() or len(one.errors) != len(other.errors):
        return 0.0
    return signed_rank_p(speaking(np.sqrt(one.errors) - np.sqrt(other.errors)))
