"""Models weighed where inputs err as stated: what they leave, under the covariance that such errors make of it.

To first order the errors enter where the input stands. The covariance is each model's own, so that one that hardly
uses an input has no excuse by its errors. Numbers are estimated anew by what is left so (weighted orthogonal
distances): else an input's errors pull its factors towards 0, and whatever goes along with it takes over.
Where none is stated, models are compared by restricted likelihood with errors of the likeliest size and memory.
Source: Fuller 1987, Measurement Error Models; Boggs and Rogers 1990, Contemporary Mathematics 112, 183.
"""

from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from gaitdisc.discovery.candidate import UNNAMED
from gaitdisc.discovery.case import FEWEST_SAMPLES, Case
from gaitdisc.discovery.criteria import CRITERIA
from gaitdisc.discovery.decision import Verdict
from gaitdisc.discovery.effect_words import spoken
from gaitdisc.discovery.fitted import find_basis, without
from gaitdisc.discovery.held_out import Proof, prove
from gaitdisc.discovery.input_errors import wandering
from gaitdisc.discovery.linearised import carry_change, linearise, propagate_push
from gaitdisc.discovery.noise import white_noise
from gaitdisc.discovery.paired_test import PairedTest, errors_rise_p
from gaitdisc.discovery.places import Place
from gaitdisc.discovery.process_noise import MOST_NUMBERS, sensor_covariance
from gaitdisc.discovery.scored_model import Part, ScoredModel
from gaitdisc.discovery.search import is_certain
from gaitdisc.discovery.shooting import Shooting
from gaitdisc.recording import Finding
from gaitdisc.recording.arrays import Values
from gaitdisc.words import listing

PIECES = 12  # of held-out runs: their squares are all but independent under the covariance
RIVALS = 3
TURNS = 6
NUDGE = 0.1  # standard errors
ENOUGH = 0.1  # off the squares, a tenth of what one number of noise leaves
HALVED = (1.0, 0.5, 0.25, 0.1)  # of a step that leaves more
SHARES = (0.0, 0.02, 0.05, 0.1, 0.15, 0.25, 0.4)  # of an input and of its spread, by which it may err unsaid
PERIODS = (1.0, 4.0, 16.0)  # in which such an error is forgotten
KNOTS_EACH, KNOTS = 4, (8, 60)  # in a period, and in a run: between these such an error is linear
RUNS = 24  # at most, over which such errors are weighed


@dataclass(frozen=True)
class Weighed:
    """A model whose numbers were estimated under the stated errors of inputs."""

    now: ScoredModel
    learned: Values  # (run, sample, channel), what it leaves, as independent numbers of unit size
    held_out: Values  # (run, sample, channel), the same where nothing but starts was fitted
    plain: float  # mean square error there, over each channel's noise

    @property
    def squares(self) -> float:
        """Sum of squares of what it was fitted to, and of the prior."""
        fit = self.now.fit
        return float((self.learned**2).sum() + (fit.prior.left(fit.values) ** 2).sum())

    @property
    def criterion(self) -> float:
        """Information criterion (BIC) at the stated size of the errors."""
        return self.squares + self.now.size * float(np.log(self.learned.size))

    @property
    def level(self) -> float:
        """How many times the stated errors it leaves, in variance."""
        return self.squares / (self.learned != 0).sum()


def weigh_input_errors(case: Case, verdict: Verdict) -> tuple[Case, Verdict]:
    """Return a verdict without what the stated errors of inputs explain as well, its numbers with their doubt."""
    erring = [repr(signal.name) for _, signal in wandering(case.search.base)]
    if not erring or verdict.starts:
        return case, verdict
    best = likeliest(case, verdict)
    if verdict.process_noise and best.level > CRITERIA.mere_noise:
        return case, verdict
    model, proof = beyond_errors(case, best)
    verdict, dropped = without_names(replace(verdict, proof=proof or verdict.proof), best.now, model)
    what = f"the stated errors of {listing(erring)} explain {dropped} as well"
    finding = Finding("note", "stated errors", case.measured.source, what, "the effect, which is no longer named")
    return case.noting(finding) if dropped else case, verdict


