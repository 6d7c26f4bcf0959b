"""The net moment of a joint from the EMG of the muscles that span it: activation, then gains that anatomy gives a sign.

Activation is the envelope a delay later, through a first-order lag. Each muscle's moment is its activation, times what
the speed of its fibres leaves of a force (Hill's hyperbola, 1.4 of the isometric force in lengthening), times a gain
that varies with the joint's angle (straight between the ends of what was seen, and no further), of the sign that
anatomy gives it. Beside the muscles stands what resists a departure from the usual stride of the walk that calibrates
(fibres' own stiffness, passive tissue, fast reflexes: no electrode sees it); it differs over the stride and is nowhere
negative. What remains repeatable over the stride (deep muscles, cross-talk) is kept as a curve. All is fitted by least
squares; delay and lag are those that explain blocks of strides best that were left out of the fit.

References
----------
Lloyd DG, Besier TF (2003). An EMG-driven musculoskeletal model to estimate muscle forces and knee joint moments in
vivo. J Biomech 36(6), 765-776. Buchanan TS, Lloyd DG, Manal K, Besier TF (2004). Neuromusculoskeletal modeling. J Appl
Biomech 20(4), 367-395. Zajac FE (1989). Muscle and tendon. Crit Rev Biomed Eng 17(4), 359-411. Rouse EJ, Hargrove LJ,
Perreault EJ, Kuiken TA (2014). Estimation of human ankle impedance during the stance phase of walking. IEEE Trans
Neural Syst Rehabil Eng 22(4), 870-878.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gaitdisc.errors import ChannelError
from gaitdisc.processing.joint_record import JointRecord
from gaitdisc.recording.arrays import Values

DELAYS_S = np.arange(0.0, 0.11, 0.02)
LAGS_S = (0.015, 0.03, 0.05)
GAIN_RIDGE = 0.3  # ridge that pulls the two gains of a muscle together, of the mean squared regressor
HARMONICS, USUAL_HARMONICS = 6, 8  # of the curve that no electrode sees, and of the usual angle
EDGES = (0.01, 0.99)  # quantiles of the angle between which a gain varies
# joint's speed at which its muscles give nothing [rad/s]: ten fibre lengths a second (Zajac), 5 to 10 cm long on arms
# of 4 to 5 cm, a third to two thirds of a path's change in the fibres; general knowledge, the same for all
FASTEST = 25.0
CURVATURE, ECCENTRIC = 0.25, 0.4  # of Hill's hyperbola; force in fast lengthening on top of the isometric one
FIRMNESS = 5  # parts of the stride, between which the stiffness about the usual stride goes straight
# against the positive angle (dorsiflexion, knee flexion, hip flexion), and towards it
_MUSCLES = {
    "ankle_angle": ("sol gas gasmed gaslat tp per perl perb", "ta"),
    "knee_angle": ("rf vas vasmed vaslat vasint", "ham hammed hamlat bf st sm gas gasmed gaslat"),
    "hip_flexion": ("ham hammed hamlat bf st sm gmax", "rf sart tfl ilio psoas addl"),
}
JOINTS = {"ankle_angle": "ankle", "knee_angle": "knee", "hip_flexion": "hip"}


def sign_at(joint: str, muscle: str) -> int:
    """Return the direction in which a muscle turns a joint, of a channel such as `emg_sol_r`; 0 where it does not.

    >>> sign_at("ankle_angle", "emg_sol_r"), sign_at("ankle_angle", "emg_vas_r")
    (-1, 0)
    """
    word = muscle.split("_")[1] if "_" in muscle else muscle
    against, towards = (word in words.split() for words in _MUSCLES[joint])
    return towards - against


@dataclass(frozen=True, eq=False)
class Driven:
    """What drives the muscles about a joint in one walk; one row a sample."""

    envelopes: Values  # (sample, muscle)
    signs: Values  # (muscle,) towards the positive angle or against it
    angle: Values  # [rad]
    rate: Values  # [rad/s]
    phase: Values  # share of the stride
    rate_hz: float

    def activation(self, delay_s: float, lag_s: float) -> Values:
        """Return the envelopes so much later, through a first-order lag (sample, muscle)."""
        from scipy.signal import lfilter

        at = np.arange(len(self.envelopes))
        late = np.column_stack([np.interp(at - delay_s * self.rate_hz, at, curve) for curve in self.envelopes.T])
        keep = np.exp(-1 / (lag_s * self.rate_hz))
        return np.column_stack([lfilter([1 - keep], [1, -keep], curve - curve[0]) + curve[0] for curve in late.T])


def drives(record: JointRecord) -> Driven:
    """Return what drives the muscles about the joint of a record."""
    word, signs = JOINTS[record.joint], np.array([sign_at(record.joint, name) for name in record.muscles], float)
    if not signs.any():
        raise ChannelError(
            f"to identify a device at the {word}, the EMG must include a muscle that spans the {word}",
            f"{record.subject} {record.condition} has {', '.join(record.muscles)}",
            f"Choose another joint, such as --participant {record.subject}:ankle_angle, or name a muscle in "
            "[channels].",
        )
    return Driven(
        np.nan_to_num(record.envelopes[:, signs != 0]),
        signs[signs != 0],
        np.nan_to_num(record.angle),
        np.nan_to_num(record.rate),
        record.phase,
        1 / float(np.median(np.diff(record.time))),
    )


@dataclass(frozen=True, eq=False)
class Form:
    """What the columns of a moment model depend on: timing of activation, angles seen, and the usual stride."""

    delay_s: float
    lag_s: float
    span: Values  # (2,) low and high angle between which gains vary [rad]
    usual: Values  # mean angle and its harmonics over the stride of the calibrating walk [rad]
    fastest: float = FASTEST  # [rad/s]

    def muscles(self, driven: Driven) -> Values:
        """Columns (sample, 2 a muscle): activation times force at speed, shared between the ends of the angle."""
        active = driven.activation(self.delay_s, self.lag_s)[:, :, None] * self.ends(driven)
        return active.reshape(len(active), -1)

    def firm(self, driven: Driven) -> Values:
        """Columns (sample, FIRMNESS): how far the angle is short of the usual one, in each part of the stride."""
        behind = cycle(driven.phase, USUAL_HARMONICS) @ self.usual - driven.angle
        return parts_of_stride(driven.phase, FIRMNESS) * behind[:, None]

    def columns(self, driven: Driven) -> Values:
        """All columns: two a muscle, a constant, firmness, and the waves that no electrode sees."""
        constant = np.ones((len(driven.angle), 1))
        return np.hstack([self.muscles(driven), constant, self.firm(driven), cycle(driven.phase, HARMONICS)[:, 1:]])

    def ends(self, driven: Driven) -> Values:
        """Signed share of the low and the high gain of each muscle (sample, muscle, 2)."""
        low, high = self.span
        share = np.clip((driven.angle - low) / max(high - low, 1e-9), 0.0, 1.0)
        ends = np.column_stack([1 - share, share])
        force = np.column_stack([sign * force_at_speed(-sign * driven.rate / self.fastest) for sign in driven.signs])
        return np.asarray(force[:, :, None] * ends[:, None, :], np.float64)


@dataclass(frozen=True, eq=False)
class MuscleMoment:
    """A fitted moment model."""

    form: Form
    gains: Values  # (muscle, 2) at low and high angle, without sign [N m per unit of the envelope]
    constant: float  # [N m]
    firmness: Values  # (FIRMNESS,) against a departure from the usual stride [N m/rad]
    unseen: Values  # (2 x HARMONICS,) of the curve over the stride that no electrode sees [N m]
    left_nm: float = float("nan")  # root mean square of what is left on strides left out of the fit [N m]
    before_nm: float = float("nan")  # and of the moment about its mean

    @property
    def r2(self) -> float:
        """Share of the moment's variance that is explained on strides left out of the fit."""
        return 1 - (self.left_nm / self.before_nm) ** 2

    def by_muscle(self, driven: Driven) -> Values:
        """Return each muscle's moment (sample, muscle) [N m]."""
        return driven.activation(self.form.delay_s, self.form.lag_s) * self.gain(driven)

    def net(self, driven: Driven) -> Values:
        """Return the moment of muscles and of what no electrode sees together (sample,) [N m]."""
        return self.by_muscle(driven).sum(axis=1) + self.others(driven)

    def gain(self, driven: Driven) -> Values:
        """Return each muscle's moment for each unit of activation, with its sign (sample, muscle) [N m]."""
        return np.einsum("sme,me->sm", self.form.ends(driven), self.gains)

    def others(self, driven: Driven) -> Values:
        """Return what no electrode sees: firmness about the usual stride, and a curve over it (sample,) [N m]."""
        waves = cycle(driven.phase, HARMONICS)[:, 1:] @ self.unseen
        return self.constant + self.form.firm(driven) @ self.firmness + waves


