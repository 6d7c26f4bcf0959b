"""The net moment of a joint from the EMG of the muscles that span it: activation, then gains that anatomy gives a sign.

Activation is the envelope a delay later, through a first-order lag. Each muscle's moment is its activation times a gain
that varies with the joint's angle and rate (bilinear between the ends of what was seen, and no further), of the sign
that anatomy gives it and nowhere of the other. Beside the muscles stand a passive spring and damper, which resist, and
a constant. What remains repeatable over the stride is what no electrode sees (deep muscles, cross-talk): it is kept as
a curve over the stride. All is fitted to one walk by least squares; delay and lag are those that explain blocks of
strides best that were left out of the fit.

References
----------
Lloyd DG, Besier TF (2003). An EMG-driven musculoskeletal model to estimate muscle forces and knee joint moments in
vivo. J Biomech 36(6), 765-776. Buchanan TS, Lloyd DG, Manal K, Besier TF (2004). Neuromusculoskeletal modeling. J Appl
Biomech 20(4), 367-395.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

DELAYS_S = np.arange(0.0, 0.11, 0.02)
LAGS_S = (0.015, 0.03, 0.05)
RESPECT = 0.03  # ridge that pulls the four gains of a muscle together, of the mean squared regressor
HARMONICS = 6  # of the curve that no electrode sees
EDGES = (0.01, 0.99)  # quantiles of angle and rate between which a gain varies
# towards the positive angle (dorsiflexion, knee flexion, hip flexion), or against it
SPANS: Mapping[str, Mapping[str, int]] = {
    "ankle_angle": {
        "sol": -1,
        "gas": -1,
        "gasmed": -1,
        "gaslat": -1,
        "tp": -1,
        "per": -1,
        "perl": -1,
        "perb": -1,
        "ta": 1,
    },
    "knee_angle": {
        **{"ham": 1, "hammed": 1, "hamlat": 1, "bf": 1, "st": 1, "sm": 1, "gas": 1, "gasmed": 1, "gaslat": 1},
        **{"rf": -1, "vas": -1, "vasmed": -1, "vaslat": -1, "vasint": -1},
    },
    "hip_flexion": {
        **{"ham": -1, "hammed": -1, "hamlat": -1, "bf": -1, "st": -1, "sm": -1, "gmax": -1},
        **{"rf": 1, "sart": 1, "tfl": 1, "ilio": 1, "psoas": 1, "addl": 1},
    },
}
Values = NDArray[np.float64]


def sign_at(joint: str, muscle: str) -> int:
    """Return the direction in which a muscle turns a joint, of a channel such as `emg_sol_r`; 0 where it does not.

    >>> sign_at("ankle_angle", "emg_sol_r"), sign_at("ankle_angle", "emg_vas_r")
    (-1, 0)
    """
    return SPANS[joint].get(muscle.split("_")[1] if "_" in muscle else muscle, 0)


@dataclass(frozen=True, eq=False)
class Driven:
    """What drives the muscles about a joint in one walk."""

    envelopes: Values  # (sample, muscle), EMG envelopes of the muscles that span the joint
    signs: Values  # (muscle,), towards the positive angle or against it
    angle: Values  # (sample,), [rad, rad/s, share of the stride]
    rate: Values  # (sample,), [rad, rad/s, share of the stride]
    phase: Values  # (sample,), [rad, rad/s, share of the stride]
    rate_hz: float  # samples a second

    def activation(self, delay_s: float, lag_s: float) -> Values:
        """Return the envelopes so much later, through a first-order lag (sample, muscle)."""
        from scipy.signal import lfilter

        at = np.arange(len(self.envelopes))
        late = np.column_stack([np.interp(at - delay_s * self.rate_hz, at, one) for one in self.envelopes.T])
        keep = np.exp(-1 / (lag_s * self.rate_hz))
        return np.column_stack([lfilter([1 - keep], [1, -keep], one - one[0]) + one[0] for one in late.T])


@dataclass(frozen=True, eq=False)
class MuscleMoment:
    """A fitted moment model."""

    # (muscle, 4), at low and high angle, each at low and high rate, without sign [N m per unit of the envelope]
    gains: Values
    passive: Values  # (3,), stiffness [N m/rad], damping [N m s/rad], constant [N m]
    unseen: Values  # (2 x HARMONICS,), sines and cosines of the curve over the stride that no electrode sees [N m]
    span: Values  # (2, 2), low and high angle [rad] and rate [rad/s] between which gains vary
    delay_s: float
    lag_s: float
    # root mean square of what is left, and of the moment about its mean, on strides left out of the fit [N m]
    left_nm: float = float("nan")
    # root mean square of what is left, and of the moment about its mean, on strides left out of the fit [N m]
    before_nm: float = float("nan")

    @property
    def r2(self) -> float:
        """Share of the moment's variance that is explained on strides left out of the fit."""
        return 1 - (self.left_nm / self.before_nm) ** 2

    def by_muscle(self, driven: Driven) -> Values:
        """Return each muscle's moment (sample, muscle) [N m]."""
        return driven.activation(self.delay_s, self.lag_s) * self.gain(driven)

    def net(self, driven: Driven) -> Values:
        """Return the moment of muscles and of what no electrode sees together (sample,) [N m]."""
        return self.by_muscle(driven).sum(axis=1) + self.others(driven)

    def gain(self, driven: Driven) -> Values:
        """Return each muscle's moment for each unit of activation, with its sign (sample, muscle) [N m]."""
        return driven.signs * (_corners(driven, self.span) @ self.gains.T)

    def others(self, driven: Driven) -> Values:
        """Return passive parts and the curve over the stride, which no electrode sees (sample,) [N m]."""
        return _passive(driven) @ self.passive + _waves(driven.phase) @ self.unseen


