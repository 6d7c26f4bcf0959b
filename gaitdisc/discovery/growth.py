"""Growth: explanations are let in while they earn their place, exchanged while that helps, thrown out when idle."""

from __future__ import annotations

from gaitdisc.discovery.evidence import Judged, compared
from gaitdisc.discovery.ranking import ALIKE, MARGIN, ranked
from gaitdisc.discovery.search import Search, is_certain

MATERIAL = (0.0, 0.001, 0.01)  # of what is explained already, which the first, second, third explanation must explain
MOST_TURNS = 5  # explanations let in, those that were thrown out again included
FIRST_PLACES = 5  # that a second explanation is sought beside
SETTLED = 3  # turns of exchanging and throwing out


def grown(search: Search, now: Judged, most: int) -> tuple[Judged, list[Judged]]:
    """Let explanations in while they earn their place.

    Parameters
    ----------
    search : Search
        What is searched.
    now : Judged
        What to begin with.
    most : int
        Most explanations.

    Returns
    -------
    now : Judged
        With what was let in.
    rivals : list of Judged
        What else stood for the first place, best first.
    """
    rivals: list[Judged] = []
    explained, turns = 0.0, 0
    while len(now.account.parts) < most and turns < MOST_TURNS:
        before, *more = search.extended(now) or [now]
        more = ranked(more, search.candidates)
        rivals = rivals or more
        if not more or before.evidence - more[0].evidence < MARGIN:
            break
        better = more[0]
        if len(better.account.parts) == 2:
            better = beside_others(search, better, [one for one in rivals if one is not now])
        worth = max(MARGIN, MATERIAL[min(len(better.account.parts), len(MATERIAL)) - 1] * explained)
        if len(better.account.parts) > 1:
            better = settled(search, better, worth)
            before, better = compared([before, better], search.base)
        gained = before.evidence - better.evidence
        if gained < worth or not is_certain(better.account):
            break
        explained, now, turns = max(explained, gained), better, turns + 1
    return now, rivals


def beside_others(search: Search, pair: Judged, firsts: list[Judged]) -> Judged:
    """Return the best pair of explanations, also of those whose first was not the best alone.

    Two effects together may look most like a third one, which then stands in the way of both.

    Parameters
    ----------
    search : Search
        What is searched.
    pair : Judged
        The best alone, and what stands best beside it.
    firsts : list of Judged
        What else stood for the first place, best first.
    """
    pairs = [pair]
    for first in firsts[: FIRST_PLACES - 1]:
        pairs += ranked(search.extended(first)[1:], search.candidates)[:1]
    return ranked(compared(pairs, search.base), search.candidates)[0]


def settled(search: Search, now: Judged, worth: float) -> Judged:
    """Exchange and throw out explanations until nothing changes.

    Parameters
    ----------
    search : Search
        What is searched.
    now : Judged
        With two explanations or more.
    worth : float
        By which the evidence must get worse for one to stay.
    """
    for _ in range(SETTLED):
        before = now
        now = pruned(search, exchanged(search, now), worth)
        if sorted(now.labels) == sorted(before.labels):
            break
    return now


def exchanged(search: Search, now: Judged) -> Judged:
    """Return the account after each explanation was tried against all others in its place.

    Parameters
    ----------
    search : Search
        What is searched.
    now : Judged
        With two explanations or more.
    """
    for number in range(len(now.account.parts)):
        others = search.extended(search.without(now, number))[1:]
        if others:
            now, *others = compared([now, *others], search.base)
            best = ranked(others, search.candidates)[0]
            if best.evidence < now.evidence - ALIKE:
                now = best
    return now


def pruned(search: Search, now: Judged, worth: float) -> Judged:
    """Return the account without the explanations that a better choice of the others has made idle.

    Parameters
    ----------
    search : Search
        What is searched.
    now : Judged
        With two explanations or more.
    worth : float
        By which the evidence must get worse for one to stay.
    """
    while len(now.account.parts) > 1:
        fewer = [search.without(now, number) for number in range(len(now.account.parts))]
        best = min(fewer, key=lambda one: one.evidence)
        if best.evidence > now.evidence + worth:
            break
        now = best
    return now
