"""Where no explanation leaves mere noise: the plainest set that closes most of the gap, by a beam search over sets.

Sets are weighed by the share of the gap that each closes on runs left out of the fit, and a penalty for its complexity.

Forward selection with exchange, several sets side by side.
Source: Miller 2002, Subset Selection in Regression (forward selection with replacement).
"""

import math
from collections.abc import Iterable
from dataclasses import dataclass, field, replace

import numpy as np

from gaitdisc.discovery.candidate import Identity, list_unnamed_terms
from gaitdisc.discovery.case import Case
from gaitdisc.discovery.criteria import CRITERIA
from gaitdisc.discovery.gap_share import CONVERGED, TURNS, CrossValidated, GapScale, cross_validated, errs_more
from gaitdisc.discovery.noise import white_noise
from gaitdisc.discovery.paired_test import PairedTest
from gaitdisc.discovery.result import ALPHA
from gaitdisc.discovery.score import Score
from gaitdisc.discovery.scored_model import Explanations, Part, ScoredModel, fit_model
from gaitdisc.discovery.search import Search

WIDTH = 5  # sets that are extended side by side
MOST = 4  # explanations
FIRST, NEXT = 12, 6  # that are fitted beside nothing, and beside each set
EXCHANGES = 2
LISTED = 6  # sets beside the answer
TIED = 0.02  # of the gap, by which another set may cost more
WORTH_HALVING = 0.7  # of the error, which shorter runs must leave at most
HALF_PERIOD = 0.5
FEWEST = 12  # samples


