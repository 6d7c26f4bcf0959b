"""Evidence for an account: its likelihood under noise of its own making, and the price of its numbers."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gaitdisc.discovery.account import Account, account_for
from gaitdisc.discovery.noise import Noise, noise_of
from gaitdisc.discovery.shooting import Fitted, Shooting
from gaitdisc.simulation.simulation import Simulation

TURNS = 4


@dataclass(frozen=True)
class Judged:
    """An account with the noise that it leaves, learned from it.

    Parameters
    ----------
    account : Account
        Fitted under that noise.
    shooting : Shooting
        The segments, with that noise.
    evidence : float
        Minus twice the log likelihood plus the Bayesian price of every number; the smaller the better. Comparable between
        accounts of the same segments.
    """

    account: Account
    shooting: Shooting
    evidence: float

    @property
    def noise(self) -> Noise:
        """The noise that the account leaves."""
        return self.shooting.noise

    @property
    def labels(self) -> tuple[str, ...]:
        """Name and place of each explanation."""
        return tuple(part.candidate.label for part in self.account.parts)


def judged(shooting: Shooting, base: Simulation, account: Account, rounds: int = 2) -> Judged:
    """Learn an account's own noise, fit it again under it, and weigh it.

    Parameters
    ----------
    shooting : Shooting
        The segments, under any noise.
    base : Simulation
        As read.
    account : Account
        Fitted under that noise.
    rounds : int
        How often noise and fit take turns.

    Returns
    -------
    Judged
        Its evidence is -2 log L, restricted to what the start states cannot explain (REML), plus log(N) for each number.
    """
    for _ in range(rounds):
        noise = noise_of(account.fit.residual, account.fit.starts.shape[1] / account.fit.residual.shape[2])
        shooting = shooting.with_noise(noise)
        account = account_for(shooting, base, account.parts, account.fit.starts, TURNS)
    return Judged(account, shooting, evidence_of(account, noise))


def evidence_of(account: Account, noise: Noise) -> float:
    """Return minus twice the restricted log likelihood plus the price of each number.

    Parameters
    ----------
    account : Account
        Fitted under the noise.
    noise : Noise
        The noise.
    """
    segments, samples, _ = account.fit.residual.shape
    scale = 0.0
    for spread in noise.spread:
        first = np.log(spread[: min(len(spread), samples)]).sum()
        scale += 2 * segments * (first + (samples - len(spread)) * np.log(spread[-1]))
    numbers = account.size + sum(noise.lags) + len(noise.lags)
    return account.fit.misfit + scale + start_volume(account.fit) + numbers * float(np.log(account.fit.white.size))


def start_volume(fit: Fitted) -> float:
    """Return the log determinant of the start states' curvature, over all segments.

    Parameters
    ----------
    fit : Fitted
        Under the noise in question.
    """
    slopes = fit.slopes[..., : fit.starts.shape[1]]
    sizes = np.linalg.svd(slopes, compute_uv=False)
    return float(2 * np.log(np.maximum(sizes, 1e-12 * sizes.max())).sum())
