"""The search: explanations are let in one by one, exchanged while that helps, and thrown out when they earn nothing."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from gaitdisc.discovery.account import Account, Part, account_for
from gaitdisc.discovery.candidate import Candidate
from gaitdisc.discovery.catalogue import known_shapes
from gaitdisc.discovery.evidence import Judged, compared
from gaitdisc.discovery.grids import Rhythm
from gaitdisc.discovery.places import Place
from gaitdisc.discovery.score import Scorer
from gaitdisc.simulation.evaluating import Points, evaluate
from gaitdisc.simulation.simulation import Simulation

MARGIN = 10.0  # by which the criterion must fall for one more explanation
MATERIAL = 0.01  # of what is explained already, which one more has to explain
REFITTED = 14
JUDGED = 5
MOST_TURNS = 5  # explanations let in, those that were thrown out again included
LIMITS = {
    "half widths of x": (0.0, np.inf),
    "frequencies": (0.0, np.inf),
    "phases": (-np.inf, np.inf),
    "phase widths": (0.0, 1.0),
}
VISITED = (0.01, 0.99)  # quantiles of a state between which a threshold has a meaning
TURNS = 15
# Where two explanations fit equally well, the simpler statement first.
PREFERENCE = ("wrong_parameter", "missing_physics", "input_error", "sensor_error")
CERTAIN = 2.5  # standard errors
ALIKE = 1.0
NEARLY = 4.0  # between shapes of one kind: the one that stands first in the catalogue is the simpler


@dataclass(frozen=True)
class Search:
    """What is searched, and in what.

    Parameters
    ----------
    base : Simulation
        As read.
    places : tuple of Place
        Where terms may enter.
    candidates : tuple of Candidate
        The explanations.
    rhythm : Rhythm
        The record's times.
    """

    base: Simulation
    places: tuple[Place, ...]
    candidates: tuple[Candidate, ...]
    rhythm: Rhythm

    def extended(self, now: Judged, judge: int = JUDGED) -> list[Judged]:
        """Return the account and, after it, others with one explanation more, all under the noise that the best leaves.

        Parameters
        ----------
        now : Judged
            What is in already.
        judge : int
            How many of the most promising, once refitted, are put under that noise.

        Returns
        -------
        list of Judged
            Empty where no explanation fits; in no order after the first.
        """
        account, shooting = now.account, now.shooting
        scorer = Scorer(shooting, account.simulation, account.machine, account.fit, self.places, self.rhythm)
        present = {(part.candidate.label, part.candidate.pieces) for part in account.parts}
        open_ones = tuple(one for one in self.candidates if (one.label, one.pieces) not in present)
        price = float(np.log(account.fit.white.size))
        scores = sorted(scorer.scores(open_ones), key=lambda one: price * len(one.candidate.slots) - one.gain)
        worth = [one for one in scores if one.gain > price * len(one.candidate.slots)][:REFITTED]
        tried = [
            account_for(
                shooting, self.base, (*account.parts, Part(one.candidate, one.values)), account.fit.starts, TURNS
            )
            for one in worth
        ]
        tried = sorted(
            (one for one in tried if self.sensible(one) and _certain(one, -1)), key=lambda one: one.criterion
        )[:judge]
        if not tried:
            return []
        before, *more = compared([now, *(Judged(one, shooting) for one in tried)], self.base)
        return [before, *(replace(one, gained=before.evidence - one.evidence) for one in more)]

    def sensible(self, account: Account) -> bool:
        """Whether every number of an account lies where it means what its name says.

        Parameters
        ----------
        account : Account
            A fitted one.
        """
        return bool(np.isfinite(account.fit.misfit)) and all(
            low < value < high for value, (low, high) in self._limits(account)
        )

    def _limits(self, account: Account) -> Iterator[tuple[float, tuple[float, float]]]:
        """Yield each constant of an account, and between which limits it means what its name says."""
        for part in account.parts:
            for slot, kind in (part.candidate.constants or {}).items():
                if kind == "quantiles of x":
                    yield part.values[slot], self._visited(account, part.candidate.role)
                elif kind == "delays":
                    yield part.values[slot], (0.0, self.rhythm.period)
                else:
                    yield part.values[slot], LIMITS[kind]
            if part.candidate.is_late:
                yield part.values["seconds"], (0.0, self.rhythm.period)

    def _visited(self, account: Account, role: str) -> tuple[float, float]:
        """Return where the run goes: a threshold beyond makes a one-sided spring a linear one, or nothing."""
        states = account.fit.states.reshape(-1, account.fit.starts.shape[1])
        nothing = np.zeros((len(states), len(self.base.inputs)))
        along = evaluate(self.base, role, Points(np.zeros(len(states)), states, nothing))
        low, high = np.quantile(along, VISITED)
        return float(low), float(high)

    def exchanged(self, now: Judged) -> Judged:
        """Return the account after each explanation was tried against all others in its place.

        Parameters
        ----------
        now : Judged
            With two explanations or more.
        """
        for number in range(len(now.account.parts)):
            others = self.extended(self.without(now, number))[1:]
            if others:
                now, *others = compared([now, *others], self.base)
                best = ranked(others)[0]
                if best.evidence < now.evidence - ALIKE:
                    now = best
        return now

    def without(self, now: Judged, number: int) -> Judged:
        """Return the account less one explanation.

        Parameters
        ----------
        now : Judged
            A fitted account.
        number : int
            Which explanation goes.
        """
        parts = now.account.parts[:number] + now.account.parts[number + 1 :]
        return Judged(account_for(now.shooting, self.base, parts, now.account.fit.starts, TURNS), now.shooting)

    def pruned(self, now: Judged, worth: float) -> Judged:
        """Return the account without the explanations that a better choice of the others has made idle.

        Parameters
        ----------
        now : Judged
            With two explanations or more.
        worth : float
            By which the evidence must get worse for one to stay.
        """
        while len(now.account.parts) > 1:
            fewer = [self.without(now, number) for number in range(len(now.account.parts))]
            best = min(fewer, key=lambda one: one.evidence)
            if best.evidence > now.evidence + worth:
                break
            now = best
        return now

    def grown(self, now: Judged, most: int) -> tuple[Judged, list[Judged]]:
        """Let explanations in while they earn their place.

        Parameters
        ----------
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
            before, *more = self.extended(now) or [now]
            more = ranked(more)
            rivals = rivals or more
            gained = before.evidence - more[0].evidence if more else 0.0
            if gained < max(MARGIN, MATERIAL * explained):
                break
            explained, better = max(explained, gained), more[0]
            if len(better.account.parts) > 1:
                better = self.pruned(self.exchanged(better), max(MARGIN, MATERIAL * explained))
            if not _certain(better.account):
                break
            now = better
            turns += 1
        return now, rivals


