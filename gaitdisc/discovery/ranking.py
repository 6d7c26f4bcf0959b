"""Ranking: which of several explanations that fit about as well is put first.

Source: Foster and George 1994, Ann. Stat. 22, 1947 (2 log p for each of p that was selected, the risk inflation
criterion).
"""

from __future__ import annotations

from collections import Counter
from functools import partial

import numpy as np

from gaitdisc.discovery.candidate import Candidate
from gaitdisc.discovery.catalogue import known_shapes
from gaitdisc.discovery.criteria import CRITERIA
from gaitdisc.discovery.scored_model import ScoredModel

# Where two explanations fit equally well, the simpler statement first.
PREFERENCE = ("wrong_parameter", "input_error", "sensor_error", "missing_physics")


def ranked(models: list[ScoredModel], candidates: tuple[Candidate, ...]) -> list[ScoredModel]:
    """Return models, the best first.

    A kind of explanation with many members (a missing term: any shape at any place) is more likely to have one that
    fits by chance than a kind with few (a wrong parameter): each kind is penalised for the number of its
    members. Of what the criterion does not distinguish the simplest statement stands first.
    """
    models = [one for one in models if np.isfinite(one.bic)]
    if not models:
        return models
    members = Counter(verdict for verdict, _ in {(one.verdict, one.label) for one in candidates})
    penalised = partial(_penalised, members=members)
    models.sort(key=penalised)
    least = min(models, key=lambda one: one.bic)
    fewer = [one for one in models if one.model.size < least.model.size]
    simple = [one for one in fewer if one.bic < least.bic + CRITERIA.margin]
    first = simple[0] if simple else models[0]
    order = {shape.name: number for number, shape in reversed(list(enumerate(known_shapes())))}

    def complexity(one: ScoredModel) -> tuple[list[int], float, list[int]]:
        names = [order.get(part.candidate.name, len(order)) for part in one.model.parts]
        return [PREFERENCE.index(verdict) for verdict in one.verdicts], round(one.model.penalty, 6), names

    tied = [one for one in models if one.model.size == first.model.size]
    first = min((one for one in tied if penalised(one) <= penalised(first) + CRITERIA.tie), key=complexity)
    return [first, *(one for one in models if one is not first)]


def _penalised(one: ScoredModel, members: Counter[str]) -> float:
    """Criterion plus twice the logarithm of how many each explanation was picked from."""
    return one.bic + sum(2 * float(np.log(max(members[verdict], 1))) for verdict in one.verdicts)