class Sums(NamedTuple):
    """Normal equations, one each of some pieces of a walk."""

    squares: Values  # (piece, column, column)
    match: Values  # (piece, column)
    power: Values  # (piece,) [(N m)2]

    def of(self, weights: Values) -> Sums:
        """Return the sum over pieces, each so many times, as one piece without its axis."""
        return Sums(*(np.tensordot(weights, term, 1) for term in self))

    def left(self, solution: Values) -> Values:
        """Return the sum of squares that coefficients leave of each piece (piece,) [(N m)2]."""
        return self.power - 2 * self.match @ solution + np.einsum("pij,i,j->p", self.squares, solution, solution)


def sum_pieces(columns: Values, moment: Values, pieces: NDArray[np.intp], count: int) -> Sums:
    """Return the normal equations of each piece 0 to count - 1; samples without a number or outside are left out."""
    known = np.isfinite(moment) & np.isfinite(columns).all(axis=1)
    sums = []
    for piece in range(count):
        rows = known & (pieces == piece)
        a, b = columns[rows], moment[rows]
        sums.append((a.T @ a, a.T @ b, b @ b))
    return Sums(*(np.array(term, np.float64) for term in zip(*sums, strict=True)))


def solved(total: Sums, muscles: int, respect: float = GAIN_RIDGE) -> Values:
    """Return coefficients of summed normal equations, then the waves of what these leave.

    Gains and firmness are not negative, the two gains of a muscle are pulled together; columns behind the waves (what a
    device does) are fitted with the first ones and are free.
    """
    waves = np.arange(2 * muscles + 1 + FIRMNESS, 2 * muscles + 1 + FIRMNESS + 2 * HARMONICS)
    first = np.setdiff1d(np.arange(len(total.match)), waves)
    signed = np.zeros(len(first), bool)
    signed[: 2 * muscles] = signed[2 * muscles + 1 : 2 * muscles + 1 + FIRMNESS] = True
    fitted = solve_signed(tied(total.squares[np.ix_(first, first)], muscles, respect), total.match[first], signed)
    solution = np.zeros(len(total.match))
    solution[first] = fitted
    residual = total.match[waves] - total.squares[np.ix_(waves, first)] @ fitted
    solution[waves] = np.linalg.lstsq(total.squares[np.ix_(waves, waves)], residual, rcond=None)[0]
    return solution


