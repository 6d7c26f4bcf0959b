"""A case: one simulation, one set of measured trials, what is fitted and what is held out."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property, partial

import numpy as np

from gaitdisc.discovery.candidate import list_candidates
from gaitdisc.discovery.catalogue import ALL, Request, read_shapes
from gaitdisc.discovery.criteria import CRITERIA
from gaitdisc.discovery.estimated_filter import find_record_filter
from gaitdisc.discovery.first_states import guess_states
from gaitdisc.discovery.gap_share import GapScale
from gaitdisc.discovery.grids import Rhythm, find_rhythm
from gaitdisc.discovery.input_errors import with_constant_errors
from gaitdisc.discovery.linearised import linearise, linearise_along
from gaitdisc.discovery.matched import Idle, idle_parts, match_channels, refuse_idle
from gaitdisc.discovery.noise import Noise, sensor_noise, white_noise
from gaitdisc.discovery.places import kinematic_rates, list_places
from gaitdisc.discovery.record_filter import RecordFilter
from gaitdisc.discovery.result import ALPHA
from gaitdisc.discovery.scored_model import ScoredModel, fit_model, leaves, score
from gaitdisc.discovery.search import Search
from gaitdisc.discovery.segments import FEWEST_SAMPLES, Segments, cut_segments
from gaitdisc.discovery.shooting import Shooting
from gaitdisc.recording import Finding
from gaitdisc.recording.arrays import Values, root_mean_square
from gaitdisc.simulation.compiled_simulation import Drive, Rows
from gaitdisc.simulation.measured import Measured
from gaitdisc.simulation.running import compile_simulation
from gaitdisc.simulation.simulation import Simulation

FEWEST_COMPARED = 8  # samples of a segment that went through a filter
SHORT = 6  # margins in a trial, at least
FIRST_SHARE = 0.3  # of that length, is fitted first, so that the fit of the whole begins near its end
LENGTHENED = 3  # times as long, again and again, while a run stays with the data
WHOLE_PERIOD = 0.8
TRIED_SUBSTEPS = (2, 4, 8)  # integration steps a sample
MOST_SEARCHED = 10_000  # samples, all runs together: what is found on them is fitted to all data


@dataclass(frozen=True)
class Case:
    """A simulation, measured trials, and which of them are held out."""

    search: Search  # the simulation, and everything that could explain a gap
    measured: Measured
    learned: tuple[int, ...]  # trials that are searched and fitted
    held_out: tuple[int, ...]  # trials that nothing but a start is fitted to
    record_filter: RecordFilter
    alpha: float = ALPHA  # the greatest rate of false finds
    substeps: int = TRIED_SUBSTEPS[0]  # integration steps a sample

    @property
    def rhythm(self) -> Rhythm:
        """The record's times."""
        return self.search.rhythm

    @property
    def guess(self) -> Values:
        """States of every trial, roughly (trial, sample, state); NaN beyond a trial's end."""
        return self.search.guess

    @property
    def at_other_cutoffs(self) -> list[Case]:
        """The case with estimated cut-offs lower and higher by their error; none where the file states them."""
        stated = [self.search.base.sensor(name).lowpass for name in self.measured.channels]
        return [replace(self, record_filter=passed) for passed in self.record_filter.within_error(stated)]

    @cached_property
    def sensor_noise(self) -> Values:
        """Standard deviation of each sensor's noise in the record (channel,): as the file says, or else as the record.

        What the file says is that of the sensor; the record's filter leaves less. NaN where the file says nothing and a
        filter has made the noise as smooth as the signal.
        """
        given = [self.search.base.sensor(name).sd for name in self.measured.channels]
        given_sizes = np.array([np.nan if size is None else size for size in given]) * self.record_filter.gains
        unfiltered = np.array([size is None for size in self.record_filter.cutoffs_hz])
        estimated = np.where(unfiltered, sensor_noise(self.measured.observed), np.nan)
        return np.where(np.isnan(given_sizes), estimated, given_sizes)

    @cached_property
    def scale(self) -> GapScale:
        """What gaps are measured against."""
        observed = self.measured.observed
        spread, known = np.nanstd(observed, axis=(0, 1)), self.sensor_noise
        noise = np.where(np.isnan(known), sensor_noise(observed), known)
        return GapScale(noise, np.where(spread > 0, spread, 1.0))

    def leaves_noise(self, now: ScoredModel) -> bool:
        """Whether what a model leaves is no larger than the noise of the sensors.

        Where this is not known (a filtered record whose file does not say it), whether it is autocorrelated no further
        than by the filter, and not surely larger than what the spectrum shows; where the simulation itself errs, and
        its errors with it, whether it is a small share of the spread.
        """
        if self.search.base.inexact and self.scale.relative(now.fit) < CRITERIA.inexact:
            return True
        if not np.isfinite(self.sensor_noise).all():
            left = root_mean_square(now.fit.residual)
            return not (now.noise.is_autocorrelated or (self.record_filter.at_most_noise(left) < left).any())
        return leaves(now, self.sensor_noise) < CRITERIA.mere_noise

    def noise_floor(self, noise: Values) -> Values:
        """Return the size of the sensors' noise (channel,); where it is not known, of what a simulation leaves."""
        return np.where(np.isnan(self.sensor_noise), self.record_filter.at_most_noise(noise), self.sensor_noise)

    def noting(self, finding: Finding) -> Case:
        """Return the case with one finding more."""
        return replace(self, measured=replace(self.measured, findings=(*self.measured.findings, finding)))

    def segments(self, trials: tuple[int, ...], periods: float = 1.0) -> Segments:
        """Cut trials into runs."""
        samples = int(round(periods * self.rhythm.samples, 6))  # 88 / period / rate * ... may be 87.99
        passed, lengths = self.record_filter, self.measured.drive.samples
        wanted = max(samples, FEWEST_SAMPLES, FEWEST_COMPARED * passed.every)
        margin = min(passed.margin, int(min(lengths[trial] for trial in trials)) // SHORT)
        return cut_segments(lengths, trials, wanted, margin, passed.every)

    def shooting(self, segments: Segments) -> Shooting:
        """Return the segments, ready to be fitted, under noise of unit size."""
        channels = self.measured.observed.shape[2]
        noise = white_noise(np.ones(channels))
        return Shooting(self.measured, segments, noise, self.substeps, self.guess, record_filter=self.record_filter)

    @property
    def longest(self) -> int:
        """Samples of the longest run that every learned trial holds."""
        return int(min(self.measured.drive.samples[trial] for trial in self.learned))

    def cut_learned_runs(self, samples: int) -> Shooting:
        """Return the learned trials cut into runs, ready to be fitted."""
        return self.shooting(self.segments(self.learned, samples / self.rhythm.samples))

    def as_read(self) -> ScoredModel:
        """Return the simulation as read, fitted to short runs and scored.

        The runs last one period, or less where a small change of the start grows fast (chaos, a fall). Of a long record
        runs spread over all of it are taken.
        """
        periods = self.predictable_periods()
        first = self.shooting(self.segments(self.learned, FIRST_SHARE * periods).spread(MOST_SEARCHED))
        begun = fit_model(first, self.search.base, (), first.segments.starts(self.guess))
        guess = first.segments.put(self.guess, begun.fit.states)
        shooting = self.shooting(self.segments(self.learned, periods).spread(MOST_SEARCHED))
        model = begun.refitted(shooting, starts=shooting.segments.starts(guess))
        if not np.isfinite(model.fit.misfit):  # short runs leave hidden states open, and a long one may end with these
            model = fit_model(shooting, self.search.base, (), shooting.segments.starts(self.guess))
        return score(model.with_own_past())

    def predictable_periods(self) -> float:
        """Return how long a run may be, in periods, before a change of its start has grown by `growth`."""
        shooting = self.shooting(self.segments(self.learned).spread(MOST_SEARCHED))
        states = shooting.segments.of(self.guess)
        machine = compile_simulation(self.search.base)
        line = linearise_along(shooting, self.search.base, (), states, machine.defaults)
        step = line.first_growth(CRITERIA.growth, states)
        return 1.0 if step is None else step / self.rhythm.samples

    def spans_a_period(self, now: ScoredModel) -> bool:
        """Whether runs were cut at a whole period, and not earlier, as chaos demands."""
        return now.shooting.segments.span >= WHOLE_PERIOD * self.rhythm.samples

    def fit_over(self, samples: int, model: ScoredModel, noise: Noise) -> ScoredModel:
        """Fit a model to the learned trials cut into other runs, which begin along its own."""
        shooting = self.cut_learned_runs(samples).with_noise(noise)
        guess = model.shooting.segments.put(self.guess, model.fit.states)
        return model.refitted(shooting, starts=shooting.segments.starts(guess))

    def lengthen(self, now: ScoredModel, most: int = 10**9) -> ScoredModel:
        """Return a model fitted to runs as long as it can follow, of `most` samples at most."""
        longest = min(most, self.longest - 2 * now.shooting.segments.margin)
        followed = np.sqrt(1 + (CRITERIA.follows**2 - 1) / self.record_filter.gains**2)
        while now.shooting.segments.span * 2 < longest:
            longer = self.fit_over(min(LENGTHENED * now.shooting.segments.span, longest), now, now.noise)
            if not np.isfinite(longer.fit.misfit):
                break
            longer = replace(score(longer.with_own_past()), gained=now.gained)
            if (longer.noise.size > followed * now.noise.size).any() or not self.search.sensible(longer):
                break
            if linearise(longer, ()).first_growth(CRITERIA.chaotic, longer.fit.states) is not None:
                break
            now = longer
        return now


def set_up_case(simulation: Simulation, measured: Measured, request: Request = ALL) -> Case:
    """Prepare a case: split the trials, list places and explanations, guess the states.

    measured: its trials; of four, one is held out, of one, the last quarter of its time
    """
    simulation = with_constant_errors(match_channels(simulation, measured, request.shapes))
    if len(measured.trials) == 1:
        measured = split_in_time(measured)
    places = list_places(simulation)
    rhythm = find_rhythm(measured.observed, measured.drive.rate)
    listed = list_candidates(simulation, places, (*read_shapes(), *request.shapes))
    considered = tuple(filter(request.possible, (*listed, *request.added)))
    guess = guess_states(simulation, measured, rhythm.period, kinematic_rates(simulation))
    search = Search(simulation, places, considered, rhythm, guess, request.progress)
    trials = len(measured.drive.samples)
    held = max(round(trials / 4), 1)
    passed, findings = find_record_filter(simulation, measured, rhythm.period, guess)
    measured = replace(measured, findings=(*measured.findings, *findings))
    learned, held_out = tuple(range(trials - held)), tuple(range(trials - held, trials))
    case = Case(search, measured, learned, held_out, passed, alpha=request.alpha)
    return _less_idle(replace(case, substeps=_count_substeps(case)))


def _count_substeps(case: Case) -> int:
    """Return the integration steps a sample of which twice as many end short runs alike: too few run away."""
    segments, machine = case.segments(case.learned, 0.0), compile_simulation(case.search.base)
    rows = Rows(segments.trial, segments.begin, segments.starts(case.guess))
    spread = np.nanstd(case.guess, axis=(0, 1))
    spread = np.where(spread > 0, spread, 1.0)
    ends = {
        count: machine.run(case.measured.drive, rows, FEWEST_SAMPLES - 1, substeps=count)[0][:, -1] / spread
        for count in (*TRIED_SUBSTEPS, 2 * TRIED_SUBSTEPS[-1])
    }
    alike = partial(np.allclose, rtol=0.0, atol=CRITERIA.model_error, equal_nan=True)
    enough = [count for count in TRIED_SUBSTEPS if alike(ends[count], ends[2 * count])]
    return enough[0] if enough else TRIED_SUBSTEPS[0]  # what moves faster than that is sampled too slowly


def hangs_on_step(case: Case, now: ScoredModel) -> bool:
    """Whether a model's runs move by more than a simulation may err where the integration step is halved."""
    fit = now.fit
    finer = replace(now.shooting, substeps=2 * now.shooting.substeps)
    _, seen = finer.run(now.machine, fit.starts[None], fit.values[None])
    moved = (finer.seen - fit.residual - seen[0]) / case.scale.spread
    return not np.sqrt(np.nanmean(moved**2)) < CRITERIA.model_error


def _less_idle(case: Case) -> Case:
    """Return the case without the places that change nothing of what is measured, and a finding about each."""
    search = case.search
    for periods in (1.0, case.rhythm.duration / case.rhythm.period):  # what comes late may need a whole trial
        segments = case.segments(case.learned, periods)
        idle = idle_parts(case.shooting(segments), search.base, search.places, segments.starts(case.guess))
        if idle == Idle():
            return case
    refuse_idle(idle, search.base, search.places)
    kinds = {(place.kind, place.name) for place in search.places if place.name in idle.places}
    kinds |= {("parameter", name) for name in idle.parameters}
    places = tuple(place for place in search.places if place.name not in idle.places)
    candidates = tuple(candidate for candidate in search.candidates if (candidate.kind, candidate.place) not in kinds)
    measured, kind = case.measured, "port" if search.base.ports else "equation"
    findings = (*measured.findings, *idle.findings(measured.source or search.base.title, kind))
    search = replace(search, places=places, candidates=candidates)
    return replace(case, search=search, measured=replace(measured, findings=findings))


def split_in_time(measured: Measured, last: bool = True) -> Measured:
    """Return one trial as two: what is learned from, and the last quarter of its time, or else the first, held out."""
    drive, samples = measured.drive, int(measured.samples[0])
    quarter = samples // 4
    parts = [(0, samples - quarter), (samples - quarter, samples)] if last else [(quarter, samples), (0, quarter)]
    observed = np.full((2, samples - quarter, measured.observed.shape[2]), np.nan)
    for place, (first, end) in enumerate(parts):
        observed[place, : end - first] = measured.observed[0, first:end]
    inputs = [drive.inputs[0, first:end] for first, end in parts]
    driven = Drive.of(inputs, drive.rate, [drive.time0[0] + first / drive.rate for first, _ in parts])
    name = measured.trials[0]
    trials = (name, f"{name}, {'last' if last else 'first'} quarter")
    return replace(measured, drive=driven, observed=observed, trials=trials)
