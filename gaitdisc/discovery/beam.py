"""A beam search over sets of explanations, by the share of the gap that each closes and the penalty for its complexity.

Forward selection with exchange, several sets side by side.
Source: Miller 2002, Subset Selection in Regression (forward selection with replacement).
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np

from gaitdisc.discovery.candidate import Identity
from gaitdisc.discovery.candidate_model import Explanations, Part
from gaitdisc.discovery.criteria import CRITERIA
from gaitdisc.discovery.gap_share import CrossValidated, GapScale, cross_validated
from gaitdisc.discovery.paired_test import errors_rise_p
from gaitdisc.discovery.penalty import penalty_of
from gaitdisc.discovery.score import Score
from gaitdisc.discovery.search import Search
from gaitdisc.results.discovery import ALPHA

WIDTH = 5  # sets that are extended side by side
MOST = 4  # explanations
FIRST, NEXT = 12, 6  # that are fitted beside nothing, and beside each set
EXCHANGES = 2


@dataclass(frozen=True, eq=False)
class Beam:
    """Sets of explanations that were fitted to the same runs."""

    search: Search
    scale: GapScale
    as_read: CrossValidated  # the simulation as read, on these runs
    known: dict[Explanations, CrossValidated] = field(default_factory=dict)  # every set that was fitted so far

    def cost(self, now: CrossValidated) -> float:
        """Return what is left of the gap plus the penalty of what closes the rest, in shares of the gap as read."""
        return now.gap / self.as_read.gap + now.model.penalty

    @property
    def best(self) -> CrossValidated:
        """The set of least cost."""
        return min(self.known.values(), key=self.cost)

    def fit(self, sets: Iterable[tuple[Part, ...]]) -> list[CrossValidated]:
        """Fit sets, so that they are weighed as well."""
        fitted = [
            cross_validated(self.scale, self.as_read.shooting, self.search.base, parts, self.as_read.model)
            for parts in sets
        ]
        fitted = [one for one in fitted if self.search.sensible(one.model)]
        self.known.update((one.model.explanations, one) for one in fitted)
        return fitted

    def select_forward(self, begin: CrossValidated) -> CrossValidated:
        """Return the best set found by adding explanations to one, or to a far-off number, and exchanging them."""
        self.known.setdefault(self.as_read.model.explanations, self.as_read)
        far = self.fit(one.parts for one in self.search.far_off(self.as_read.scored))
        self.known[begin.model.explanations] = begin
        if begin is not self.as_read:
            for one in far:
                self._extended([one])
        most = min(MOST, max(1, len(begin.errors) // 3))
        beam = [begin]
        for _ in range(len(begin.model.explanations), most):
            longer = self._extended(beam)
            if not longer:
                break
            least = min(one.gap for one in beam)
            beam = sorted(longer, key=self.cost)[:WIDTH]
            if least - beam[0].gap <= 0.5 * CRITERIA.matters * self.as_read.gap:
                break
        for _ in range(EXCHANGES):
            best = self.best
            self._exchange(best)
            if self.best is best:
                break
        return self.best

    def _extended(self, beam: list[CrossValidated]) -> list[CrossValidated]:
        """Fit the most promising sets of one explanation more; those that are known already stand beside them."""
        size = len(beam[0].model.explanations) + 1
        found = {key: one for key, one in self.known.items() if len(key) == size and np.isfinite(one.gap)}
        for now in beam:
            for score in self._promising(now, FIRST if len(beam) == 1 else NEXT):
                longer = self._with(now, score)
                if longer:
                    found[longer.model.explanations] = longer
        return list(found.values())

    def _promising(self, now: CrossValidated, most: int) -> list[Score]:
        """Explanations that could, to first order, make a set cheaper than the cheapest known."""
        fit, model = now.model.fit, now.model
        if not np.isfinite(now.gap):
            return []
        scores = self.search.scorer(now.shooting, model).scores(self.search.open_beside(model))
        whole = float((fit.projected[0] ** 2).sum())
        wanted = self.cost(self.best) + CRITERIA.plain
        promising = []
        for score in scores:
            left = math.sqrt(max(1 - score.gain / whole, 0.0))
            promised = now.gap / self.as_read.gap * left + model.penalty + penalty_of(score.candidate, score.values)
            if promised < wanted:
                promising.append(score)
        return promising[:most]

    def _with(self, now: CrossValidated, score: Score) -> CrossValidated | None:
        """Fit a set with one explanation more; None where its numbers would not mean what its name says."""
        wanted = now.model.explanations | {score.candidate.identity}
        if wanted not in self.known:
            parts = (*now.model.parts, Part(score.candidate, score.values))
            longer = cross_validated(self.scale, now.shooting, self.search.base, parts, now.model)
            if not self.search.sensible(longer.model):
                return None
            self.known[wanted] = longer
        return self.known[wanted]

    def without(self, now: CrossValidated, gone: Identity) -> CrossValidated:
        """Fit a set less one of its explanations."""
        wanted = now.model.explanations - {gone}
        if wanted not in self.known:
            parts = tuple(part for part in now.model.parts if part.candidate.identity != gone)
            self.known[wanted] = cross_validated(self.scale, now.shooting, self.search.base, parts, now.model)
        return self.known[wanted]

    def _exchange(self, best: CrossValidated) -> None:
        """Fit the sets with another explanation in the place of each of a set's own."""
        if len(best.model.explanations) < 2:
            return
        for gone in sorted(best.model.explanations):
            fewer = self.without(best, gone)
            for score in self._promising(fewer, NEXT):
                self._with(fewer, score)

    def material(self, now: CrossValidated) -> tuple[CrossValidated, list[Part]]:
        """Return a set less what closes too little of the gap, or not beyond chance; and what went, the last first."""
        small: list[Part] = []
        while now.model.explanations:
            losses = []
            for part in now.model.parts:
                fewer = self.without(now, part.candidate.identity)
                share = (fewer.gap - now.gap) / self.as_read.gap
                worth = max(CRITERIA.matters, penalty_of(part.candidate, part.values))
                if share < worth or errs_more(fewer, now) >= ALPHA:
                    losses.append((share, part, fewer))
            if not losses:
                break
            _, part, now = min(losses, key=lambda one: one[0])
            small.insert(0, part)
        return now, small

    def plainest(self, now: CrossValidated) -> CrossValidated:
        """Return the cheapest set that left-out pieces do not distinguish from a set."""
        equal = [
            one
            for one in self.known.values()
            if 0 < len(one.model.explanations) <= len(now.model.explanations)
            and one.model.penalty < now.model.penalty - 1e-9
            and one.gap < self.as_read.gap
            and errs_more(one, now) >= ALPHA
        ]
        return min(equal, key=lambda one: (round(one.model.penalty, 3), one.gap)) if equal else now

    def near(self, now: CrossValidated, within: float) -> list[CrossValidated]:
        """Return other sets that cost hardly more, the cheapest first.

        within: how much more, in shares of the gap as read
        """
        others = [
            one
            for one in self.known.values()
            if one.model.explanations and one.model.explanations != now.model.explanations
        ]
        return sorted((one for one in others if self.cost(one) <= self.cost(now) + within), key=self.cost)


def errs_more(one: CrossValidated, other: CrossValidated) -> float:
    """Chance of so much greater left-out errors of one set if it were no worse than another (Wilcoxon, one-sided)."""
    if not np.isfinite(one.errors).all() or len(one.errors) != len(other.errors):
        return 0.0
    return errors_rise_p(np.sqrt(other.errors), np.sqrt(one.errors))
