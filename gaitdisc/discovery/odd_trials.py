"""Odd trials: one whose sign is turned, or that is shifted in time, against its inputs and its other channels.

The simulation, as read and then with what was found, is run from each trial, its start free every period. However wrong
it is, a record with its sign turned or its time shifted goes with it worse still. A trial that goes with it much better
so (shifted, about as well as the others do), while the others go worse, was recorded otherwise than they were.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from gaitdisc.discovery.case import FEWEST_SAMPLES, MOST_SEARCHED, Case
from gaitdisc.discovery.criteria import CRITERIA
from gaitdisc.discovery.first_states import guess_states
from gaitdisc.discovery.fitted import find_basis, without
from gaitdisc.discovery.noise import white_noise
from gaitdisc.discovery.places import kinematic_rates
from gaitdisc.discovery.result import ODD_TRIAL
from gaitdisc.discovery.scored_model import ScoredModel, fit_model, leaves
from gaitdisc.discovery.segments import cut_segments
from gaitdisc.discovery.shooting import Shooting
from gaitdisc.recording import Finding
from gaitdisc.recording.arrays import Values
from gaitdisc.simulation.compiled_simulation import Drive
from gaitdisc.simulation.measured import Measured

SIGN = "the sign of "
FEWEST_OTHERS = 2
PROMISING = 0.5  # of the mean square, to first order, that a shift has to leave at most for it to be tried
SHIFTS_TRIED = 3  # of each trial
SMALLEST_SHIFT = 2  # samples
LONGEST_SHIFT = 1.0  # periods of the motion
AS_GOOD = 1.1  # times the least error; of changes that serve alike, the first is named
FEWEST_TRIALS, MOST_TRIALS = 4, 8


@dataclass(frozen=True)
class Odd:
    """A trial that goes with the simulation only once it is changed, while the others go worse."""

    trial: int
    change: str  # what is to be done to it, in words: `the sign of x is turned`
    channel: str  # the channel or input that is meant; empty where all are
    # of the trial as it is and once changed, of the others (median) as they are and if changed alike; in standard
    # deviations of the channels
    errors: tuple[float, float, float, float]


def agreeing_trials(case: Case, measured: Measured) -> Measured:
    """Return the trials, if three or more, without those turned in sign or shifted in time, each with a finding."""
    outliers = odd_trials(case) if len(measured.trials) > FEWEST_OTHERS else ()
    if not outliers:
        return measured
    source = measured.source or case.search.base.title
    findings = tuple(
        Finding(
            "warning",
            ODD_TRIAL,
            source,
            f"trial {measured.trials[odd.trial]!r} looks as if {odd.change}. With this correction, the error of the "
            f"simulation falls from {odd.errors[0]:.2g} to {odd.errors[1]:.2g} standard deviations. In the other "
            f"trials the same correction raises the error from {odd.errors[2]:.2g} to {odd.errors[3]:.2g}",
            "this trial, which was left out; correct or remove it",
            odd.channel,
        )
        for odd in outliers
    )
    agreeing = measured.selected(sorted(set(range(len(measured.trials))) - {odd.trial for odd in outliers}))
    return replace(agreeing, findings=(*agreeing.findings, *findings))


def odd_trials(case: Case) -> tuple[Odd, ...]:
    """Find the trials that are turned in sign or shifted in time."""
    count = len(case.measured.trials)
    samples = max(int(case.predictable_periods() * case.rhythm.samples), FEWEST_SAMPLES)
    as_read = fit_trials(case, case.measured, samples)
    before = trial_errors(as_read)
    suspects: dict[int, list[Odd]] = {}
    for change, channel, measured in (*_turn(case), *_shift(case, as_read)):
        after = trial_errors(fit_trials(case, measured, samples))
        for trial in range(count):
            others_before, others_after = (float(np.median(np.delete(error, trial))) for error in (before, after))
            errors = (float(before[trial]), float(after[trial]), others_before, others_after)
            likely = change.startswith(SIGN) or errors[1] < CRITERIA.apart * errors[2]
            if CRITERIA.apart * errors[1] < errors[0] and errors[3] > CRITERIA.unlike * errors[2] and likely:
                suspects.setdefault(trial, []).append(Odd(trial, change, channel, errors))
    clear = count - len(suspects) >= max(FEWEST_OTHERS, len(suspects) + 1)
    return tuple(_either(suspects[trial]) for trial in sorted(suspects)) if clear else ()


def _either(changes: list[Odd]) -> Odd:
    """What suits a trial best, with what else would serve alike; of the shifts in time the best alone."""
    least = min(odd.errors[1] for odd in changes)
    alike = [odd for odd in changes if odd.errors[1] <= AS_GOOD * least]
    shifted = sorted((odd for odd in alike if not odd.change.startswith(SIGN)), key=lambda odd: odd.errors[1])
    turned = [odd for odd in alike if odd.change.startswith(SIGN)]
    names = " or of ".join(odd.change.removeprefix(SIGN) for odd in turned)
    words = ([f"{SIGN}{names} were reversed"] if turned else []) + [odd.change for odd in shifted[:1]]
    return replace([*turned, *shifted][0], change=", or ".join(words))


def fit_trials(case: Case, measured: Measured, samples: int) -> ScoredModel:
    """Fit the start states of the simulation as read to runs of so many samples, over all trials."""
    simulation = case.search.base
    guess = guess_states(simulation, measured, case.rhythm.period, kinematic_rates(simulation))
    segments = cut_segments(measured.samples, tuple(range(len(measured.trials))), samples).spread(MOST_SEARCHED)
    spread = white_noise(np.nanstd(case.measured.observed, axis=(0, 1)))
    shooting = Shooting(measured, segments, spread, case.substeps, guess)
    return fit_model(shooting, simulation, (), segments.starts(guess))


def trial_errors(model: ScoredModel) -> Values:
    """Root mean square of what is left of each trial [standard deviations]; infinite where a run failed."""
    square = (model.fit.residual / model.noise.size) ** 2
    square[~np.isfinite(model.fit.white).all(axis=1)] = np.inf
    trials = model.shooting.segments.trial
    return np.sqrt([np.nanmean(square[trials == trial]) for trial in np.unique(trials)])


def _turn(case: Case) -> Iterator[tuple[str, str, Measured]]:
    """Yield the trials with the sign of a channel, of all channels, or of an input turned: words, which, trials."""
    measured, inputs = case.measured, case.search.base.inputs
    for number, name in enumerate(measured.channels):
        observed = measured.observed * np.where(np.arange(len(measured.channels)) == number, -1.0, 1.0)
        yield f"{SIGN}{name}", name, replace(measured, observed=observed)
    if len(measured.channels) > 1:
        yield f"{SIGN}every channel", "", replace(measured, observed=-measured.observed)
    for number, part in enumerate(inputs):
        if not part.wraps and not part.computed:
            signs = np.where(np.arange(len(inputs)) == number, -1.0, 1.0)
            drive = replace(measured.drive, inputs=measured.drive.inputs * signs)
            yield f"{SIGN}{part.name}", part.name, replace(measured, drive=drive)


def _shift(case: Case, as_read: ScoredModel) -> Iterator[tuple[str, str, Measured]]:
    """Yield the trials with all channels shifted against the inputs, by what serves one of them, as `_turn` does."""
    if not case.search.base.driving:  # a system that is left to itself has no clock to be shifted against
        return
    measured, fit, segments, spread = case.measured, as_read.fit, as_read.shooting.segments, as_read.noise.size
    most = min(int(LONGEST_SHIFT * case.rhythm.samples), int(measured.samples.min()) // 3)
    shifts = [shift for shift in range(-most, most + 1) if abs(shift) >= SMALLEST_SHIFT]
    likely = set()
    for trial in range(len(measured.trials)):
        mine = np.flatnonzero(segments.trial == trial)
        seen = measured.observed[trial, : measured.samples[trial]] / spread
        run = segments.of(measured.observed)[mine] / spread - fit.residual[mine] / spread
        slopes, begin = fit.slopes[mine], segments.begin[mine]
        plain, *errors = (_left(seen, run, slopes, begin + shift) for shift in (0, *shifts))
        padded = np.array([np.inf, *errors, np.inf])  # local minima, the least first
        lowest = np.flatnonzero((padded[1:-1] <= padded[:-2]) & (padded[1:-1] <= padded[2:]))
        promising = [k for k in sorted(lowest.tolist(), key=lambda k: errors[k]) if errors[k] < PROMISING * plain]
        likely |= {shifts[place] for place in promising[:SHIFTS_TRIED]}
    for shift in sorted(likely):
        words = f"its channels are {abs(shift) / measured.rate:.3g} s too {'late' if shift > 0 else 'early'}"
        yield f"{words} for its inputs", "", shift_channels(measured, shift)


def shift_channels(measured: Measured, shift: int) -> Measured:
    """Return trials whose channels come a number of samples earlier against their inputs; each loses as many."""
    inputs, seen = max(-shift, 0), max(shift, 0)
    trials = [(trial, int(samples) - abs(shift)) for trial, samples in enumerate(measured.samples)]
    driving = [measured.drive.inputs[trial, inputs : inputs + samples] for trial, samples in trials]
    drive = Drive.of(driving, measured.rate, measured.drive.time0 + inputs / measured.rate)
    observed = np.full((len(trials), int(drive.samples.max()), len(measured.channels)), np.nan)
    for trial, samples in trials:
        observed[trial, :samples] = measured.observed[trial, seen : seen + samples]
    return replace(measured, drive=drive, observed=observed)


def _left(seen: Values, run: Values, slopes: Values, begin: NDArray[np.intp]) -> float:
    """Mean square of what another stretch of the record leaves of a run, its start free to first order."""
    samples = begin[:, None] + np.arange(run.shape[1])
    inside = (samples >= 0) & (samples < len(seen))
    residual = np.where(inside[..., None], seen[np.clip(samples, 0, len(seen) - 1)] - run, 0.0)
    flat = np.nan_to_num(residual).reshape(len(begin), -1)
    mask = np.repeat(inside, run.shape[2], axis=1)
    rest = without(find_basis(slopes * mask[..., None]), flat[..., None])[..., 0]
    return float((rest**2).sum() / max(mask.sum(), 1))


def without_trial_apart(case: Case) -> Measured:
    """Return the trials without the one that goes with no explanation of the others, with a finding.

    The simulation as read is fitted to all trials. What the best single explanation would leave of all but one of them
    follows from its slopes, to first order, for each trial in turn: this finds the one to suspect. The others are then
    searched without it, and for comparison without the next.

    returns: the trials as they were where none stands apart, or there are too few or too many to say
    """
    measured = case.measured
    count = len(measured.trials)
    if not FEWEST_TRIALS <= count <= MOST_TRIALS:
        return measured
    spread = np.nanstd(measured.observed, axis=(0, 1))
    as_read = replace(case, learned=tuple(range(count))).as_read()
    search = case.search
    promised = search.scorer(as_read).leave_out_each(search.open_beside(as_read))  # to first order
    trial, other = np.argsort(promised)[:2].tolist()
    least = _leave_out_each(case, trial, spread)
    limit = max(CRITERIA.apart * least, CRITERIA.model_error)
    included = as_read.shooting.segments.trial != other
    if np.sqrt(np.nanmean((as_read.fit.residual[included] / spread) ** 2)) < limit:  # a search leaves no more of these
        return measured
    next_least = _leave_out_each(case, other, spread)
    if next_least < limit:
        return measured
    what = (
        f"trial {measured.trials[trial]!r} is an outlier: no single model fits it together with the other trials. The "
        f"best model leaves a residual of {least:.2g} standard deviations if this trial is excluded, and of "
        f"{next_least:.2g} if the next candidate, {measured.trials[other]!r}, is excluded instead"
    )
    source = measured.source or case.search.base.title
    spoils = "this trial, which was left out; check gain and offset of its channels, and whether one was constant"
    agreeing = measured.selected([number for number in range(count) if number != trial])
    return replace(agreeing, findings=(*agreeing.findings, Finding("warning", ODD_TRIAL, source, what, spoils)))


def _leave_out_each(case: Case, trial: int, spread: Values) -> float:
    """Root mean square that the best single explanation of all other trials leaves [standard deviations]."""
    others = tuple(other for other in range(len(case.measured.trials)) if other != trial)
    part = replace(case, learned=others)
    as_read = part.as_read()
    return float(np.sqrt(min(leaves(model, spread) for model in (as_read, *part.search.extended(as_read)))))
