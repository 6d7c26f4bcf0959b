"""Rivals: what else could stand in the place of an answer, weighed on the answer's own runs under its own noise."""

from __future__ import annotations

from dataclasses import dataclass

from gaitdisc.discovery.account import Part, account_for
from gaitdisc.discovery.evidence import Judged
from gaitdisc.discovery.ranking import TIE
from gaitdisc.discovery.search import TURNS, Search

MOST = 6


@dataclass(frozen=True)
class Rival:
    """Another explanation of the same data."""

    account: Judged
    gained: float  # fall of the Bayesian criterion from the simulation as read
    tied: bool  # whether these data cannot tell it from the answer

    @property
    def part(self) -> Part:
        """The rival's explanation."""
        return self.account.account.parts[-1]


def evidence_of(search: Search, now: Judged) -> float:
    """By how much the Bayesian criterion falls from the simulation as read to an answer, on the answer's runs."""
    return _weighed(search, now, ()).evidence - now.evidence if now.account.parts else 0.0


def rivals_of(search: Search, now: Judged, found: tuple[Judged, ...], gained: float) -> tuple[Rival, ...]:
    """Weigh other explanations against an answer: alone, and in the place of each that the answer is made of.

    now: the simulation with what was found; without any explanation, rivals keep the evidence that they were found
        with
    returns: best first; none of them explains by the same effect at the same place as the answer
    """
    own = set(now.labels)
    others: dict[str, Judged] = {}
    for one in found:
        if one.account.parts and not own & set(one.labels):
            others.setdefault(one.labels[-1], one)
    listed = list(others.values())[:MOST]
    if not own:
        return tuple(Rival(one, one.gained, False) for one in listed)
    weighed = [_best(search, now, one) for one in listed]
    rivals = [Rival(one, gained - (one.evidence - now.evidence), one.evidence - now.evidence < TIE) for one in weighed]
    return tuple(sorted(rivals, key=lambda one: -one.gained))


def _best(search: Search, now: Judged, other: Judged) -> Judged:
    """Return the best account with another's last explanation in it: alone, or beside all but one of the answer's."""
    part, parts = other.account.parts[-1], now.account.parts
    sets = [(part,)]
    if len(parts) > 1:
        sets += [(*parts[:number], *parts[number + 1 :], part) for number in range(len(parts))]
    return min((_weighed(search, now, one) for one in sets), key=lambda one: one.evidence)


def _weighed(search: Search, now: Judged, parts: tuple[Part, ...]) -> Judged:
    """Return the simulation with explanations in it, fitted to an answer's runs under its noise."""
    account = account_for(now.shooting, search.base, parts, now.account.fit.starts, TURNS, like=now.account)
    return Judged(account, now.shooting)