def fitted_moment(
    driven: Driven, moment: Values, blocks: NDArray[np.intp], timing: tuple[float, float] | None = None
) -> MuscleMoment:
    """Fit the model to a walk; delay and lag [s] are searched where they are not given.

    moment (sample,): net moment towards the positive angle [N m]
    blocks (sample,): which block of strides each sample belongs to; -1 for none. Each is left out of the fit once
    """
    known = np.isfinite(moment) & np.isfinite(driven.phase) & (blocks >= 0)
    span = np.array([np.quantile(one[known], EDGES) for one in (driven.angle, driven.rate)])
    timings = [timing] if timing else [(float(delay), lag) for delay in DELAYS_S for lag in LAGS_S]
    coarse = [_left_out(driven, moment, blocks, span, timing, known) for timing in timings]
    delay, lag = timings[int(np.argmin(coarse))]
    whole = _solved(driven, moment, span, (delay, lag), known)
    left = float(min(coarse))
    return MuscleMoment(*whole, span, delay, lag, left, float(np.std(moment[known])))


def _left_out(
    driven: Driven,
    moment: Values,
    blocks: NDArray[np.intp],
    span: Values,
    timing: tuple[float, float],
    known: NDArray[np.bool_],
) -> float:
    """Root mean square of what is left of blocks that were left out of the fit [N m]."""
    parts = _parts(driven, span, timing)
    squares, muscles = 0.0, driven.envelopes.shape[1]
    for block in np.unique(blocks[known]):
        own = known & (blocks == block)
        found = _bounded(parts, moment, known & ~own, muscles)
        squares += float(((moment[own] - parts[own] @ found) ** 2).sum())
    return float(np.sqrt(squares / known.sum()))


def _solved(
    driven: Driven, moment: Values, span: Values, timing: tuple[float, float], known: NDArray[np.bool_]
) -> tuple[Values, Values, Values]:
    muscles = driven.envelopes.shape[1]
    found = _bounded(_parts(driven, span, timing), moment, known, muscles)
    return found[: 4 * muscles].reshape(muscles, 4), found[4 * muscles : 4 * muscles + 3], found[4 * muscles + 3 :]


def _parts(driven: Driven, span: Values, timing: tuple[float, float]) -> Values:
    """Regressors (sample, 4 a muscle + 3 + waves)."""
    active = driven.signs * driven.activation(*timing)
    corners = _corners(driven, span)
    muscles = [active[:, [number]] * corners for number in range(active.shape[1])]
    return np.hstack([*muscles, _passive(driven), _waves(driven.phase)])


def _bounded(parts: Values, moment: Values, kept: NDArray[np.bool_], muscles: int) -> Values:
    """Least squares with gains, stiffness and damping that are not negative; then the curve, of what these leave."""
    first = 4 * muscles + 3
    seen = _signed(parts[:, :first], moment, kept, muscles)
    left = (moment - parts[:, :first] @ seen)[kept]
    return np.asarray(np.concatenate([seen, np.linalg.lstsq(parts[kept, first:], left, rcond=None)[0]]), np.float64)


def _signed(parts: Values, moment: Values, kept: NDArray[np.bool_], muscles: int) -> Values:
    """Least squares with gains, stiffness and damping that are not negative, a muscle's gains pulled together."""
    from scipy.optimize import lsq_linear

    columns = parts.shape[1]
    normal, match = parts[kept].T @ parts[kept], parts[kept].T @ moment[kept]
    for number in range(muscles):
        own = slice(4 * number, 4 * number + 4)
        size = float(np.trace(normal[own, own])) / 4
        normal[own, own] += RESPECT * size * (np.eye(4) - 0.25)
    size = np.sqrt(np.maximum(np.diag(normal), 1e-12))
    scaled = normal / np.outer(size, size) + 1e-9 * np.eye(columns)
    root = np.linalg.cholesky(scaled)
    low = np.full(columns, -np.inf)
    low[: 4 * muscles + 2] = 0.0
    found = lsq_linear(
        root.T, np.linalg.solve(root, match / size), (low, np.inf), method="bvls" if columns < 40 else "trf"
    )
    return np.asarray(found.x / size, np.float64)


def _corners(driven: Driven, span: Values) -> Values:
    """Weights of the four ends of angle and rate (sample, 4): they add up to 1."""
    shares = [
        np.clip((one - low) / max(high - low, 1e-9), 0.0, 1.0)
        for one, (low, high) in zip((driven.angle, driven.rate), span, strict=True)
    ]
    return np.column_stack([a * b for a in (1 - shares[0], shares[0]) for b in (1 - shares[1], shares[1])])


def _passive(driven: Driven) -> Values:
    return np.column_stack([-driven.angle, -driven.rate, np.ones(len(driven.angle))])


def _waves(phase: Values) -> Values:
    turn = 2 * np.pi * np.nan_to_num(phase)[:, None] * np.arange(1, HARMONICS + 1)
    return np.hstack([np.sin(turn), np.cos(turn)])
