"""Forward selection with exchange: explanations are added while the information criterion falls, exchanged, eliminated.

Source: Efroymson 1960, in Ralston and Wilf, Mathematical Methods for Digital Computers, 191 (stepwise selection);
Miller 2002, Subset Selection in Regression (replacement of one at a time).
"""

from dataclasses import dataclass, field

from gaitdisc.discovery.criteria import CRITERIA
from gaitdisc.discovery.effect_words import named_at
from gaitdisc.discovery.gap_share import GapScale
from gaitdisc.discovery.kept_work import note_found
from gaitdisc.discovery.scored_model import Explanations, ScoredModel, compared, leaves, ranked
from gaitdisc.discovery.search import Search, is_certain

MOST_TURNS = 5  # explanations added, those that were eliminated again included
FIRST_PLACES = 5  # that a second explanation is sought beside
SAME = 0.1  # difference of the criterion
FAR = 4.0  # times the variance of the sensors' noise
SETTLED = 3  # turns of exchange and elimination


def select_forward(
    search: Search, begun: ScoredModel, most: int, scale: GapScale | None = None
) -> tuple[ScoredModel, list[ScoredModel]]:
    """Add explanations while the information criterion falls by enough: step 3 of docs/discover.md.

    scale: what is left is measured against; without it the criterion alone decides
    returns rivals: what else stood for the first place, best first
    """
    selection = Selection(search, scale, begun, {begun.explanations}, from_nothing=not begun.parts)
    for turn in range(MOST_TURNS):
        if len(selection.model.parts) >= most or selection.is_far:
            break
        search.progress(f"selection of effects, round {turn + 1} of at most {MOST_TURNS}")
        if not selection.add_one():
            break
    return selection.model, selection.rivals


@dataclass
class Selection:
    """A forward selection on its way, and the conditions under which it goes on."""

    search: Search
    scale: GapScale | None
    model: ScoredModel  # with what is selected so far
    explored: set[Explanations]  # beside which another was sought
    from_nothing: bool
    rivals: list[ScoredModel] = field(default_factory=list)  # for the first place, best first
    explained: float = 0.0  # greatest fall of the criterion by one explanation
    is_far: bool = False  # whether two explanations leave far more than noise: no set of names is exact then

    def add_one(self) -> bool:
        """Add the best explanation and exchange the others, if that meets the conditions."""
        before, *longer = self.search.extended(self.model) or [self.model]
        longer = ranked(longer, self.search.candidates)
        self.rivals = self.rivals or longer
        if not longer or before.bic - longer[0].bic < self.promise:
            return False
        best = longer[0]
        if len(best.parts) > 1:
            before, best = compared([before, self.refine(best)])
        gained = before.bic - best.bic
        if gained < self.worth or not is_certain(best) or (self.enough and 0 < len(self.model.parts) < len(best.parts)):
            return False
        self.explained, self.model = max(self.explained, gained), best
        self.explored.add(best.explanations)
        note_found(" and ".join(named_at(part.candidate) for part in best.parts))
        return True

    @property
    def worth(self) -> float:
        """By how much the criterion must fall for one more: strong evidence, and a share of what was explained."""
        return max(CRITERIA.margin, CRITERIA.material * self.explained)

    @property
    def promise(self) -> float:
        """By how much it must fall before the others are exchanged; two together may explain what neither does."""
        return CRITERIA.margin if len(self.model.parts) == 1 else self.worth

    @property
    def enough(self) -> bool:
        """Whether what is selected leaves less than a simulation may err by: another may only stand in its place."""
        return self.scale is not None and self.scale.excess(self.model.fit) < CRITERIA.model_error

    def refine(self, pair: ScoredModel) -> ScoredModel:
        """Exchange what two or more explanations are, unless these leave far more than the sensors' noise."""
        if len(pair.parts) == 2 and self.from_nothing and not self.enough:
            firsts = [rival for rival in self.rivals if rival is not self.model]
            pair = beside_others(self.search, pair, firsts, self.explored)
        self.is_far = self.scale is not None and leaves(pair, self.scale.noise) > FAR
        return pair if self.is_far else settle(self.search, pair, self.worth, self.explored)


def beside_others(
    search: Search, pair: ScoredModel, firsts: list[ScoredModel], explored: set[Explanations]
) -> ScoredModel:
    """Return the best pair of explanations, also of those whose first was not the best alone.

    Two effects together may look most like a third one, which then stands in the way of both.

    explored: beside which another was sought; those of this search are added
    """
    pairs = [pair]
    # the same model may stand under two names: a wrong damping, and damping that is missing
    unlike = [
        first
        for number, first in enumerate(firsts)
        if not any(first.size == other.size and abs(first.bic - other.bic) < SAME for other in firsts[:number])
    ]
    for first in unlike[: FIRST_PLACES - 1]:
        pairs += ranked(search.extended(first)[1:], search.candidates)[:1]
        explored.add(first.explanations)
    return ranked(compared(pairs), search.candidates)[0]


def settle(search: Search, model: ScoredModel, worth: float, explored: set[Explanations]) -> ScoredModel:
    """Exchange and eliminate explanations, by what one has to be worth, until nothing changes."""
    for _ in range(SETTLED):
        before = model
        model = prune(search, exchange(search, model, explored), worth)
        if sorted(model.labels) == sorted(before.labels):
            break
    return model


def exchange(search: Search, model: ScoredModel, explored: set[Explanations]) -> ScoredModel:
    """Return the model after each explanation was tried against all others in its place."""
    for number in range(len(model.parts)):
        fewer = search.without(model, number)
        if fewer.explanations in explored:
            continue
        explored.add(fewer.explanations)
        rivals = search.extended(fewer)[1:]
        if rivals:
            model, *rivals = compared([model, *rivals])
            best = ranked(rivals, search.candidates)[0]
            if best.bic < model.bic - SAME:
                model = best
    return model


def prune(search: Search, model: ScoredModel, worth: float, fewest: int = 1) -> ScoredModel:
    """Return the model without the explanations that are missed least, by less than a worth, while it has others."""
    while len(model.parts) > fewest:
        fewer = [search.without(model, number) for number in range(len(model.parts))]
        best = min(fewer, key=lambda fit: fit.bic)
        if best.bic > model.bic + worth:
            break
        model = best
    return model
