"""Forward selection with exchange: explanations are added while the information criterion falls, exchanged, eliminated.

Source: Efroymson 1960, in Ralston and Wilf, Mathematical Methods for Digital Computers, 191 (stepwise selection);
Miller 2002, Subset Selection in Regression (replacement of one at a time).
"""

from __future__ import annotations

from gaitdisc.discovery.candidate_model import Explanations
from gaitdisc.discovery.criteria import CRITERIA
from gaitdisc.discovery.effect_words import named_at
from gaitdisc.discovery.gap_share import GapScale
from gaitdisc.discovery.kept_work import note_found
from gaitdisc.discovery.scored_model import ScoredModel, compared, leaves, ranked
from gaitdisc.discovery.search import Search, is_certain

MOST_TURNS = 5  # explanations added, those that were eliminated again included
FIRST_PLACES = 5  # that a second explanation is sought beside
SAME = 0.1  # difference of the criterion
FAR = 4.0  # times the variance of the sensors' noise
SETTLED = 3  # turns of exchange and elimination


def select_forward(
    search: Search, now: ScoredModel, most: int, scale: GapScale | None = None
) -> tuple[ScoredModel, list[ScoredModel]]:
    """Add explanations while the information criterion falls by enough.

    scale: what is left is measured against: two explanations that leave far more than the sensors' noise are not
        refined, for no set of names is exact then; beside one that leaves less than a simulation's own error above that
        noise, no other stays, but another may stand in its place
    returns rivals: what else stood for the first place, best first
    """
    rivals: list[ScoredModel] = []
    explored = {now.model.explanations}
    explained, alone = 0.0, not now.model.parts
    for turn in range(MOST_TURNS):
        number = len(now.model.parts) + 1
        if number > most:
            break
        search.progress(f"round {turn + 1} of at most {MOST_TURNS}")
        before, *more = search.extended(now) or [now]
        more = ranked(more, search.candidates)
        rivals = rivals or more
        worth = max(CRITERIA.margin, CRITERIA.material * explained)
        least = CRITERIA.margin if number == 2 else worth  # two together may explain what neither does
        if not more or before.bic - more[0].bic < least:
            break
        better = more[0]
        if number == 2 and alone:
            better = beside_others(search, better, [one for one in rivals if one is not now], explored)
        far = scale is not None and number > 1 and leaves(better, scale.noise) > FAR
        if number > 1:
            better = better if far else settle(search, better, worth, explored)
            before, better = compared([before, better])
        enough = scale is not None and scale.excess(now.model.fit) < CRITERIA.model_error
        gained = before.bic - better.bic
        if gained < worth or not is_certain(better.model) or (enough and 1 < number == len(better.model.parts)):
            break
        explained, now = max(explained, gained), better
        explored.add(now.model.explanations)
        note_found(" and ".join(named_at(part.candidate) for part in now.model.parts))
        if far:
            break
    return now, rivals


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
        one
        for number, one in enumerate(firsts)
        if not any(one.model.size == other.model.size and abs(one.bic - other.bic) < SAME for other in firsts[:number])
    ]
    for first in unlike[: FIRST_PLACES - 1]:
        pairs += ranked(search.extended(first)[1:], search.candidates)[:1]
        explored.add(first.model.explanations)
    return ranked(compared(pairs), search.candidates)[0]


def settle(search: Search, now: ScoredModel, worth: float, explored: set[Explanations]) -> ScoredModel:
    """Exchange and eliminate explanations until nothing changes.

    worth: by which the criterion must get worse for one to stay
    """
    for _ in range(SETTLED):
        before = now
        now = prune(search, exchange(search, now, explored), worth)
        if sorted(now.labels) == sorted(before.labels):
            break
    return now


def exchange(search: Search, now: ScoredModel, explored: set[Explanations]) -> ScoredModel:
    """Return the model after each explanation was tried against all others in its place."""
    for number in range(len(now.model.parts)):
        rest = search.without(now, number)
        if rest.model.explanations in explored:
            continue
        explored.add(rest.model.explanations)
        others = search.extended(rest)[1:]
        if others:
            now, *others = compared([now, *others])
            best = ranked(others, search.candidates)[0]
            if best.bic < now.bic - SAME:
                now = best
    return now


def prune(search: Search, now: ScoredModel, worth: float, fewest: int = 1) -> ScoredModel:
    """Return the model without the explanations that are missed least, by less than a worth, while it has others."""
    while len(now.model.parts) > fewest:
        fewer = [search.without(now, number) for number in range(len(now.model.parts))]
        best = min(fewer, key=lambda one: one.bic)
        if best.bic > now.bic + worth:
            break
        now = best
    return now
