"""The search: every explanation is scored at once, the most promising are fitted, and judged under one noise."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace

import numpy as np

from gaitdisc.discovery.account import Account, Part, account_for
from gaitdisc.discovery.candidate import Candidate
from gaitdisc.discovery.evidence import Judged, compared
from gaitdisc.discovery.grids import Rhythm
from gaitdisc.discovery.places import Place
from gaitdisc.discovery.score import Score, Scorer
from gaitdisc.discovery.shooting import Shooting
from gaitdisc.simulation.evaluating import Points, evaluate
from gaitdisc.simulation.simulation import Simulation

REFITTED = 18
JUDGED = 5
LIMITS = {
    "frequencies": (0.0, np.inf),
    "phases": (-np.inf, np.inf),
    "phase widths": (0.0, 1.0),
}
VISITED = (0.01, 0.99)  # quantiles of a state between which a threshold has a meaning
WIDEST = 2.0  # times how far a state goes, beyond which no half width shows
TURNS = 15
NEARLY = 0.5  # off the misfit: too little to tell explanations apart by
CERTAIN = 2.5  # standard errors
EVERY = 5.0  # seconds between two lines about a round that lasts


def _unheard(line: str) -> None:
    """Where nobody wants to know how far it is."""


@dataclass(frozen=True)
class Search:
    """What is searched, and in what."""

    base: Simulation
    places: tuple[Place, ...]
    candidates: tuple[Candidate, ...]
    rhythm: Rhythm
    told: Callable[[str], None] = field(default_factory=lambda: _unheard, compare=False)

    def extended(self, now: Judged, judge: int = JUDGED) -> list[Judged]:
        """Return the account and, after it, others with one explanation more, all under the noise that the best leaves.

        judge: how many of the most promising, once refitted, are put under that noise
        returns: empty where no explanation fits; in no order after the first
        """
        account, shooting = now.account, now.shooting
        scorer = self.scorer(shooting, account)
        open_ones = self.open_beside(account)
        price = float(np.log(account.fit.white.size))
        scores = sorted(scorer.scores(open_ones), key=lambda one: price * len(one.candidate.slots) - one.gain)
        worth = [one for one in scores if one.gain > price * len(one.candidate.slots)][:REFITTED]
        tried = [
            account_for(
                shooting,
                self.base,
                (*account.parts, Part(one.candidate, one.values)),
                account.fit.starts,
                TURNS,
                NEARLY,
                account,
            )
            for one in self._reported(worth)
        ]
        tried = sorted(
            (one for one in tried if self.sensible(one) and is_certain(one, -1)), key=lambda one: one.criterion
        )[:judge]
        if not tried:
            return []
        before, *more = compared([now, *(Judged(one, shooting) for one in tried)], self.base)
        return [before, *(replace(one, gained=before.evidence - one.evidence) for one in more)]

    def _reported(self, worth: list[Score]) -> Iterator[Score]:
        """Yield each in turn, and say now and then how many are fitted and how long the others will take."""
        began = last = time.perf_counter()
        for done, one in enumerate(worth):
            now = time.perf_counter()
            if done and now - last >= EVERY:
                left = (now - began) / done * (len(worth) - done)
                self.told(f"{done} of {len(worth)} explanations fitted, {left:.0f} s left of this round")
                last = now
            yield one

    def scorer(self, shooting: Shooting, account: Account) -> Scorer:
        """Return what scores further explanations beside an account, to first order."""
        return Scorer(shooting, account.simulation, account.machine, account.fit, self.places, self.rhythm)

    def open_beside(self, account: Account) -> tuple[Candidate, ...]:
        """Return the explanations that are not in an account."""
        present = account.explanations
        return tuple(one for one in self.candidates if one.identity not in present)

    def sensible(self, account: Account) -> bool:
        """Whether every number of an account lies where it means what its name says."""
        return bool(np.isfinite(account.fit.misfit)) and all(
            low < value < high for value, (low, high) in self._limits(account)
        )

    def _limits(self, account: Account) -> Iterator[tuple[float, tuple[float, float]]]:
        """Yield each constant of an account, and between which limits it means what its name says."""
        for part in account.parts:
            for slot, kind in (part.candidate.constants or {}).items():
                if kind == "quantiles of x":
                    yield part.values[slot], self._visited(account, part.candidate.role)
                elif kind == "half widths of x":
                    yield part.values[slot], (0.0, self._widest(account, part.candidate.role))
                elif kind == "delays":
                    yield part.values[slot], (0.0, self.rhythm.period)
                else:
                    yield part.values[slot], LIMITS[kind]
            if part.candidate.bounds:
                yield part.candidate.beyond_bounds(part.values["value"]), (0.0, np.inf)
            if part.candidate.is_late:
                early = -self.rhythm.period if part.candidate.name == "input_delay" else 0.0
                yield part.values["seconds"], (early, self.rhythm.period)

    def _visited(self, account: Account, role: str) -> tuple[float, float]:
        """Return where the run goes: a threshold beyond makes a one-sided spring a linear one, or nothing."""
        known = len(self.base.states)
        states = account.fit.states[..., :known].reshape(-1, known)
        nothing = np.zeros((len(states), len(self.base.inputs)))
        along = evaluate(self.base, role, Points(np.zeros(len(states)), states, nothing))
        low, high = np.quantile(along, VISITED)
        return float(low), float(high)

    def _widest(self, account: Account, role: str) -> float:
        """Return the half width that a run can show; of an input, one that it never reaches does nothing anyway."""
        driven = any(each.name == role for each in self.base.inputs)
        return np.inf if driven else WIDEST * max(map(abs, self._visited(account, role)))

    def without(self, now: Judged, number: int) -> Judged:
        """Return the account less one explanation."""
        parts = now.account.parts[:number] + now.account.parts[number + 1 :]
        fewer = account_for(now.shooting, self.base, parts, now.account.fit.starts, TURNS, like=now.account)
        return Judged(fewer, now.shooting)


def is_certain(account: Account, first: int = 0) -> bool:
    """Whether no explanation from `first` on could as well be idle, its number lost in its error."""
    variance = np.diag(account.fit.covariance)
    error = np.sqrt(np.where(variance >= 0, variance, np.inf))  # rounding makes that of what is not determined negative
    errors = dict(zip(account.fit.free, error, strict=True))
    return all(
        _off(part, slot, none) > CERTAIN * errors[names[slot]]
        for part, names in list(zip(account.parts, account.names, strict=True))[first:]
        if len(part.candidate.idle) == 1
        for slot, none in part.candidate.idle.items()
    )


def _off(part: Part, slot: str, idle: float) -> float:
    """How far a number is from where it changes nothing: a wrong parameter with bounds, from the nearer of these."""
    if part.candidate.bounds:
        return part.candidate.beyond_bounds(part.values[slot])
    return abs(part.values[slot] - idle)
