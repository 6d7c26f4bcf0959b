"""Evidence for an account: its likelihood under noise learned from what it leaves, and the price of its numbers."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from gaitdisc.discovery.account import Account, account_for
from gaitdisc.discovery.noise import Noise, noise_of
from gaitdisc.discovery.shooting import Shooting
from gaitdisc.simulation.simulation import Simulation

TURNS = 4
INTEGRATED = 1e-4  # of a channel's spread: how far two integrators of one model may be apart


@dataclass(frozen=True)
class Judged:
    """An account fitted under a noise that was learned from it, or from a better one."""

    account: Account
    shooting: Shooting
    gained: float = 0.0  # fall of the evidence against the same without its last explanation, under one noise

    @property
    def evidence(self) -> float:
        """Minus twice the log likelihood plus log(N) for each number fitted; the smaller the better.

        Comparable between accounts of the same segments under the same noise, and only between these.
        """
        return self.account.criterion

    @property
    def noise(self) -> Noise:
        """The noise that the account was fitted under."""
        return self.shooting.noise

    @property
    def labels(self) -> tuple[str, ...]:
        """Name and place of each explanation."""
        return tuple(part.candidate.label for part in self.account.parts)

    @property
    def verdicts(self) -> tuple[str, ...]:
        """What kind of explanation each is."""
        return tuple(part.candidate.verdict for part in self.account.parts)

    def under(self, other: Judged, base: Simulation) -> Judged:
        """Return the account fitted again under another's noise, so that the two can be compared."""
        if other.shooting is self.shooting:
            return self
        account = account_for(
            other.shooting, base, self.account.parts, self.account.fit.starts, TURNS, like=self.account
        )
        return Judged(account, other.shooting, self.gained)


def judged(shooting: Shooting, base: Simulation, account: Account, rounds: int = 2) -> Judged:
    """Learn an account's own noise, and its own past for what comes late, and fit it again under them."""
    least = INTEGRATED * np.nanstd(shooting.measured.observed, axis=(0, 1))
    for _ in range(rounds):
        used = account.fit.starts.shape[1] / account.fit.residual.shape[2]
        noise = noise_of(account.fit.residual, used, least=least, memory=shooting.filter_memory)
        shooting = shooting.with_noise(noise).with_past(account.fit.states)
        account = account_for(shooting, base, account.parts, account.fit.starts, TURNS, like=account)
    return Judged(account, shooting)


def compared(accounts: list[Judged], base: Simulation) -> list[Judged]:
    """Put accounts under one noise: what the best of them leaves.

    accounts: of the same segments; those under the noise of the first stay as they are
    """
    accounts = [one.under(accounts[0], base) for one in accounts]
    for _ in range(len(accounts)):
        best = min(range(len(accounts)), key=lambda number: accounts[number].evidence)
        own = replace(judged(accounts[best].shooting, base, accounts[best].account), gained=accounts[best].gained)
        accounts = [own if number == best else one.under(own, base) for number, one in enumerate(accounts)]
        if min(range(len(accounts)), key=lambda number: accounts[number].evidence) == best:
            break
    return accounts
