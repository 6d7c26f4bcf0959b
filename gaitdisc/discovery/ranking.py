"""Ranking: which of several explanations of equal standing is put first."""

from __future__ import annotations

from collections import Counter
from functools import partial

import numpy as np

from gaitdisc.discovery.candidate import Candidate
from gaitdisc.discovery.catalogue import known_shapes
from gaitdisc.discovery.evidence import Judged

MARGIN = 10.0  # by which the criterion must fall for one more explanation
# Where two explanations fit equally well, the simpler statement first.
PREFERENCE = ("wrong_parameter", "input_error", "sensor_error", "missing_physics")
ALIKE = 1.0
TIE = 6.0  # fall of the criterion below which two explanations are told apart by nothing
PLAINER = 0.02  # of the gap, by which the price of one of them must be less for it to stand first
NEARLY = 4.0  # between shapes of one kind: the one that stands first in the catalogue is the simpler


def ranked(accounts: list[Judged], candidates: tuple[Candidate, ...]) -> list[Judged]:
    """Return accounts, the best first.

    A kind of explanation with many members (a missing term: any shape at any place) is more likely to have one that
    fits by chance than a kind with few (a wrong parameter): each kind pays for the number of its members. A simpler
    statement stands before one that is hardly better.
    """
    accounts = [one for one in accounts if np.isfinite(one.evidence)]
    if not accounts:
        return accounts
    members = Counter(verdict for verdict, _ in {(one.verdict, one.label) for one in candidates})
    paid = partial(_paid, members=members)
    accounts.sort(key=paid)
    least = min(accounts, key=lambda one: one.evidence)
    fewer = [one for one in accounts if one.account.size < least.account.size]
    simple = [one for one in fewer if one.evidence < least.evidence + MARGIN]
    first = simple[0] if simple else accounts[0]
    equal = [one for one in accounts if one.account.size == first.account.size]
    alike = [one for one in equal if abs(paid(one) - paid(first)) < ALIKE]
    alike.sort(key=lambda one: [PREFERENCE.index(verdict) for verdict in one.verdicts])
    first = alike[0]
    plainer = [
        one for one in equal if paid(one) <= paid(first) + TIE and one.account.price < first.account.price - PLAINER
    ]
    first = min(plainer, key=paid) if plainer else first
    near = [one for one in equal if paid(one) <= paid(first) + NEARLY and one.verdicts == first.verdicts]
    order = {shape.name: number for number, shape in reversed(list(enumerate(known_shapes())))}
    near.sort(key=lambda one: [order.get(part.candidate.name, len(order)) for part in one.account.parts])
    head = [near[0], *(one for one in alike if one is not near[0])]
    return head + [one for one in accounts if all(one is not other for other in head)]


def _paid(one: Judged, members: Counter[str]) -> float:
    """Evidence, and the price of picking each explanation out of its kind: minus twice the logarithm of the chance."""
    return one.evidence + sum(2 * float(np.log(max(members[verdict], 1))) for verdict in one.verdicts)
