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
from gaitdisc.discovery.scored_model import ScoredModel

MARGIN = 10.0  # by which the criterion must fall for one more explanation
# Where two explanations fit equally well, the simpler statement first.
PREFERENCE = ("wrong_parameter", "input_error", "sensor_error", "missing_physics")
ALIKE = 1.0
TIE = 6.0  # fall of the criterion below which two explanations are distinguished by nothing
PLAINER = 0.02  # of the gap, by which the penalty of one of them must be less for it to stand first
NEARLY = 4.0  # between shapes of one kind: the one that stands first in the catalogue is the simpler


def ranked(models: list[ScoredModel], candidates: tuple[Candidate, ...]) -> list[ScoredModel]:
    """Return models, the best first.

    A kind of explanation with many members (a missing term: any shape at any place) is more likely to have one that
    fits by chance than a kind with few (a wrong parameter): each kind is penalised for the number of its
    members. A simpler statement stands before one that is hardly better.
    """
    models = [one for one in models if np.isfinite(one.bic)]
    if not models:
        return models
    members = Counter(verdict for verdict, _ in {(one.verdict, one.label) for one in candidates})
    penalised = partial(_penalised, members=members)
    models.sort(key=penalised)
    least = min(models, key=lambda one: one.bic)
    fewer = [one for one in models if one.model.size < least.model.size]
    simple = [one for one in fewer if one.bic < least.bic + MARGIN]
    first = simple[0] if simple else models[0]
    equal = [one for one in models if one.model.size == first.model.size]
    alike = [one for one in equal if abs(penalised(one) - penalised(first)) < ALIKE]
    alike.sort(key=lambda one: [PREFERENCE.index(verdict) for verdict in one.verdicts])
    first = alike[0]
    plainer = [
        one
        for one in equal
        if penalised(one) <= penalised(first) + TIE and one.model.penalty < first.model.penalty - PLAINER
    ]
    first = min(plainer, key=penalised) if plainer else first
    near = [one for one in equal if penalised(one) <= penalised(first) + NEARLY and one.verdicts == first.verdicts]
    order = {shape.name: number for number, shape in reversed(list(enumerate(known_shapes())))}
    near.sort(key=lambda one: [order.get(part.candidate.name, len(order)) for part in one.model.parts])
    head = [near[0], *(one for one in alike if one is not near[0])]
    return head + [one for one in models if all(one is not other for other in head)]


def _penalised(one: ScoredModel, members: Counter[str]) -> float:
    """Criterion plus twice the logarithm of how many each explanation was picked from."""
    return one.bic + sum(2 * float(np.log(max(members[verdict], 1))) for verdict in one.verdicts)
