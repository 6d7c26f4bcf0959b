"""Proof on data that were never fitted: each run's start is found, nothing else."""

from dataclasses import dataclass, replace

import numpy as np

from gaitdisc.discovery.case import LENGTHENED, Case
from gaitdisc.discovery.criteria import CRITERIA
from gaitdisc.discovery.first_states import with_own_states
from gaitdisc.discovery.input_errors import wandering, with_drawn_errors
from gaitdisc.discovery.noise import white_noise
from gaitdisc.discovery.paired_test import PairedTest, compare_errors
from gaitdisc.discovery.result import GapSize, Runs
from gaitdisc.discovery.scored_model import ScoredModel
from gaitdisc.discovery.segments import Segments
from gaitdisc.discovery.shooting import Shooting
from gaitdisc.recording.arrays import Values, root_mean_square
from gaitdisc.recording.recording import Finding

TURNS = 30
ALIKE = "the identified effect does not change the simulated motion of"
DRAWN = 20  # times, inputs with their stated errors: the mean square to some 10 % where their effects are independent


def run_trials(case: Case, model: ScoredModel, trials: tuple[int, ...], like: ScoredModel) -> ScoredModel:
    """Run a model over trials as long as another's runs, under its noise, finding nothing but the start states."""
    guess, run = case.guess, model
    for length in _lengths(like.shooting.segments.span / case.rhythm.samples):
        shooting = replace(case.shooting(case.segments(trials, length)).with_noise(like.noise), past=guess)
        run = _start_runs(shooting, model, guess)
        guess = shooting.segments.put(guess, run.fit.states)
    return run


def free_run_error(case: Case, model: ScoredModel) -> float:
    """Mean square that free runs of the held-out trials err by, over each channel's variance."""
    return free_runs(case, model)[0]


def free_runs(case: Case, model: ScoredModel) -> tuple[float, float]:
    """Return what free runs of the held-out trials err by, and what the doubt about starts and inputs makes of it.

    A run begins with what its first samples say, a period or a third of the trial, and errs over the others: a start
    that is fitted to the whole run absorbs an offset. A run that has left the data errs by `lost`.

    returns: mean squares, over each channel's variance
    """
    scale, errors = case.scale, []
    for trial in case.held_out:
        begun = begin_by_first_samples(case, model, trial)
        shooting, segments = begun.shooting, begun.shooting.segments
        fit = shooting.at(model.machine, (), begun.fit.values, begun.fit.starts)
        error = np.where(np.isfinite(fit.residual), (fit.residual / scale.spread) ** 2, CRITERIA.lost)
        slopes = np.nan_to_num(fit.slopes.reshape(*fit.residual.shape, -1))
        first = count_first_samples(case, segments)
        late = (segments.samples[:, segments.compared] >= first)[..., None] & shooting.known
        early = slopes[~late & shooting.known]
        start = np.einsum("...i,ij,...j", slopes, np.linalg.pinv(early.T @ early), slopes)
        moved = np.zeros_like(fit.residual)  # mean square that the stated errors of inputs move the run by
        for seed in range(DRAWN if wandering(case.search.base) else 0):
            drawn = with_drawn_errors(case.measured, case.search.base, seed)
            _, there = replace(shooting, measured=drawn).run(model.machine, fit.starts[None], fit.values[None])
            moved += (shooting.seen - fit.residual - there[0]) ** 2 / DRAWN
        doubt = start * (scale.size / scale.spread) ** 2 + moved / scale.spread**2
        errors.append([np.fmin(error, CRITERIA.lost)[late].mean(), np.fmin(doubt, CRITERIA.lost)[late].mean()])
    error, doubt = np.mean(errors, axis=0)
    return float(error), float(doubt)


def begin_by_first_samples(case: Case, model: ScoredModel, trial: int) -> ScoredModel:
    """Find the start of a whole trial, as one run, by its first samples alone."""
    periods = int(case.measured.drive.samples[trial]) / case.rhythm.samples
    shooting = case.shooting(case.segments((trial,), periods)).with_noise(white_noise(case.scale.size))
    seen = case.measured.observed.copy()
    seen[trial, count_first_samples(case, shooting.segments) :] = np.nan
    begun = replace(shooting, measured=replace(case.measured, observed=seen))
    return replace(_start_runs(begun, model, case.guess), shooting=shooting)


