"""Process noise: whether what is left looks like a system driven by noise, rather than a late or smooth sensor.

Random pushes enter the equations to first order; their variance is found by restricted likelihood and compared, by the
information criterion, with autoregressive noise of the sensors.
Source: Kristensen, Madsen and Jorgensen 2004, Automatica 40, 225 (process noise in grey-box models, there by a Kalman
filter); Patterson and Thompson 1971, Biometrika 58, 545 (restricted likelihood).
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from gaitdisc.discovery.fitted import Fitted
from gaitdisc.discovery.linearised import carry_change, linearise
from gaitdisc.discovery.noise import Noise, find_noise, sensor_noise, white_noise
from gaitdisc.discovery.places import Place
from gaitdisc.discovery.scored_model import ScoredModel
from gaitdisc.discovery.shooting import Shooting
from gaitdisc.recording.arrays import Values

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


def rank_process_noise(model: ScoredModel, places: tuple[Place, ...]) -> list[ProcessNoise]:
    """Weigh independent pushes at every place, beside white noise, against noise of the sensors; the best first."""
    fit, shooting = model.fit, model.shooting
    length = min(fit.residual.shape[1], max(MOST_NUMBERS // fit.residual.shape[2], 8))
    some = np.unique(np.linspace(0, len(shooting.segments) - 1, MOST_SEGMENTS).astype(int))
    known = shooting.known[some, :length]
    plain = np.where(known, fit.residual[some, :length], 0.0)
    count = known.sum(axis=(0, 1))
    size = np.sqrt((plain**2).sum(axis=(0, 1)) / count - (plain.sum(axis=(0, 1)) / count) ** 2)
    segments = shooting.segments.among(some)
    if not segments.margin:  # pushes move one channel more than another: what is left of it is no sensor's noise
        size = np.clip(sensor_noise(shooting.measured.observed), LEAST_NOISE * size, size)
    few, flat = replace(shooting, segments=segments).with_noise(white_noise(size)), (len(some), plain[0].size, -1)
    now = few.at(model.machine, (), fit.values, fit.starts[some])
    columns = np.concatenate([now.white[..., None], now.slopes], axis=2).reshape(*now.residual.shape, -1)[:, :length]
    factor = np.linalg.cholesky(sensor_covariance(shooting, known))
    white = np.asarray(np.linalg.solve(factor, columns.reshape(flat)), np.float64)
    now = replace(now, white=white[..., 0], slopes=white[..., 1:])
    numbers = int(count.sum()) - now.starts.size
    scale = 2 * float(count @ np.log(size)) + 2 * float(np.log(np.diagonal(factor, axis1=1, axis2=2)).sum())
    constant = scale + _volume(now.slopes) + float(np.log(count.sum()))
    # white noise by the same restricted likelihood; the filter correlates it in a known way
    unmoved = now.beside(np.zeros((*now.white.shape, 0))).likelihood(0.0, numbers)[0] + constant
    noise = find_noise(fit.residual, now.starts.shape[1] / fit.residual.shape[2], white_share=0.0)
    rival = min(_autoregressive(noise, plain, columns[..., 1:] * size[:, None], now, known), unmoved)
    few_runs = replace(model, shooting=few, fit=now)
    line, ranked = linearise(few_runs, places), []
    for number, place in enumerate(places):
        steps = fit.states.shape[1] - 1
        last = min((length - 1) * segments.every + 2 * segments.margin, steps)  # later pushes change nothing here
        change = line.pushed[:, :, :, number, None] * np.eye(steps)[None, :, None, :last]
        seen = carry_change(few_runs, line.of_change(change))[:, :length]
        pushes = (seen / size[:, None] * known[..., None]).reshape(flat)
        unit = (pushes**2).sum() / count.sum()
        if unit == 0:  # pushes there change nothing of what is measured
            ranked.append(ProcessNoise(place, np.inf, rival, 0.0, int(count.sum())))
            continue
        pushed = now.beside(np.asarray(np.linalg.solve(factor, pushes), np.float64))
        best, level, share = min((*pushed.likelihood(share / unit, numbers), share) for share in SHARES)
        best += constant + float(np.log(count.sum()))
        ranked.append(ProcessNoise(place, best, rival, float(np.sqrt(level * share / unit)), int(count.sum())))
    return sorted(ranked, key=lambda pushes: pushes.bic)


def sensor_covariance(shooting: Shooting, known: NDArray[np.bool_]) -> Values:
    """Covariance of noise that was white before the filter (segment, number, number), of unit size.

    What was not measured is taken for independent of all else.
    """
    segments, length, channels = known.shape
    whole = shooting.segments.length
    unit = np.broadcast_to(np.eye(whole)[None, :, None, :], (1, whole, channels, whole))
    passed = shooting.filtered(unit, 1)[0, :length]
    out = np.zeros((length, channels, length, channels))
    for channel in range(channels):
        filtered = passed[:, channel] @ passed[:, channel].T
        filtered /= np.diag(filtered).mean()
        out[:, channel, :, channel] = (filtered + ROUNDED * np.eye(length)) / (1 + ROUNDED)
    flat = known.reshape(segments, -1)
    both = flat[:, :, None] & flat[:, None, :]
    return np.where(both, out.reshape(length * channels, -1), np.eye(length * channels))


def _volume(starts: Values) -> float:
    """Log determinant of the information on start states, all segments together."""
    return float(2 * np.log(np.maximum(np.linalg.svd(starts, compute_uv=False), 1e-12)).sum())


def _autoregressive(noise: Noise, plain: Values, slopes: Values, now: Fitted, known: NDArray[np.bool_]) -> float:
    """Return the criterion of the model with autoregressive noise of each sensor, over the same numbers."""
    white, starts = noise.whiten(plain, known).reshape(now.white.shape), noise.whiten(slopes, known)
    now = replace(now, white=white, slopes=starts.reshape(*white.shape, -1))
    sample = np.arange(known.shape[1])[:, None]
    past = sample - 1 - np.maximum.accumulate(np.where(known, -1, sample), axis=1)  # samples without a gap before each
    scale = 2 * sum(
        np.log(spread[np.minimum(past[..., channel], len(spread) - 1)])[known[..., channel]].sum()
        for channel, spread in enumerate(noise.spread)
    )
    numbers = sum(noise.lags) + len(noise.lags)
    return float((now.projected[0] ** 2).sum() + scale + _volume(now.slopes) + numbers * np.log(known.sum()))