def tied(squares: Values, muscles: int, respect: float = GAIN_RIDGE) -> Values:
    """Normal equations in which the two gains of each muscle, the first columns, are pulled together by a ridge."""
    normal = squares.copy()
    for number in range(muscles):
        pair = slice(2 * number, 2 * number + 2)
        normal[pair, pair] += respect * float(np.trace(normal[pair, pair])) / 2 * (np.eye(2) - 0.5)
    return normal


def solve_signed(normal: Values, match: Values, signed: NDArray[np.bool_]) -> Values:
    """Coefficients of normal equations by least squares, the `signed` ones not negative."""
    from scipy.optimize import lsq_linear

    size = np.sqrt(np.maximum(np.diag(normal), 1e-12))
    root = np.linalg.cholesky(normal / np.outer(size, size) + 1e-9 * np.eye(len(match)))
    low = np.where(signed, 0.0, -np.inf)
    return np.asarray(lsq_linear(root.T, np.linalg.solve(root, match / size), (low, np.inf), method="bvls").x / size)


def make_model(form: Form, coefficients: Values, muscles: int, left_nm: float, before_nm: float) -> MuscleMoment:
    """Return the model of some coefficients."""
    gains, rest = coefficients[: 2 * muscles].reshape(muscles, 2), coefficients[2 * muscles :]
    firm, waves = rest[1 : 1 + FIRMNESS], rest[1 + FIRMNESS : 1 + FIRMNESS + 2 * HARMONICS]
    return MuscleMoment(form, gains, float(rest[0]), firmness=firm, unseen=waves, left_nm=left_nm, before_nm=before_nm)


