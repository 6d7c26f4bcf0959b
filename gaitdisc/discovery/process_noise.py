"""Process noise: whether what is left looks like a system driven by noise, rather than a late or smooth sensor.

Random pushes enter the equations to first order; their variance is found by restricted likelihood and compared, by the
information criterion, with autoregressive noise of the sensors.
Source: Kristensen, Madsen and Jorgensen 2004, Automatica 40, 225 (process noise in grey-box models, there by a Kalman
filter); Patterson and Thompson 1971, Biometrika 58, 545 (restricted likelihood).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from gaitdisc.discovery.candidate_model import CandidateModel
from gaitdisc.discovery.fitted import Fitted, start_basis
from gaitdisc.discovery.linearised import linearise, seen_change
from gaitdisc.discovery.noise import noise_of, sensor_noise, white_noise
from gaitdisc.discovery.places import Place
from gaitdisc.discovery.shooting import Shooting

SHARES = np.logspace(-3, 3, 19)  # of the process noise's variance in what is seen, against the sensor's
MOST_SEGMENTS = 24
MOST_NUMBERS = 400
LEAST_NOISE = 0.01  # of a channel's residual, which its sensor's noise is at least: what rounding leaves is none
ROUNDED = 1e-3  # of the variance is taken as white: what is left of a record above its filter's cut-off


@dataclass(frozen=True)
class ProcessNoise:
    """How well random pushes at one place explain what is left."""

    place: Place
    # minus twice the restricted log likelihood plus the penalty of its numbers, over the segments looked at
    bic: float
    rival: float  # the same for autocorrelated sensor noise (an autoregression), over the same segments
    strength: float  # standard deviation of the push, held over one sample [the place's unit]
    numbers: int  # how many measured numbers were looked at


def rank_process_noise(shooting: Shooting, model: CandidateModel, places: tuple[Place, ...]) -> list[ProcessNoise]:
    """Weigh random pushes at every place against noise of the sensors; the best place first.

    returns: pushes are independent from sample to sample; the sensors' noise beside them is white
    """
    fit, segments = model.fit, shooting.segments
    most = max(MOST_NUMBERS // fit.residual.shape[2], 8)
    length = min(fit.residual.shape[1], most)
    some = np.unique(np.linspace(0, len(segments) - 1, MOST_SEGMENTS).astype(int))
    line = linearise(shooting, model.simulation, places, fit)
    known = shooting.known[some, :length]
    plain = np.where(known, fit.residual[some, :length], 0.0)
    count = known.sum(axis=(0, 1))
    size = np.sqrt((plain**2).sum(axis=(0, 1)) / count - (plain.sum(axis=(0, 1)) / count) ** 2)
    if not segments.margin:  # pushes move one channel more than another: what is left of it is no sensor's noise
        size = np.clip(sensor_noise(shooting.measured.observed), LEAST_NOISE * size, size)
    unwhitened = shooting.with_noise(white_noise(np.ones(len(size)))).at(model.machine, (), fit.values, fit.starts)
    starts = unwhitened.slopes.reshape(*fit.residual.shape, -1)[some, :length] / size[:, None] * known[..., None]
    rival = _autoregressive(fit.residual, starts * size[:, None], some, known)
    sensors = sensor_covariance(shooting, known)
    penalty = 2 * float(count @ np.log(size)) + np.log(count.sum())
    flat = (plain / size).reshape(len(some), -1), starts.reshape(len(some), plain[0].size, -1)
    # white noise by the same restricted likelihood; the filter correlates it in a known way
    rival = min(rival, _likelihood(*flat, sensors, int(count.sum()))[0] + float(penalty))
    found = []
    for number, place in enumerate(places):
        steps = fit.states.shape[1] - 1
        last = min((length - 1) * segments.every + 2 * segments.margin, steps)  # later pushes change nothing here
        change = line.pushed[some][:, :, :, number, None] * np.eye(steps)[None, :, None, :last]
        seen = _seen_in(shooting, model, some, line.among(some).of_change(change))[:, :length]
        pushed = (seen / size[:, None] * known[..., None]).reshape(len(some), -1, last)
        pushes = pushed @ np.swapaxes(pushed, 1, 2)
        unit = np.trace(pushes, axis1=1, axis2=2).sum() / count.sum()
        if unit == 0:  # pushes there change nothing of what is measured
            found.append(ProcessNoise(place, np.inf, rival, 0.0, int(count.sum())))
            continue
        tried = [(*_likelihood(*flat, sensors + share * pushes / unit, int(count.sum())), share) for share in SHARES]
        best, level, share = min(tried)
        best += float(penalty + np.log(count.sum()))
        found.append(ProcessNoise(place, best, rival, float(np.sqrt(level * share / unit)), int(count.sum())))
    return sorted(found, key=lambda one: one.bic)


def _seen_in(
    shooting: Shooting, model: CandidateModel, some: NDArray[np.intp], change: NDArray[np.float64]
) -> NDArray[np.float64]:
    """What changes of state change in some of the segments (segment, sample, channel, step)."""
    fit = model.fit
    few = replace(shooting, segments=shooting.segments.among(some))
    part = Fitted(
        fit.free, fit.values, fit.starts[some], fit.states[some], fit.residual[some], fit.white[some], fit.slopes[some]
    )
    return seen_change(few, model.machine, part, change)


def sensor_covariance(shooting: Shooting, known: NDArray[np.bool_]) -> NDArray[np.float64]:
    """Covariance of noise that was white before the filter (segment, number, number), of unit size.

    What was not measured is taken for independent of all else.
    """
    segments, length, channels = known.shape
    whole = shooting.segments.length
    unit = np.broadcast_to(np.eye(whole)[None, :, None, :], (1, whole, channels, whole))
    passed = shooting.filtered(unit, 1)[0, :length]
    out = np.zeros((length, channels, length, channels))
    for channel in range(channels):
        own = passed[:, channel] @ passed[:, channel].T
        own /= np.diag(own).mean()
        out[:, channel, :, channel] = (own + ROUNDED * np.eye(length)) / (1 + ROUNDED)
    flat = known.reshape(segments, -1)
    both = flat[:, :, None] & flat[:, None, :]
    return np.where(both, out.reshape(length * channels, -1), np.eye(length * channels))


def _likelihood(
    residual: NDArray[np.float64], starts: NDArray[np.float64], covariance: NDArray[np.float64], known: int
) -> tuple[float, float]:
    """(-2 log restricted likelihood, level) of residuals whose variance is level times a covariance."""
    count = known - starts.shape[0] * starts.shape[2]
    factor = np.linalg.cholesky(covariance)
    white = np.asarray(np.linalg.solve(factor, np.concatenate([residual[..., None], starts], axis=2)), np.float64)
    basis = start_basis(white[..., 1:])
    left = white[..., 0] - (basis @ (np.swapaxes(basis, 1, 2) @ white[..., :1]))[..., 0]
    level = float((left**2).sum()) / count
    volume = 2 * np.log(np.maximum(np.linalg.svd(white[..., 1:], compute_uv=False), 1e-12)).sum()
    scale = 2 * np.log(np.diagonal(factor, axis1=1, axis2=2)).sum()
    return float(scale + volume + count * (np.log(level) + 1)), level


def _autoregressive(
    residual: NDArray[np.float64], slopes: NDArray[np.float64], some: NDArray[np.intp], known: NDArray[np.bool_]
) -> float:
    """Return the criterion of the model with autoregressive noise of each sensor, over the same numbers."""
    noise = noise_of(residual, slopes.shape[-1] / residual.shape[2], white_share=0.0)
    plain = np.where(known, residual[some, : known.shape[1]], 0.0)
    white = noise.whitened(plain, known).reshape(len(some), -1)
    starts = noise.whitened(slopes, known).reshape(*white.shape, -1)
    basis = start_basis(starts)
    left = white - (basis @ (np.swapaxes(basis, 1, 2) @ white[..., None]))[..., 0]
    volume = 2 * np.log(np.maximum(np.linalg.svd(starts, compute_uv=False), 1e-12)).sum()
    scale = 2 * sum(
        np.log(spread[np.minimum(_known_before(known[..., channel]), len(spread) - 1)])[known[..., channel]].sum()
        for channel, spread in enumerate(noise.spread)
    )
    numbers = sum(noise.lags) + len(noise.lags)
    return float((left**2).sum() + scale + volume + numbers * np.log(known.sum()))


def _known_before(known: NDArray[np.bool_]) -> NDArray[np.intp]:
    """How many samples without a gap stand before each (segment, sample)."""
    out = np.zeros(known.shape, np.intp)
    for sample in range(1, known.shape[1]):
        out[:, sample] = (out[:, sample - 1] + 1) * known[:, sample - 1]
    return out
