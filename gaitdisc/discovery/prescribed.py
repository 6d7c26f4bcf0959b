"""What a prescribed motion leaves of a joint's moment, named: the catalogue's shapes by whitened least squares.

A prescribed motion has no start to be found and no run that departs: what is left at a joint is the missing effect and
noise. The noise of angles is anything but white in a moment (it was differentiated twice) and differs by joint, so each
joint is whitened by what noise of the angles makes of its own moment, or by what its best explanation leaves, where
that is more.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from gaitdisc.discovery.candidate import Candidate
from gaitdisc.discovery.criteria import CRITERIA
from gaitdisc.discovery.grids import Rhythm, cells
from gaitdisc.discovery.noise import Noise, find_noise
from gaitdisc.discovery.paired_test import PairedTest, compare_errors
from gaitdisc.discovery.scored_model import Part
from gaitdisc.recording.arrays import Values

LATEST_S, DELAYS = 0.12, 25
BLOCK, MOST_BLOCKS = 4, 10  # samples of a block of time that is held out at least: a period of the low-pass; blocks
GAP = 2  # samples to either side of it that nothing is learned from: what is half a period apart is independent
CLOSED = 0.3  # of the squared moment that is left, which goes on held-out time
ROUNDS, REFINED = 2, 4  # turns of learning the noise; candidates whose constants are searched between the grid's
FLAT = 1e-9
CHANCE = 0.05  # of a walk of which nothing is missing that is not said to agree
UNTESTED = PairedTest(1.0, 0, 0.0)
SAMPLES_A_NUMBER = 2.0  # of the low-pass: the samples that are kept hold each number that passes twice


@dataclass(frozen=True, eq=False)
class ResidualMoment:
    """What is left at one joint, at samples that hold all that the record's low-pass passes."""

    port: str
    time: Values  # (sample,) [s]
    left: Values  # (sample,) demanded less what the files' forces give [N m]
    demanded: Values  # (sample,) [N m]
    angle_noise: Values  # (draw, sample), what noise of the angles makes of it [N m]
    along: Values  # (record's sample,) the coordinate [rad]
    columns: Callable[[Candidate, Mapping[str, float]], Values]  # (sample, piece)

    @property
    def floor(self) -> float:
        """Size of what the noise of angles and a hundredth of the moment make [N m]."""
        return float(np.hypot(np.sqrt(np.mean(self.angle_noise**2)), CRITERIA.model_error * np.std(self.demanded)))

    @property
    def blocks(self) -> list[tuple[NDArray[np.intp], NDArray[np.intp]]]:
        """Samples of each block of the time, and those that are further than a gap from it."""
        every = np.arange(len(self.time))
        count = max(min(len(every) // BLOCK, MOST_BLOCKS), 2)
        blocks = np.array_split(every, count)
        return [(block, every[(every < block[0] - GAP) | (every > block[-1] + GAP)]) for block in blocks]

    def explained(self, candidate: Candidate, values: Mapping[str, float]) -> Values:
        """What a candidate with some numbers makes of the moment (sample,) [N m]."""
        constants = {slot: values[slot] for slot in candidate.constants or {}}
        factors = [values[slot] for slot in candidate.slots[: len(candidate.pieces)]]
        if candidate.verdict == "wrong_parameter":
            late = candidate.place.endswith("_delay")
            constants, factors = (values, [1.0]) if late else ({}, [values["value"] - candidate.value])
        return self.columns(candidate, constants) @ np.array(factors)

    def predict(self, candidate: Candidate, numbers: Sequence[Mapping[str, float] | None]) -> Values:
        """Predict each block of the time by a candidate's numbers for it (sample,); 0 where it has none."""
        predicted = np.zeros(len(self.time))
        for (held, _), values in zip(self.blocks, numbers, strict=True):
            if values is not None:
                predicted[held] = self.explained(candidate, values)[held]
        return predicted

    def slope(self, candidate: Candidate, values: Mapping[str, float], slot: str) -> Values:
        """What a unit of one of its numbers adds (sample,)."""
        step = 1e-3 * max(abs(values[slot]), 1e-2)
        sides = [self.explained(candidate, {**values, slot: values[slot] + sign * step}) for sign in (1, -1)]
        return (sides[0] - sides[1]) / (2 * step)


@dataclass(frozen=True, eq=False)
class Named(Part):
    """An explanation of what is left at a joint, and how it fares on time that was held out."""

    covariance: Values  # (slot, slot)
    explained: Values  # (sample,) [N m]
    predicted: Values  # (sample,), each block of the time from the rest of it [N m]
    gained: float  # fall of twice the log likelihood beyond the price of its numbers and of choosing it
    held_out: float = 0.0  # fall of twice the log likelihood of what was held out
    test: PairedTest = UNTESTED


@dataclass(frozen=True, eq=False)
class JointFinding:
    """What one joint shows."""

    joint: ResidualMoment
    noise: Noise
    open_ones: int  # candidates at all joints
    at_noise: bool = True  # whether noise of the angles makes as much (chi-squared test)
    named: Named | None = None
    rivals: tuple[Named, ...] = ()  # best first

    def least(self, column: Values) -> float:
        """Smallest factor of a column (sample,) that would be named here."""
        samples = len(self.joint.time)
        required = (CRITERIA.margin + self._price(1)) * SAMPLES_A_NUMBER / samples
        size = float(np.linalg.norm(self._white(column)))
        return float(np.sqrt(samples * np.expm1(required))) / size if size > FLAT else float("inf")

    def weigh(self, candidates: tuple[Candidate, ...], refined: bool) -> list[Named]:
        """Fit candidates to all of the record, the best first."""
        fitted = [self._fitted(candidate, refined) for candidate in candidates]
        return sorted((named for named in fitted if named is not None), key=lambda named: -named.gained)

    def _fitted(self, candidate: Candidate, refined: bool) -> Named | None:
        """Numbers of a candidate on all of the record, None where it is nowhere in it."""
        joint, samples, count = self.joint, len(self.joint.time), len(candidate.slots)
        values = self._numbers(candidate, np.arange(samples), refined)
        if values is None:
            return None
        explained = joint.explained(candidate, values)
        slopes = np.column_stack([joint.slope(candidate, values, slot) for slot in candidate.slots])
        jacobian = self._white(slopes)
        before, after = (float((self._white(residual) ** 2).sum()) for residual in (joint.left, joint.left - explained))
        variance = max(after / max(samples - count, 1), 1.0)
        covariance = np.asarray(variance * np.linalg.pinv(jacobian.T @ jacobian), np.float64)
        gained = _fall(before, after, samples) - self._price(count)
        return Named(candidate, values, covariance, explained, np.zeros(samples), gained)

    def prove(self, fit: Named) -> Named:
        """Predict each block of the time with numbers of the rest."""
        joint = self.joint
        predicted = joint.predict(fit.candidate, [self._numbers(fit.candidate, learned) for _, learned in joint.blocks])
        before, after = (float((self._white(residual) ** 2).sum()) for residual in (joint.left, joint.left - predicted))
        held_out = _fall(before, after, len(predicted))
        return replace(fit, predicted=predicted, held_out=held_out, test=self.test(predicted))

    def test(self, predicted: Values) -> PairedTest:
        """Whether what was predicted (sample,) bears out on held-out time."""
        residual = self.joint.left
        pair = residual[None, :, None], (residual - predicted)[None, :, None]
        return compare_errors(*pair, np.array([self.joint.floor or 1.0]))

    def _numbers(self, candidate: Candidate, some: NDArray[np.intp], refined: bool = True) -> dict[str, float] | None:
        """Numbers of a candidate that suit some of the samples; None where it does not act in them."""
        from scipy.optimize import minimize

        joint = self.joint
        known = np.isin(np.arange(len(joint.time)), some)
        y, late = self._white(joint.left, known), candidate.place.endswith("_delay")

        def fit(constants: Mapping[str, float]) -> tuple[float, Values]:
            columns = joint.columns(candidate, constants)
            white = self._white(columns, known)
            if late:
                return float(((y - white[:, 0]) ** 2).sum()), np.empty(0)
            if np.linalg.norm(columns[some], axis=0).min() < FLAT * max(len(some), 1):
                return np.inf, np.zeros(columns.shape[1])
            factors = np.asarray(np.linalg.lstsq(white, y, rcond=None)[0], np.float64)
            return float(((y - white @ factors) ** 2).sum()), factors

        span = float(joint.time[-1] - joint.time[0])
        rhythm = Rhythm(span, span, (len(joint.time) - 1) / span)
        starts = cells(dict(candidate.constants or {}), joint.along, rhythm)
        if late:
            starts = [{"value": float(delay)} for delay in np.linspace(-LATEST_S, LATEST_S, DELAYS)]
        scores = [fit(start)[0] for start in starts]
        best = starts[int(np.argmin(scores))]
        if not np.isfinite(min(scores)):
            return None
        if best and refined:
            names = list(best)
            grids = [np.unique([start[name] for start in starts]) for name in names]
            steps = [np.median(np.diff(grid)) if len(grid) > 1 else 0.1 * abs(grid[0]) for grid in grids]
            width = np.maximum(steps, FLAT)
            at = np.array([best[name] for name in names])
            simplex = np.vstack([at, *(at + step * np.eye(len(names))[k] for k, step in enumerate(width))])
            optimum = minimize(
                lambda x: min(fit(dict(zip(names, x, strict=True)))[0], 1e12),
                at,
                method="Nelder-Mead",
                options={"initial_simplex": simplex, "xatol": 1e-4 * width.max(), "fatol": 1e-3, "maxiter": 60},
            )
            if optimum.fun <= min(scores):
                best = dict(zip(names, map(float, optimum.x), strict=True))
        factors = fit(best)[1]
        if candidate.verdict == "wrong_parameter":
            return best if late else {"value": candidate.value + float(factors[0])}
        return dict(zip(candidate.slots, [*map(float, factors), *best.values()], strict=True))

    def _price(self, count: int) -> float:
        """What the numbers of a candidate and the choice among all cost."""
        return count * float(np.log(len(self.joint.time))) + 2 * float(np.log(max(self.open_ones, 1)))

    def _white(self, columns: Values, known: NDArray[np.bool_] | None = None) -> Values:
        """Whitened values (sample,) or columns (sample, column); 0 at samples that are not to be known, then afresh."""
        where = None if known is None else known[None, :, None]
        return self.noise.whiten(columns.reshape(1, len(columns), 1, -1), where).reshape(columns.shape)


def joint_finding(joint: ResidualMoment, candidates: tuple[Candidate, ...], joints: int = 1) -> JointFinding:
    """Weigh every candidate at one of some joints; name the best where evidence and held-out time bear it out."""
    from scipy.stats import chi2

    floor = CRITERIA.model_error * float(np.std(joint.demanded))
    finding = JointFinding(joint, _noise_of_angles(joint), len(candidates) * joints)
    size = float((finding._white(joint.left) ** 2).sum())
    finding = replace(finding, at_noise=bool(chi2.sf(size, len(joint.time)) > CHANCE / joints))
    ordered: list[Named] = []
    for _ in range(ROUNDS):
        coarse = finding.weigh(candidates, refined=False)
        best = tuple(named.candidate for named in coarse[:REFINED])
        ordered = finding.weigh(best, refined=True)
        residual = min((joint.left - named.explained for named in ordered), key=np.linalg.norm, default=joint.left)
        if np.sqrt(np.mean(residual**2)) <= finding.noise.size[0]:
            break
        finding = replace(finding, noise=find_noise(residual[None, :, None], used=2, least=floor))
    near = [named for named in ordered if named.gained > max(ordered[0].gained - CRITERIA.margin, CRITERIA.margin)]
    proven = sorted(map(finding.prove, near), key=lambda named: -named.held_out)
    alike = [named for named in proven if named.held_out > proven[0].held_out - CRITERIA.tie]  # of these the plainest
    # of two with one penalty the first in the catalogue is the simpler
    order = [candidate.identity for candidate in candidates]
    alike.sort(key=lambda named: (named.candidate.penalty(named.values), order.index(named.candidate.identity)))
    ordered = [*alike, *proven[len(alike) :], *ordered[len(near) :]]
    supported = False  # by an explanation of a size that matters, which closes enough on held-out time
    if proven:
        best, squares = ordered[0], float(np.sum((joint.left - ordered[0].predicted) ** 2))
        matters = not best.candidate.bounds or best.candidate.beyond_bounds(best.values["value"]) > 0
        supported = matters and squares < (1 - CLOSED) * float(np.sum(joint.left**2))
    return replace(finding, named=ordered[0] if supported else None, rivals=tuple(ordered))


def name_across_joints(joints: list[JointFinding], candidates: tuple[Candidate, ...]) -> list[JointFinding]:
    """Name a number that acts at several joints, as a mass does, where it leaves less than the best at each of them.

    What either answer leaves counts as white noise of unknown size; both kinds of answer are as likely beforehand.
    """
    findings, most, choice = joints, CRITERIA.margin, 2 * float(np.log(max(2 * len(candidates), 1)))
    first = [replace(joint, noise=_noise_of_angles(joint.joint)) for joint in joints]
    for candidate in candidates:
        named = _fit_across_joints(first, candidate)
        gained = -choice - float(np.log(sum(len(fit.explained) for fit in named.values())))
        before, after = 0.0, 0.0
        for k, fit in named.items():
            joint, rivals = joints[k].joint, joints[k].rivals
            rival = rivals[0].explained if rivals and rivals[0].gained > 0 else 0.0
            sizes = [max(float(np.mean((joint.left - part) ** 2)), joint.floor**2) for part in (rival, fit.explained)]
            gained += len(joint.left) / SAMPLES_A_NUMBER * float(np.log(sizes[0] / sizes[1]))
            gained += joints[k]._price(len(rivals[0].candidate.slots)) if np.any(rival) else 0.0
            before += float(np.sum((joint.left / joint.floor) ** 2))
            after += float(np.sum(((joint.left - fit.predicted) / joint.floor) ** 2))
        if gained > most and after < (1 - CLOSED) * before:
            findings, most = list(joints), gained
            for k, fit in named.items():
                shared = replace(fit, gained=gained)
                findings[k] = replace(joints[k], named=shared, rivals=(shared, *joints[k].rivals))
    return findings


def _fit_across_joints(joints: list[JointFinding], candidate: Candidate) -> dict[int, Named]:
    """Fit one number at all joints where it acts, weighed by their information, and predict each block of the time."""
    fitted = {k: fit for k, joint in enumerate(joints) if (fit := joint._fitted(candidate, refined=False))}
    weights = np.array([1 / float(fit.covariance[0, 0]) for fit in fitted.values()])

    def pool(some: NDArray[np.intp]) -> dict[str, float]:
        numbers = [(joints[k]._numbers(candidate, some, refined=False) or candidate.idle)["value"] for k in fitted]
        return {"value": float(weights @ numbers / weights.sum())}

    of_blocks = [pool(learned) for _, learned in joints[0].joint.blocks]
    mean, variance = pool(np.arange(len(joints[0].joint.time))), np.array([[1 / weights.sum()]])
    for k, fit in fitted.items():
        joint = joints[k].joint
        predicted, explained = joint.predict(candidate, of_blocks), joint.explained(candidate, mean)
        test = joints[k].test(predicted)
        fitted[k] = replace(fit, values=mean, covariance=variance, explained=explained, predicted=predicted, test=test)
    return fitted


def _noise_of_angles(joint: ResidualMoment) -> Noise:
    return find_noise(joint.angle_noise[:, :, None], least=CRITERIA.model_error * float(np.std(joint.demanded)))


def _fall(before: float, after: float, count: int) -> float:
    """Fall of twice the log likelihood of a noise whose size is fitted, and is no less than what it is taken for."""
    return count / SAMPLES_A_NUMBER * float(np.log1p(max(before - after, 0.0) / max(after, count)))