@dataclass(frozen=True, eq=False)
class Beam:
    """Sets of explanations that were fitted to the same runs."""

    search: Search
    scale: GapScale
    as_read: CrossValidated  # the simulation as read, on these runs
    known: dict[Explanations, CrossValidated] = field(default_factory=dict)  # every set that was fitted so far

    def cost(self, model: CrossValidated) -> float:
        """Return what is left of the gap plus the penalty of what closes the rest, in shares of the gap as read."""
        return model.gap / self.as_read.gap + model.penalty

    @property
    def best(self) -> CrossValidated:
        """The set of least cost."""
        return min(self.known.values(), key=self.cost)

    def fit(self, sets: Iterable[tuple[Part, ...]], begun: CrossValidated | None = None) -> list[CrossValidated]:
        """Fit sets, so that they are weighed as well, unless their numbers would not mean what their names say."""
        fitted = [cross_validated(self.scale, begun or self.as_read, parts) for parts in sets]
        fitted = [model for model in fitted if self.search.sensible(model)]
        self.known.update((model.explanations, model) for model in fitted)
        return fitted

    def select_forward(self, begin: CrossValidated) -> CrossValidated:
        """Return the best set found by adding explanations to one, or to a far-off number, and exchanging them."""
        self.known.setdefault(self.as_read.explanations, self.as_read)
        far = self.fit(model.parts for model in self.search.far_off(self.as_read))
        self.known[begin.explanations] = begin
        if begin is not self.as_read:
            for model in far:
                self._extend([model])
        most = min(MOST, max(1, len(begin.errors) // 3))
        beam = [begin]
        for _ in range(len(begin.explanations), most):
            longer = self._extend(beam)
            if not longer:
                break
            least = min(model.gap for model in beam)
            beam = sorted(longer, key=self.cost)[:WIDTH]
            if least - beam[0].gap <= 0.5 * CRITERIA.matters * self.as_read.gap:
                break
        for _ in range(EXCHANGES):
            best = self.best
            for gone in sorted(best.explanations) if len(best.explanations) > 1 else ():  # another in the place of each
                fewer = self.without(best, gone)
                for score in self._promising(fewer, NEXT):
                    self._with(fewer, score)
            if self.best is best:
                break
        return self.best

    def _extend(self, beam: list[CrossValidated]) -> list[CrossValidated]:
        """Fit the most promising sets of one explanation more; those that are known already stand beside them."""
        size = len(beam[0].explanations) + 1
        for shorter in beam:
            for score in self._promising(shorter, FIRST if len(beam) == 1 else NEXT):
                self._with(shorter, score)
        return [model for key, model in self.known.items() if len(key) == size and np.isfinite(model.gap)]

    def _promising(self, model: CrossValidated, most: int) -> list[Score]:
        """Explanations that could, to first order, make a set cheaper than the cheapest known."""
        if not np.isfinite(model.gap):
            return []
        scores = self.search.scorer(model).scores(self.search.open_beside(model))
        squares = float((model.fit.projected[0] ** 2).sum())
        limit = self.cost(self.best) + CRITERIA.plain
        promising = []
        for score in scores:
            remaining = math.sqrt(max(1 - score.gain / squares, 0.0))
            promised = model.gap / self.as_read.gap * remaining + model.penalty + score.candidate.penalty(score.values)
            if promised < limit:
                promising.append(score)
        return promising[:most]

    def _with(self, model: CrossValidated, score: Score) -> None:
        """Fit a set with one explanation more, unless it is known."""
        if model.explanations | {score.candidate.identity} not in self.known:
            self.fit([(*model.parts, score)], model)

    def without(self, model: CrossValidated, gone: Identity) -> CrossValidated:
        """Fit a set less one of its explanations."""
        explanations = model.explanations - {gone}
        if explanations not in self.known:
            parts = tuple(part for part in model.parts if part.candidate.identity != gone)
            self.known[explanations] = cross_validated(self.scale, model, parts)
        return self.known[explanations]

    def material(self, model: CrossValidated) -> tuple[CrossValidated, list[Part]]:
        """Return a set less what closes too little of the gap, or not beyond chance; and what went, the last first."""
        small: list[Part] = []
        while model.explanations:
            losses = []
            for part in model.parts:
                fewer = self.without(model, part.candidate.identity)
                share = (fewer.gap - model.gap) / self.as_read.gap
                worth = max(CRITERIA.matters, part.candidate.penalty(part.values))
                if share < worth or errs_more(fewer, model) >= ALPHA:
                    losses.append((share, part, fewer))
            if not losses:
                break
            _, part, model = min(losses, key=lambda loss: loss[0])
            small.insert(0, part)
        return model, small

    def plainest(self, model: CrossValidated) -> CrossValidated:
        """Return the cheapest set that left-out pieces do not distinguish from a set."""
        equal = [
            fit
            for fit in self.known.values()
            if 0 < len(fit.explanations) <= len(model.explanations)
            and fit.penalty < model.penalty - 1e-9
            and fit.gap < self.as_read.gap
            and errs_more(fit, model) >= ALPHA
        ]
        return min(equal, key=lambda fit: (round(fit.penalty, 3), fit.gap)) if equal else model

    def near(self, model: CrossValidated, within: float) -> list[CrossValidated]:
        """Return other sets that cost at most so much more, in shares of the gap as read, the cheapest first."""
        others = [fit for fit in self.known.values() if fit.explanations and fit.explanations != model.explanations]
        return sorted((fit for fit in others if self.cost(fit) <= self.cost(model) + within), key=self.cost)


@dataclass(frozen=True, eq=False)
class Outcome:
    """A set of explanations, and what was weighed beside it."""

    as_read: ScoredModel
    now: ScoredModel  # with the set, on the same runs
    closed: float  # share of the squared gap that goes, on runs left out of the fit
    # of the errors left out of the fit, with and without the set; its p times the number of explanations that were open
    # (Bonferroni), for the same runs chose among these
    test: PairedTest
    small: tuple[Part, ...]  # explanations that close too little to be named, or not beyond chance
    near: tuple[ScoredModel, ...]  # sets that cost hardly more
    others: tuple[ScoredModel, ...]  # the cheapest sets of all, whatever they cost


def closing_most(case: Case, also: tuple[tuple[Part, ...], ...]) -> Outcome | None:
    """Search the plainest set of explanations that closes most of the gap; None where none closes enough.

    First on runs on which the simulation as read stays near the data, then on longer ones, where losses show that are
    small in a short run.
    """
    search, scale = case.search, case.scale
    search = replace(search, candidates=(*search.candidates, *list_unnamed_terms(search.base, search.places)))
    as_read = near_runs(case)
    if scale.agrees(as_read.fit) or not as_read.gap:
        return None
    beam = Beam(search, scale, as_read)
    beam.fit(also)
    best = beam.select_forward(as_read)
    longer = on_longer_runs(case, best) if best.explanations else None
    if longer:
        plainest = beam.plainest(best)  # that shorter runs do not distinguish from the best
        beam = Beam(search, scale, as_read_on(scale, as_read, longer))
        if not beam.as_read.gap:
            return None
        beam.fit((plainest.parts,), longer)
        best = beam.select_forward(longer)
    model, small = beam.material(best)
    model = beam.plainest(model)
    if not model.explanations:
        return None
    near, others = (tuple(beam.near(model, within)) for within in (TIED, np.inf))
    closed = 1 - (model.gap / beam.as_read.gap) ** 2
    p = min(len(search.candidates) * errs_more(beam.as_read, model), 1.0)
    test = PairedTest(p, len(model.errors), float((beam.as_read.errors - model.errors).sum()), case.alpha)
    return Outcome(beam.as_read, model, closed, test, small=tuple(small), near=near, others=others[:LISTED])


def near_runs(case: Case) -> CrossValidated:
    """Fit the simulation as read to runs that are halved until it stays near the data.

    Of runs on which it never does, the longest are taken that halving makes hardly better.
    """
    period = min(case.rhythm.period, case.rhythm.duration / 2) * case.rhythm.rate
    samples, scale, tried = case.longest, case.scale, []
    while True:
        shooting = case.cut_learned_runs(samples)
        plain = shooting.with_noise(white_noise(scale.spread))  # as if it erred by the whole spread of the channels
        enough, starts = CONVERGED * shooting.seen.size, shooting.segments.starts(case.guess)
        begun = fit_model(plain, case.search.base, (), starts, TURNS, enough)
        model = cross_validated(scale, replace(begun, shooting=shooting), ())
        tried.append((scale.relative(model.fit), model))
        if tried[-1][0] < CRITERIA.near or samples / 2 < max(FEWEST, HALF_PERIOD * period):
            break
        samples //= 2
    least = min(error for error, _ in tried)
    return next(model for error, model in tried if error * WORTH_HALVING <= least)


def on_longer_runs(case: Case, model: CrossValidated) -> CrossValidated | None:
    """Fit what was found to runs ever twice as long, while it stays near the data; None if none is longer."""
    longest, guess, scale, extended = case.longest, case.guess, case.scale, None
    samples = model.shooting.segments.span
    while samples < longest:
        before, samples = extended or model, min(2 * samples, longest)
        guess = before.shooting.segments.put(guess, before.fit.states)
        shooting = replace(case.cut_learned_runs(samples), past=guess)
        shooting = shooting.with_noise(scale.white_error(before.fit))
        starts = shooting.segments.starts(guess)
        begun = before.refitted(shooting, starts=starts, turns=TURNS)
        longer = cross_validated(scale, begun, begun.parts)
        if not scale.relative(longer.fit) < CRITERIA.near:
            break
        extended = longer
    return extended


def as_read_on(scale: GapScale, as_read: CrossValidated, longer: CrossValidated) -> CrossValidated:
    """Run the simulation as read over the runs of what was found; an error beyond the spread counts as the spread."""
    shooting = longer.shooting.with_noise(scale.white_error(as_read.fit))
    model = as_read.refitted(shooting, starts=longer.fit.starts, turns=TURNS)
    most = CRITERIA.lost * (scale.spread / scale.size) ** 2
    square = np.fmin((model.fit.residual / scale.size) ** 2, most)  # the greater where a run has failed
    mean = float(square[shooting.known].mean())
    errors = np.full(len(longer.errors), mean)
    return CrossValidated(**vars(model), errors=errors, gap=scale.gap_above(mean))