def without_names(verdict: Verdict, named: ScoredModel, model: ScoredModel) -> tuple[Verdict, str]:
    """Return the verdict on a model that names less than another, and what it does not name, in words."""
    lost = Counter(named.labels) - Counter(model.labels)
    dropped = ["process noise"] * bool(verdict.process_noise)
    dropped += [f"{spoken(name)} at {place}" for name, _, place in (label.partition("@") for label in lost.elements())]
    same = model.labels == verdict.found.labels
    rivals, reads_as = (verdict.rivals, verdict.reads_as) if same else ((verdict.found, *verdict.rivals), None)
    verdict = replace(verdict, found=model, rivals=rivals, reads_as=reads_as, process_noise=None)
    return verdict, listing(dropped) if dropped else ""


def likeliest(case: Case, verdict: Verdict) -> Weighed:
    """Return what was found, weighed; or a rival of random pushes or of a shape without a name, which absorb errors."""
    # as many numbers as a covariance can be made of
    fitted = cut_short(case, verdict.found, max(MOST_NUMBERS // len(case.measured.channels), FEWEST_SAMPLES))
    tried = [rival.parts for rival in verdict.rivals[:RIVALS]]
    tried += [
        (Part(candidate, part.values),)  # what a shape reads as
        for part in fitted.parts
        for candidate in case.search.candidates
        if (candidate.name, candidate.place, candidate.pieces)
        == (verdict.reads_as, part.candidate.place, part.candidate.pieces)
    ]
    tried = tried if verdict.process_noise or verdict.word == UNNAMED else []
    models = [case.search.with_others(fitted, parts) for parts in tried]
    models = [model for model in models if case.search.sensible(model)]
    ordered = sorted((weighed(case, model) for model in (fitted, *models)), key=lambda model: model.criterion)
    named = [result for result in ordered if result.now.parts and result.now.word != UNNAMED]
    return next((result for result in named if result.criterion < ordered[0].criterion + CRITERIA.tie), ordered[0])


def cut_short(case: Case, model: ScoredModel, samples: int) -> ScoredModel:
    """Return a model fitted to runs of no more samples."""
    if model.shooting.segments.span <= samples:
        return model
    short = case.fit_over(samples, model, model.noise)
    return replace(short.with_own_past(), gained=model.gained)


def beyond_errors(case: Case, best: Weighed) -> tuple[ScoredModel, Proof | None]:
    """Return a model less what is not borne out: each beside the others; all halve what exceeds the stated errors."""
    base, proof = weighed(case, case.search.with_others(best.now, ())), None
    while best.now.parts:
        parts = range(len(best.now.parts))
        fewer = [weighed(case, case.search.without(best.now, number)) for number in parts] if len(parts) > 1 else [base]
        tests = [tested(case, model, best) for model in (*fewer, base)]
        proof = replace(prove(case, base.now, best.now, best.now), test=tests[-1])
        excess = float((base.held_out**2).sum()) - (base.held_out != 0).sum()  # beyond the stated errors
        if tests[-1].fall >= CRITERIA.half * excess and all(test.bears_out for test in tests):
            break
        best = fewer[int(np.argmax([test.p for test in tests[:-1]]))]
    return best.now, proof


def tested(case: Case, before: Weighed, after: Weighed) -> PairedTest:
    """Test whether a model leaves less than another by more than chance, also of what it was not fitted to.

    returns: of the held-out runs; p is 1 where the runs that it was fitted to say less than the criterion's margin,
        where a number could as well be idle, or where the plain error rises: a model in which errors of inputs grow
        beyond measure explains anything
    """
    pieces = -(-PIECES // len(after.held_out))
    squares = [
        np.array([(part**2).sum() for run in result.held_out for part in np.array_split(run, pieces)])
        for result in (after, before)
    ]
    numbers = after.now.size - before.now.size
    gained = (before.squares - after.squares) / max(after.level, 1.0) - numbers * np.log(after.learned.size)
    worth = gained > CRITERIA.margin and after.plain < before.plain and is_certain(after.now)
    p, fall = errors_rise_p(*squares) if worth else 1.0, float((squares[1] - squares[0]).sum())
    return PairedTest(p, len(squares[0]), fall, case.alpha)


def weighed(case: Case, model: ScoredModel) -> Weighed:
    """Estimate a model's numbers under the stated errors of inputs (Gauss-Newton), and weigh what it leaves."""
    fit = model.fit
    size = case.noise_floor(model.noise.size)
    whiten = whitener(case, model, model.shooting, fit.starts, size)

    def rows(values: Values) -> Values:
        return np.concatenate([whiten(values).ravel(), fit.prior.left(values)])

    columns = [model.machine.parameters.index(name) for name in fit.free]
    error = np.sqrt(np.abs(np.diag(fit.covariance)))
    steps = NUDGE * np.where(error > 0, error, 1.0)
    values, here, slopes = fit.values, rows(fit.values), np.zeros((0, 0))
    for _ in range(TURNS if columns else 0):
        nudged = np.repeat(values[None], len(columns), axis=0)
        nudged[range(len(columns)), columns] += steps
        slopes = (np.array([rows(numbers) for numbers in nudged]) - here).T / steps
        move = np.zeros(len(values))
        move[columns] = -np.linalg.lstsq(slopes, here, rcond=None)[0]
        tried = (fit.prior.within(values + share * move) for share in HALVED)
        tried = (numbers for numbers in tried if case.search.sensible(model.with_estimates(numbers, fit.covariance)))
        better = next(
            ((numbers, left_over) for numbers in tried if ((left_over := rows(numbers)) ** 2).sum() < (here**2).sum()),
            None,
        )
        if better is None:
            break
        gained, (values, here) = (here**2).sum() - (better[1] ** 2).sum(), better
        if gained < ENOUGH:
            break
    level = max(float((here**2).sum()) / max(int((here != 0).sum()), 1), 1.0)
    model = model.with_estimates(values, np.asarray(level * np.linalg.pinv(slopes.T @ slopes), float))
    held = prove(case, model, model, model).after
    shooting = replace(case.shooting(held.shooting.segments), past=model.shooting.past)
    unseen = whitener(case, model, shooting, held.fit.starts, size)(values)
    return Weighed(model, whiten(values), unseen, float(np.nanmean((held.fit.residual / size) ** 2)))


def whitener(
    case: Case, model: ScoredModel, shooting: Shooting, starts: Values, size: Values
) -> Callable[[Values], Values]:
    """Return what gives, for values of all parameters, what a model leaves of runs, as independent numbers."""
    shooting = shooting.with_noise(white_noise(np.ones(len(size))))
    known = shooting.known
    sizes = np.tile(size, known.shape[1])
    sensors = sensor_covariance(shooting, known) * sizes[:, None] * sizes
    measured = known.reshape(len(known), -1)

    def whiten(values: Values) -> Values:
        fit = shooting.at(model.machine, (), values, starts)
        inputs = covariance_by_inputs(case, replace(model, shooting=shooting, fit=fit))
        inputs = inputs * measured[:, :, None] * measured[:, None]
        columns = np.concatenate([np.nan_to_num(fit.residual).reshape(*measured.shape, 1), fit.slopes], axis=2)
        white = np.asarray(np.linalg.solve(np.linalg.cholesky(sensors + inputs), columns), np.float64)
        return without(find_basis(white[..., 1:]), white[..., :1]).reshape(known.shape)

    return whiten


def covariance_by_inputs(case: Case, model: ScoredModel) -> Values:
    """Return the covariance that the stated errors of inputs make in what is seen (run, number, number)."""
    erring, segments = wandering(case.search.base), model.shooting.segments
    late = np.abs(np.subtract.outer(*2 * [np.arange(segments.length)])) / case.measured.rate
    moved = propagate_inputs(model, [signal.name for _, signal in erring], np.eye(segments.length))
    total = np.zeros((len(segments), *2 * [model.fit.residual[0].size]))
    for seen, (column, signal) in zip(moved, erring, strict=True):
        flat = seen.reshape(len(segments), -1, segments.length)
        memory = np.exp(-late / (signal.wander or np.inf))
        # averaged, as else what reads low errs less and its factor is too large (by 17-21 % where it errs by 25 %)
        driven = segments.of(case.measured.drive.inputs)[..., column]
        along = (signal.gain or 0.0) * (driven @ memory) / memory.sum(axis=0)
        covariance = ((signal.sd or 0.0) ** 2 + along[:, :, None] * along[:, None]) * memory
        total += flat @ covariance @ np.swapaxes(flat, 1, 2)
    return total


def propagate_inputs(model: ScoredModel, names: list[str], hats: Values) -> list[Values]:
    """Return what errors of inputs, by hats (sample, knot), change in what is seen (run, sample, channel, knot)."""
    places = tuple(Place("input", name, (), (), (), False) for name in names)
    line, direct = linearise(model, places), propagate_push(model, places)
    push, moved = np.broadcast_to(hats, (len(model.fit.starts), *hats.shape)), []
    for number in range(len(places)):
        seen = carry_change(model, line.of_push(number, push))
        moved.append(seen + model.shooting.filtered(direct[:, :, :, number, None] * hats[:, None, :], 1))
    return moved


def weigh_unstated_errors(case: Case, verdict: Verdict) -> tuple[Case, Verdict]:
    """Return a verdict without each name that errors of inputs of unknown size explain as well: gains and wanders."""
    named, search = verdict.found, case.search
    erring = [signal.name for signal in search.base.driving if not (signal.sd or signal.gain or signal.wraps)]
    if not erring or not names_in(named):
        return case, verdict
    reduced = cut_short(case, named, round(case.rhythm.samples))  # along long runs such errors are not linear
    best, fitted = beside_errors(case, reduced, erring)
    while names := names_in(reduced):
        fewer = [search.without(reduced, number) for number in names]
        tried = [(*beside_errors(case, model, erring), model) for model in fewer]
        least, gained, less = min(tried, key=lambda attempt: attempt[0])
        if least - best > CRITERIA.margin:
            break
        best, fitted, reduced = min(least, best), gained, less
    if len(reduced.parts) == len(named.parts):
        return case, verdict
    fitted = case.lengthen(fitted)
    bare = search.with_others(fitted, ())
    proof = prove(case, bare, fitted, fitted)
    fitted = fitted if proof.bears_out else bare
    # errors that wander are others on unseen data: what takes half of these, and no gain takes as well, is none of them
    if not fitted.parts and verdict.proof and verdict.proof.closed > CRITERIA.half:
        return case, verdict
    verdict, dropped = without_names(replace(verdict, proof=proof), named, fitted)
    what = f"unstated errors of {listing([repr(name) for name in erring])} explain {dropped} as well"
    finding = Finding("note", "unstated errors", case.measured.source, what, "the effect, which is no longer named")
    return case.noting(finding), verdict


def names_in(model: ScoredModel) -> list[int]:
    """Return which of a model's explanations are no errors of inputs."""
    return [number for number, part in enumerate(model.parts) if part.candidate.verdict != "input_error"]


def beside_errors(case: Case, model: ScoredModel, erring: list[str]) -> tuple[float, ScoredModel]:
    """Return the criterion of a model whose inputs err, and the model, with their gains where these are evident."""
    search = case.search
    gains = [gain for gain in search.open_beside(model) if gain.name == "input_gain" and gain.place in erring]
    parts = (*model.parts, *(Part(gain, {"gain": 1.0}) for gain in gains))
    plain, gained = criterion_with_errors(case, model, erring), search.with_others(model, parts)
    beside = criterion_with_errors(case, gained, erring) if search.sensible(gained) else np.inf
    return min(plain, beside), gained if plain - beside > CRITERIA.margin else model


def criterion_with_errors(case: Case, model: ScoredModel, erring: list[str]) -> float:
    """Return the information criterion of a model whose inputs err, by the size and memory that are likeliest."""
    fit, names, period = model.fit, [signal.name for signal in case.search.base.inputs], case.rhythm.samples
    some = np.unique(np.linspace(0, len(model.shooting.segments) - 1, RUNS).astype(int))
    segments = model.shooting.segments.among(some)
    noise = white_noise(case.noise_floor(model.noise.size))
    shooting = replace(model.shooting, segments=segments, prior=fit.prior).with_noise(noise)
    fit = shooting.at(model.machine, fit.free, fit.values, fit.starts[some])
    at = np.linspace(0, segments.length - 1, int(np.clip(KNOTS_EACH * segments.length / period, *KNOTS)))
    hats = np.array([np.interp(np.arange(segments.length), at, knot) for knot in np.eye(len(at))]).T
    driven = segments.of(case.measured.drive.inputs)[:, at.round().astype(int)]
    errors = propagate_inputs(replace(model, shooting=shooting, fit=fit), erring, hats)
    moved = [shooting.whiten(error) for error in errors]
    pairs = [(move, driven[..., names.index(name)]) for move, name in zip(moved, erring, strict=True)]
    numbers, best = int(shooting.known.sum()) - fit.starts.size, np.inf
    for periods in PERIODS:
        wander = np.linalg.cholesky(np.exp(-np.abs(np.subtract.outer(at, at)) / (periods * period)))
        gains, wanders = zip(*((move @ run[..., None], run.std() * move @ wander) for move, run in pairs), strict=True)
        beside = fit.beside(np.concatenate([*gains, *wanders], axis=2))
        best = min(best, *(beside.likelihood(share**2, numbers, least=1.0)[0] for share in SHARES))
    return best + model.size * float(np.log(numbers))
