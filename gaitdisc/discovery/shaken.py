"""Process noise: whether what is left looks like a system that is shaken, rather than a late or smooth sensor."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gaitdisc.discovery.account import Account
from gaitdisc.discovery.fitted import start_basis
from gaitdisc.discovery.linearised import linearise, seen_change
from gaitdisc.discovery.noise import noise_of, white_noise
from gaitdisc.discovery.places import Place
from gaitdisc.discovery.shooting import Shooting

SHARES = np.logspace(-3, 3, 19)  # of the shaking's variance in what is seen, against the sensor's
MOST_SEGMENTS = 24
MOST_NUMBERS = 400


@dataclass(frozen=True)
class Shaken:
    """How well random pushes at one place explain what is left.

    Parameters
    ----------
    place : Place
        Where the pushes come.
    evidence : float
        Minus twice the restricted log likelihood plus the price of its numbers, over the segments looked at.
    rival : float
        The same for sensor noise with a memory of its own (an autoregression), over the same segments.
    strength : float
        Standard deviation of the push, held over one sample [the place's unit].
    numbers : int
        How many measured numbers were looked at.
    """

    place: Place
    evidence: float
    rival: float
    strength: float
    numbers: int


def shaken(shooting: Shooting, account: Account, places: tuple[Place, ...]) -> list[Shaken]:
    """Weigh random pushes at every place against noise of the sensors; the best place first.

    Parameters
    ----------
    shooting : Shooting
        Short segments, with the noise that the account leaves.
    account : Account
        Fitted to them.
    places : tuple of Place
        Where pushes may come.

    Returns
    -------
    list of Shaken
        Pushes are independent from sample to sample; the sensors' noise beside them is white.
    """
    fit = account.fit
    most = max(MOST_NUMBERS // fit.residual.shape[2], 8)
    length = min(shooting.segments.length, most)
    some = np.unique(np.linspace(0, len(shooting.segments) - 1, MOST_SEGMENTS).astype(int))
    line = linearise(shooting, account.simulation, places, fit)
    plain = fit.residual[some, :length]
    size = plain.std(axis=(0, 1))
    starts = _raw_slopes(shooting, account)[some, :length] / size[:, None]
    rival = _autoregressive(fit.residual, starts * size[:, None], some, length)
    found = []
    for number, place in enumerate(places):
        steps = fit.states.shape[1] - 1
        change = line.pushed[:, :, :, number, None] * np.eye(steps)[None, :, None, :]
        seen = seen_change(shooting, account.machine, fit, line.of_change(change))[some, :length, :, : length - 1]
        flat = (seen / size[:, None]).reshape(len(some), -1, length - 1)
        pushes = flat @ np.swapaxes(flat, 1, 2)
        unit = np.trace(pushes, axis1=1, axis2=2).mean() / flat.shape[1]
        if unit == 0:  # pushes there change nothing of what is measured
            found.append(Shaken(place, np.inf, rival, 0.0, plain.size))
            continue
        best, share, level = _best_share(
            (plain / size).reshape(len(some), -1), starts.reshape(*flat.shape[:2], -1), pushes / unit
        )
        best += 2 * plain.size / plain.shape[2] * float(np.log(size).sum()) + 2 * np.log(plain.size)
        found.append(Shaken(place, best, rival, float(np.sqrt(level * share / unit)), plain.size))
    return sorted(found, key=lambda one: one.evidence)


def _best_share(
    residual: NDArray[np.float64], starts: NDArray[np.float64], pushes: NDArray[np.float64]
) -> tuple[float, float, float]:
    """(-2 log restricted likelihood, share, level) of variance level * (I + share * pushes), best over the shares."""
    results = []
    count = residual.size - starts.shape[0] * starts.shape[2]
    for share in SHARES:
        covariance = np.eye(residual.shape[1]) + share * pushes
        factor = np.linalg.cholesky(covariance)
        white = np.linalg.solve(factor, np.concatenate([residual[..., None], starts], axis=2))
        basis = start_basis(white[..., 1:])
        left = white[..., 0] - (basis @ (np.swapaxes(basis, 1, 2) @ white[..., :1]))[..., 0]
        level = float((left**2).sum()) / count
        volume = 2 * np.log(np.maximum(np.linalg.svd(white[..., 1:], compute_uv=False), 1e-12)).sum()
        scale = 2 * np.log(np.diagonal(factor, axis1=1, axis2=2)).sum()
        results.append((float(scale + volume + count * (np.log(level) + 1)), float(share), level))
    return min(results)


def _autoregressive(
    residual: NDArray[np.float64], slopes: NDArray[np.float64], some: NDArray[np.intp], length: int
) -> float:
    """Return the evidence of the account's own noise, a memory of each sensor, over the same numbers."""
    noise = noise_of(residual, slopes.shape[-1] / residual.shape[2], white_share=0.0)
    white = noise.whitened(residual[some, :length]).reshape(len(some), -1)
    starts = noise.whitened(slopes).reshape(*white.shape, -1)
    basis = start_basis(starts)
    left = white - (basis @ (np.swapaxes(basis, 1, 2) @ white[..., None]))[..., 0]
    volume = 2 * np.log(np.maximum(np.linalg.svd(starts, compute_uv=False), 1e-12)).sum()
    scale = sum(
        2 * len(some) * (np.log(spread).sum() + (length - len(spread)) * np.log(spread[-1])) for spread in noise.spread
    )
    numbers = sum(noise.lags) + len(noise.lags)
    return float((left**2).sum() + scale + volume + numbers * np.log(white.size))


def _raw_slopes(shooting: Shooting, account: Account) -> NDArray[np.float64]:
    """Return what each start state changes in what is seen (segment, sample, channel, state), unwhitened."""
    plain = shooting.with_noise(white_noise(np.ones(account.fit.residual.shape[2])))
    fit = plain.at(account.machine, (), account.fit.values, account.fit.starts)
    return fit.slopes.reshape(*account.fit.residual.shape, -1)