def ranked(accounts: list[Judged]) -> list[Judged]:
    """Return accounts, the best first; a simpler statement stands before one that is hardly better.

    Parameters
    ----------
    accounts : list of Judged
        Of equal segments.
    """
    accounts = sorted((one for one in accounts if np.isfinite(one.evidence)), key=lambda one: one.evidence)
    if not accounts:
        return accounts
    least = accounts[0].evidence
    simple = [one for one in accounts if one.evidence < least + MARGIN and one.account.size < accounts[0].account.size]
    first = simple[0] if simple else accounts[0]
    near = [
        one for one in accounts if one.evidence <= first.evidence + NEARLY and one.account.size == first.account.size
    ]
    order = {shape.name: number for number, shape in reversed(list(enumerate(known_shapes())))}
    near.sort(key=lambda one: [order.get(part.candidate.name, len(order)) for part in one.account.parts])
    first = next(one for one in near if _verdicts(one) == _verdicts(first))
    alike = [one for one in near if abs(one.evidence - first.evidence) < ALIKE]
    alike.sort(key=lambda one: [PREFERENCE.index(verdict) for verdict in _verdicts(one)])
    return alike + [one for one in accounts if one not in alike]


def _certain(account: Account, first: int = 0) -> bool:
    """Whether no explanation from `first` on could as well be idle, its number lost in its error."""
    errors = dict(zip(account.fit.free, np.sqrt(np.diag(account.fit.covariance)), strict=True))
    return all(
        abs(part.values[slot] - none) > CERTAIN * errors[names[slot]]
        for part, names in list(zip(account.parts, account.names, strict=True))[first:]
        if len(part.candidate.idle) == 1
        for slot, none in part.candidate.idle.items()
    )


def _verdicts(one: Judged) -> list[str]:
    return [part.candidate.verdict for part in one.account.parts]