def count_first_samples(case: Case, trial: Segments) -> int:
    """Return the samples of a trial, cut as one run, that say where it begins: a period, or a third of it."""
    samples = int(case.measured.drive.samples[trial.trial[0]])
    return trial.margin + max(min(round(case.rhythm.samples), samples // 3), 1)


def strays(case: Case, model: ScoredModel, before: float) -> bool:
    """Whether free runs of held-out trials err more than as read, and than noise, model error and start explain."""
    (error, doubt), scale = free_runs(case, model), case.scale
    least = float(np.mean((scale.size / scale.spread) ** 2))
    return error > max(before, CRITERIA.grown**2 * (least + doubt))


def grows_along_runs(case: Case, model: ScoredModel) -> bool:
    """Whether free runs of unseen data err clearly more than the short runs that a model was fitted to.

    What a sensor's noise leaves, also one that remembers, is as large in a long run as in a short one, but for the
    doubt about the start; what is missing in the dynamics adds up. A simulation is granted a hundredth of the spread.
    What leaves half of the variance beyond the noise describes nothing, however long the runs. Where a small change of
    the start grows, free runs say nothing.
    """
    if not case.spans_a_period(model):
        return False
    (error, doubt), scale = free_runs(case, model), case.scale
    short = max(scale.relative(model.fit), CRITERIA.model_error) ** 2
    noise = float(np.mean((case.noise_floor(model.noise.size) / scale.spread) ** 2))
    return error > min(CRITERIA.grown**2 * (short + doubt), CRITERIA.half + noise + doubt)


def is_uninformative(case: Case, as_read: ScoredModel, model: ScoredModel) -> bool:
    """Whether the held-out data can say nothing for or against what the others speak for.

    A spring that engages beyond where a trial goes changes nothing in it. What counts is how far the two runs are
    apart, never which of them the measurement prefers.
    """
    if not model.parts or model.gained < CRITERIA.support:
        return False
    return _apart(case, as_read, model, case.held_out) <= CRITERIA.support and bool(_informative(case, as_read, model))


def holding_out_others(case: Case, as_read: ScoredModel, model: ScoredModel) -> Case:
    """Return the case with other trials held out: the last of those that are informative."""
    held = _informative(case, as_read, model)[-len(case.held_out) :]
    learned = tuple(sorted({*case.learned, *case.held_out} - {*held}))
    return replace(case, learned=learned, held_out=held)


def noting_alike(case: Case) -> Case:
    """Return a case with a finding that says that the held-out data do not show what the others speak for."""
    blind = " and ".join(f"trial {case.measured.trials[trial]}" for trial in case.held_out)
    what = f"{ALIKE} {blind}; only the other trials show the effect"
    spoils = "the test on these data, where the effect does not act"
    return case.noting(Finding("note", "held out", case.measured.source, what, spoils))


def noted(before: Case, after: Case, why: str = ALIKE) -> Case:
    """Return a case with a finding that says what is held out in place of what, and why."""
    held = ([f"trial {case.measured.trials[trial]}" for trial in case.held_out] for case in (before, after))
    what = "{} {}; the search held out {} instead".format(why, *map(" and ".join, held))
    finding = Finding("note", "held out", after.measured.source, what, "nothing; by default the last trial is held out")
    return after.noting(finding)


def _informative(case: Case, as_read: ScoredModel, model: ScoredModel) -> tuple[int, ...]:
    """Return the learned trials on which the two runs are apart."""
    return tuple(trial for trial in case.learned if _apart(case, as_read, model, (trial,)) > CRITERIA.support)


def _apart(case: Case, as_read: ScoredModel, model: ScoredModel, trials: tuple[int, ...]) -> float:
    """Return by how much the misfit would fall on trials if what was found were true: how far the runs are apart."""
    before, after = (run_trials(case, version, trials, model) for version in (as_read, model))
    return float(((before.fit.white - after.fit.white) ** 2).sum())


def _start_runs(shooting: Shooting, model: ScoredModel, guess: Values) -> ScoredModel:
    """Return a model run from the start states that suit it best, near a guess, its constants as they are."""
    machine, values = model.machine, model.fit.values
    starts = with_own_states(shooting, machine, values, shooting.segments.starts(guess))
    return replace(model, shooting=shooting, fit=shooting.fitted(machine, (), values, starts, TURNS))


def _lengths(periods: float) -> list[float]:
    """Lengths of runs up to the wanted one, each at most `LENGTHENED` times the one before.

    The start of a long run is found near that of a short one; from a rough guess its search may end elsewhere.

    >>> _lengths(4.5), _lengths(0.4)
    ([0.5, 1.5, 4.5], [0.4])
    """
    lengths = [periods]
    while lengths[0] > 1:
        lengths.insert(0, lengths[0] / LENGTHENED)
    return lengths


@dataclass(frozen=True)
class Proof:
    """Held-out runs of two models, and whether the second is better by more than chance."""

    before: ScoredModel  # the same runs without
    after: ScoredModel  # and with what is to be borne out
    test: PairedTest

    @property
    def bears_out(self) -> bool:
        """Whether the plain error falls by more than chance, and the misfit under autocorrelated noise as well."""
        return self.test.bears_out and self.gained > 0

    @property
    def gained(self) -> float:
        """Fall of the misfit under autocorrelated noise."""
        return float(np.nan_to_num(self.before.fit.misfits - self.after.fit.misfits, nan=0.0).sum())

    @property
    def closed(self) -> float:
        """Share of the plain squared error that goes, each channel over its spread."""
        spread = np.nanstd(self.before.shooting.seen, axis=(0, 1))
        before, after = (np.nanmean((model.fit.residual / spread) ** 2) for model in (self.before, self.after))
        return float(1 - after / before)


def prove(
    case: Case, before: ScoredModel, after: ScoredModel, like: ScoredModel, trials: tuple[int, ...] = ()
) -> Proof:
    """Run two models over trials, by default those held out, and test what they err by."""
    first, second = (run_trials(case, model, trials or case.held_out, like) for model in (before, after))
    return Proof(first, second, compare_runs(case, first, second, like))


def compare_runs(case: Case, before: ScoredModel, after: ScoredModel, like: ScoredModel) -> PairedTest:
    """Test whether the same runs of two models err less in the second."""
    return replace(compare_errors(before.fit.residual, after.fit.residual, like.noise.size), alpha=case.alpha)


def gap_size(case: Case, proof: Proof, like: ScoredModel) -> GapSize:
    """Measure the gap before and after, against the sensors' noise, by that of a model where it is not known."""
    spread, floor = np.nanstd(proof.after.shooting.seen, axis=(0, 1)), case.noise_floor(like.noise.size)
    rms = [root_mean_square(model.fit.residual) for model in (proof.before, proof.after)]
    names, test = case.measured.channels, proof.test
    sizes = {name: (float(rms[0][i]), float(rms[1][i]), float(floor[i])) for i, name in enumerate(names)}
    overall = [float(np.sqrt(np.mean((error / spread) ** 2))) for error in (*rms, floor)]
    return GapSize(overall[0], overall[1], overall[2], test.p, sizes, test.pieces, alpha=test.alpha)


def tabulate_runs(case: Case, before: ScoredModel, after: ScoredModel) -> Runs:
    """Return the runs as a report draws them."""
    segments, drive, seen = before.shooting.segments, case.measured.drive, before.shooting.seen
    names = [signal.name for signal in case.search.base.inputs]
    phase = segments.of(drive.inputs)[:, :, names.index("phase")] if "phase" in names else np.zeros((len(segments), 0))
    return Runs(
        segments.trial,
        segments.times(drive)[:, segments.compared],
        phase[:, segments.compared],
        seen,
        seen - before.fit.residual,
        seen - after.fit.residual,
        names=case.measured.trials,
    )
