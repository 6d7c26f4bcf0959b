"""Rivals: other explanations of the same data, ranked on the answer's own runs under its own noise."""

from __future__ import annotations

from dataclasses import dataclass

from gaitdisc.discovery.candidate_model import Part, fit_model
from gaitdisc.discovery.criteria import CRITERIA
from gaitdisc.discovery.scored_model import ScoredModel
from gaitdisc.discovery.search import TURNS, Search

MOST = 6


@dataclass(frozen=True)
class Rival:
    """Another explanation of the same data."""

    scored: ScoredModel
    gained: float  # fall of the information criterion from the simulation as read
    tied: bool  # whether these data cannot distinguish it from the answer

    @property
    def part(self) -> Part:
        """The rival's explanation."""
        return self.scored.model.parts[-1]


def bic_gain(search: Search, now: ScoredModel) -> float:
    """By how much the information criterion falls from the simulation as read to an answer, on the answer's runs."""
    return _fitted(search, now, ()).bic - now.bic if now.model.parts else 0.0


def rivals_of(search: Search, now: ScoredModel, found: tuple[ScoredModel, ...], gained: float) -> tuple[Rival, ...]:
    """Weigh other explanations against an answer: alone, and in the place of each that the answer is made of.

    now: the simulation with what was found; without any explanation, rivals keep the criterion that they were found
        with
    returns: best first; none of them is of the same effects at the same places as the answer
    """
    own = sorted(now.labels)
    others: dict[tuple[str, ...], ScoredModel] = {}
    for one in found:
        if one.model.parts and sorted(one.labels) != own:
            others.setdefault(tuple(sorted(one.labels)), one)
    listed = list(others.values())[:MOST]
    if not own:
        return tuple(Rival(one, one.gained, False) for one in listed)
    fitted: dict[tuple[str, ...], ScoredModel] = {}
    for one in listed:
        best = _fitted(search, now, one.model.parts) if one.labels[-1] in own else _best(search, now, one)
        fitted.setdefault(tuple(sorted(best.labels)), best)
    rivals = [Rival(one, gained - (one.bic - now.bic), one.bic - now.bic < CRITERIA.tie) for one in fitted.values()]
    return tuple(sorted(rivals, key=lambda one: -one.gained))


def _best(search: Search, now: ScoredModel, other: ScoredModel) -> ScoredModel:
    """Return the best model with another's last explanation in it: alone, as it was, or beside the answer's but one."""
    part, parts = other.model.parts[-1], now.model.parts
    sets = [(part,), *([other.model.parts] if len(other.model.parts) > 1 else [])]
    if len(parts) > 1:
        sets += [(*parts[:number], *parts[number + 1 :], part) for number in range(len(parts))]
    return min((_fitted(search, now, one) for one in sets), key=lambda one: one.bic)


def _fitted(search: Search, now: ScoredModel, parts: tuple[Part, ...]) -> ScoredModel:
    """Return the simulation with explanations in it, fitted to an answer's runs under its noise."""
    model = fit_model(now.shooting, search.base, parts, now.model.fit.starts, TURNS, like=now.model)
    return ScoredModel(model, now.shooting)
