"""Effects that a person gives: exactly these are fitted, and held-out data prove or refute them without a search."""

from __future__ import annotations

from difflib import get_close_matches

import numpy as np

from gaitdisc.discovery.candidate_model import Part, fit_model
from gaitdisc.discovery.decision import Verdict, held_out_proof
from gaitdisc.discovery.problem import Problem
from gaitdisc.discovery.scored_model import ScoredModel, scored
from gaitdisc.discovery.search import TURNS, Search, is_certain
from gaitdisc.errors import SchemaError

FORM = "an effect that is to be fitted is written as effect@place, both of them known"
NEAREST = 5


def refuse_unknown(search: Search, effects: tuple[str, ...]) -> None:
    """Refuse an effect or a place that does not exist, with the nearest."""
    known = {one.label for one in search.candidates}
    for given in effects:
        if given not in known:
            near = get_close_matches(given, sorted(known), NEAREST, 0.0)
            raise SchemaError(FORM, f"found {given!r}; nearest are {', '.join(near)}", "Give one of these.")


def fit_given(problem: Problem, as_read: ScoredModel, effects: tuple[str, ...]) -> Verdict:
    """Fit a simulation with exactly these effects in it, each `name@place`, and test it on what is held out."""
    search, now = problem.search, as_read
    for given in effects:
        castings = tuple(one for one in search.open_beside(now.model) if one.label == given)
        begun = search.scorer(now.shooting, now.model).scores(castings)
        tried = [
            fit_model(
                now.shooting,
                search.base,
                (*now.model.parts, Part(one.candidate, one.values)),
                now.model.fit.starts,
                TURNS,
                like=now.model,
            )
            for one in begun
        ]
        tried = [one for one in tried if np.isfinite(one.fit.misfit)]
        if not tried:
            raise SchemaError(
                "an effect that is to be fitted changes what is measured, and is given once",
                f"with {given!r} once more the simulation leaves all bounds, or runs as without it",
                "Give another effect or place.",
            )
        now = scored(now.shooting, search.base, min(tried, key=lambda one: one.fit.misfit))
    now = problem.lengthened(now)
    count = len(now.model.parts)
    idle = [
        not is_certain(now.model, number, number + 1)
        or (count > 1 and not held_out_proof(problem, search.without(now, number), now, as_read).bears_out)
        for number in range(count)
    ]
    proof = held_out_proof(problem, as_read, now)
    return Verdict(now.word, now, (), proof=proof, given=tuple(idle))