def fit_moment(driven: Driven, moment: Values, blocks: NDArray[np.intp], like: Form | None = None) -> MuscleMoment:
    """Fit the model to a walk; delay and lag are those of a known form, else they are searched.

    `moment` is the net moment towards the positive angle [N m]; `blocks` numbers the blocks of strides that are left
    out of the fit in turn, -1 for none.
    """
    known = np.isfinite(moment) & np.isfinite(driven.phase) & (blocks >= 0)
    span = np.quantile(driven.angle[known], EDGES)
    usual = usual_angle(driven, known)
    timings = [(like.delay_s, like.lag_s)] if like else [(float(delay), lag) for delay in DELAYS_S for lag in LAGS_S]
    muscles, count = driven.envelopes.shape[1], int(blocks.max()) + 1
    tried = []
    for timing in timings:
        form = Form(*timing, span, usual)
        sums = sum_pieces(form.columns(driven), np.where(known, moment, np.nan), blocks, count)
        apart = 1.0 - np.eye(count)
        residual = sum(float(sums.left(solved(sums.of(apart[block]), muscles))[block]) for block in range(count))
        tried.append((residual, form, sums))
    residual, form, sums = min(tried, key=lambda attempt: attempt[0])
    left_nm, before_nm = float(np.sqrt(residual / known.sum())), float(np.std(moment[known]))
    return make_model(form, solved(sums.of(np.ones(count)), muscles), muscles, left_nm, before_nm)


def force_at_speed(lengthening: Values) -> Values:
    """Share of the isometric force at a speed of lengthening, of the fastest shortening (Hill 1938, Zajac 1989).

    >>> force_at_speed(np.array([-1.0, -0.25, 0.0, 9.0])).round(2).tolist()
    [0.0, 0.38, 1.0, 1.4]
    """
    slow = np.minimum(lengthening, 0.0)
    fast = np.maximum(lengthening, 0.0)
    shortening = np.maximum(0.0, 1.0 + slow) / (1.0 - slow / CURVATURE)
    steep = ECCENTRIC / (1.0 + 1.0 / CURVATURE)  # of one slope at rest
    return np.where(lengthening < 0, shortening, 1.0 + ECCENTRIC * fast / (fast + steep))


def usual_angle(driven: Driven, kept: NDArray[np.bool_]) -> Values:
    """Mean angle and its harmonics over the stride, of the samples that are kept [rad]."""
    turns = cycle(driven.phase, USUAL_HARMONICS)
    kept = kept & np.isfinite(driven.phase)
    return np.asarray(np.linalg.lstsq(turns[kept], driven.angle[kept], rcond=None)[0], np.float64)


def parts_of_stride(phase: Values, parts: int) -> Values:
    """How much each sample belongs to each part of the stride (sample, parts); between two parts it goes straight."""
    if parts == 1:
        return np.ones((len(phase), 1))
    at = np.mod(np.nan_to_num(phase), 1.0)[:, None] * parts
    return np.maximum(1.0 - np.abs(np.mod(at - np.arange(parts) + parts / 2, parts) - parts / 2), 0.0)


def cycle(phase: Values, harmonics: int) -> Values:
    """A constant and harmonics of the stride (sample, 1 + 2 harmonics)."""
    turn = 2 * np.pi * np.nan_to_num(phase)[:, None] * np.arange(1, harmonics + 1)
    return np.hstack([np.ones((len(phase), 1)), np.sin(turn), np.cos(turn)])
