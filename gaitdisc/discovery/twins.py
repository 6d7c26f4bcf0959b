"""Twins of a record: simulated with what was found and without it, and searched again by the same rule.

How often the same answer returns says how far it can be trusted: a parametric bootstrap of the whole search.
Source: Efron and Tibshirani 1993, An Introduction to the Bootstrap, section 6.5; Atkinson and Fedorov 1975, Biometrika
62, 57 (two models are distinguished where the rival, fitted, errs most).
"""

import os
import time
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import product
from typing import Any, NoReturn

import numpy as np
from scipy.signal import lfilter

from gaitdisc.discovery.answer import weigh_rivals
from gaitdisc.discovery.case import Case
from gaitdisc.discovery.catalogue import Request
from gaitdisc.discovery.decision import Verdict
from gaitdisc.discovery.discover import discover
from gaitdisc.discovery.effect_words import named_at
from gaitdisc.discovery.held_out import begin_by_first_samples
from gaitdisc.discovery.input_errors import with_drawn_errors
from gaitdisc.discovery.kept_work import keep, note_found, outside_work, recall
from gaitdisc.discovery.noise import Noise
from gaitdisc.discovery.result import Discovery, Twins
from gaitdisc.discovery.scored_model import ScoredModel
from gaitdisc.discovery.segments import Segments
from gaitdisc.errors import SchemaError
from gaitdisc.recording import Finding
from gaitdisc.recording.arrays import Values
from gaitdisc.simulation.compiled_simulation import Drive
from gaitdisc.simulation.measured import Measured
from gaitdisc.simulation.simulation import Simulation

BURN_IN = 50  # times the order of an autoregression, until nothing of its start is left
FLED = 10.0  # times a channel's range, beyond which a run has left the record
MOST_PROCESSES = 8
LEFT = "left the record"
RANDOM = ("process_noise", "wrong_initial_condition")  # answers that no term or number carries into a twin
INPUTS, STARTS = (0.5, 2.0), (0.5, 1.5)  # times as fast, or as large, as in the record
CLEARLY = 20.0  # expected evidence, of which noise leaves less than 6 (a tie) in one record of twenty


@dataclass(frozen=True)
class TwinSource:
    """What records like the user's are drawn from: the case that was decided, a model of it, and noise."""

    decided: Case
    now: ScoredModel
    noise: Noise
    begun: ScoredModel | None = None  # finds the starts of a record that has nothing of the effect

    @cached_property
    def case(self) -> Case:
        """The case with its only trial whole again, where it was split in time."""
        case, measured, drive = self.decided, self.decided.measured, self.decided.measured.drive
        first = measured.trials[0]
        if measured.trials not in [(first, f"{first}, {which} quarter") for which in ("last", "first")]:
            return case
        order = np.argsort(drive.time0)
        inputs, observed, states = (
            np.concatenate([signal[part, : drive.samples[part]] for part in order])[None]
            for signal in (drive.inputs, measured.observed, case.guess)
        )
        joined = Drive.of([*inputs], drive.rate, [float(drive.time0.min())])
        measured = replace(measured, drive=joined, observed=observed, trials=(first,))
        return replace(case, measured=measured, search=replace(case.search, guess=states))

    @cached_property
    def starts(self) -> list[Values]:
        """Where each trial begins by its first samples (1, state)."""
        trials = range(len(self.case.measured.trials))
        with outside_work():
            return [begin_by_first_samples(self.case, self.begun or self.now, trial).fit.starts for trial in trials]

    def draw(self, number: int) -> Measured | None:
        """Draw a record, by its number, like the user's: free runs and noise; None where a run leaves the record."""
        measured, passed = self.case.measured, self.case.record_filter
        _, run = self.run(with_drawn_errors(measured, self.case.search.base, number))
        if run is None:
            return None
        rng, shape = np.random.default_rng(number), run.observed.shape
        if passed.margin:  # the record was filtered: white noise that was filtered alike
            white = rng.normal(size=(shape[0], shape[1] + 2 * passed.margin, shape[2]))
            noise = passed.filtered(white, 1)[:, passed.margin : -passed.margin] / passed.gains * self.noise.size
        else:
            noise = draw_noise(self.noise, shape, rng)
        return replace(measured, observed=run.observed + noise, findings=())

    def run(self, like: Measured, larger: float = 1.0) -> tuple[Values, Measured | None]:
        """Run the model freely over all trials of a record, from some times its initial states.

        returns states (trial, sample, state): NaN beyond a trial's end
        returns run: the record with what would be seen without noise; None where this leaves its range
        """
        model, record, seen = self.now, like.observed, np.full_like(like.observed, np.nan)
        states = np.full((*record.shape[:2], len(model.machine.states)), np.nan)
        for trial, samples in enumerate(map(int, like.samples)):
            shooting = replace(self.case.shooting(Segments(np.array([trial]), np.array([0]), samples)), measured=like)
            runs = shooting.run(model.machine, larger * self.starts[trial][None], model.fit.values[None])
            states[trial, :samples], seen[trial, :samples] = (run[0, 0] for run in runs)
        low, high = np.nanmin(record, axis=(0, 1)), np.nanmax(record, axis=(0, 1))
        stays, known = np.maximum(low - seen, seen - high) < FLED * (high - low), np.isfinite(record)
        return states, replace(like, observed=np.where(known, seen, np.nan)) if np.all(stays[known]) else None


def draw_noise(noise: Noise, shape: tuple[int, ...], rng: np.random.Generator) -> Values:
    """Draw stationary noise (trial, sample, channel).

    >>> red = Noise(((np.zeros(0), np.array([0.8])),), (np.array([1.0, 0.6]),))
    >>> drawn = draw_noise(red, (40, 500, 1), np.random.default_rng(0))
    >>> bool(abs(drawn.std() - 1) < 0.1), bool(abs((drawn[:, 1:] * drawn[:, :-1]).mean() - 0.8) < 0.1)
    (True, True)
    """
    first = BURN_IN * max(noise.lags, default=0)
    out = np.empty((shape[0], shape[1] + first, shape[2]))
    for channel, (predictors, spread) in enumerate(zip(noise.predictors, noise.spread, strict=True)):
        white = spread[-1] * rng.normal(size=out.shape[:2])
        out[..., channel] = lfilter([1.0], [1.0, *-predictors[-1]], white, axis=1)
    return out[:, first:]


def list_changes(case: Case) -> Iterator[tuple[str, Drive, float]]:
    """List changes of the measurement, none first: words, what drives it, and times the initial states."""
    drive, inputs = case.measured.drive, [signal.name for signal in case.search.base.inputs]
    yield "no change", drive, 1.0
    for factor in INPUTS if inputs and "phase" not in inputs else ():
        yield f"inputs {factor:g} times as fast", sped_up(drive, factor), 1.0
        yield f"inputs {factor:g} times as large", replace(drive, inputs=factor * drive.inputs), 1.0
    yield from ((f"initial states {factor:g} times as large", drive, factor) for factor in STARTS)


def sped_up(drive: Drive, factor: float) -> Drive:
    """Return inputs some times as fast; where a trial's end comes early, they go back."""
    inputs = drive.inputs.copy()
    for trial, samples in enumerate(map(int, drive.samples)):
        last, number = samples - 1, np.arange(samples)
        there = last - np.abs(factor * number % (2 * last) - last)
        for column, wave in enumerate(drive.inputs[trial, :samples].T):
            inputs[trial, :samples, column] = np.interp(there, number, wave)
    return replace(drive, inputs=inputs)


def say_apart(source: TwinSource, rivals: Sequence[ScoredModel]) -> str:
    """Say which change of the measurement would best distinguish an answer from what is tied with it."""
    twins, table = [replace(source, now=rival) for rival in rivals], list[tuple[str, Values]]()
    for words, drive, larger in list_changes(source.case):
        measured = replace(source.case.measured, drive=drive)
        pairs = [[weigh_run(*two, measured, larger) for two in ((source, twin), (twin, source))] for twin in twins]
        table.append((words, np.nan_to_num(np.min(pairs, axis=1), nan=0.0, posinf=0.0)))  # whichever of the two is true
    (_, baseline), *changes = table
    words, then = max(changes, key=lambda change: np.minimum(change[1], CLEARLY).sum())
    clear, tried = then >= CLEARLY, f"{len(changes)} simulated changes of the measurement"
    if not clear.any():
        return f"None of {tried} would distinguish the tied explanations (expected evidence: at most {then.max():.0f})."
    names = " or ".join(named_at(rival.parts[-1].candidate) for rival, it in zip(rivals, clear, strict=True) if it)
    evidence = f"expected evidence {then[clear].min():.0f}, now {baseline[clear].max():.0f}"
    return f"Of {tried}, {words} would best distinguish the answer from {names}: {evidence}."


def weigh_run(source: TwinSource, rival: TwinSource, measured: Measured, larger: float) -> float:
    """Return how far the criterion would fall from a rival, fitted to a run of the source's model, to the model itself.

    The run has no noise, and is weighed by the noise that there would be; NaN where it leaves the record.
    """
    (states, run), truth = source.run(measured, larger), source.now
    if run is None:
        return np.nan
    past = states[..., : source.case.guess.shape[2]]
    shooting = replace(truth.shooting, measured=run, past=past)
    white = rival.now.refitted(shooting, starts=shooting.segments.starts(past)).fit.white
    return float((white**2).sum() + (rival.now.size - truth.size) * np.log(white.size))


def refuse_twins(model: str) -> NoReturn:
    """Refuse twins, and a plan, of what only an engine or a study can run."""
    raise SchemaError(
        "twins and a plan need a simulation file or a Python function", f"{model} is neither", "Leave both out."
    )


def search_twins(
    discovery: Discovery, case: Case, as_read: ScoredModel, verdict: Verdict, model: Simulation, request: Request
) -> Discovery:
    """Return an answer with what the same search says of its twins: with what was found in them, and without."""
    acts = verdict.found.parts and discovery.verdict not in RANDOM
    models = [verdict.found, as_read] if acts else [as_read]
    sources = [TwinSource(case, scored, verdict.found.noise) for scored in models]
    if any(source.draw(0) is None for source in sources):
        what = "a free run of the simulation departs from the record, so records like these cannot be simulated"
        finding = Finding("note", "twins", case.measured.source, what, "the estimate of how often this answer is right")
        return replace(discovery, findings=(*discovery.findings, finding))
    note_found("")
    answers = [*search_records(sources, model, request)]
    acting, without = (dict(Counter(some)) for some in (answers[: -request.twins], answers[-request.twins :]))
    with outside_work(), np.errstate(over="ignore", invalid="ignore"):
        rivals = weigh_rivals(case.search, verdict.found, verdict.rivals, 0.0) if acts else ()
        tied = [rival.scored for rival in rivals if rival.tied]
        apart = say_apart(sources[0], tied) if tied else ""
    return replace(discovery, twins=Twins(request.twins, _name(discovery), acting, without, apart))


def search_records(sources: Sequence[TwinSource], model: Simulation, request: Request) -> Iterator[str]:
    """Search as many records of each source as a request has twins, side by side by its rule; the answers in order."""
    rule, begun = replace(request, effects=(), twins=0, progress=lambda _: None), time.perf_counter()
    records, pending = [*product(sources, range(request.twins))], None
    for done, (source, number) in enumerate(records, 1):
        answer = recall(f"record {number}", source.now.fit.values.tobytes())
        if answer is None:
            if pending is None:  # those before were kept by an earlier run
                twins = (twin.draw(its_number) for twin, its_number in records[done - 1 :])
                pending = _search_side_by_side(model, twins, len(records) - done + 1, rule)
            answer = next(pending)
            remaining = (time.perf_counter() - begun) / done * (len(records) - done)
            request.progress(f"{done} of {len(records)} simulated records searched; about {remaining:.0f} s remain")
            keep(answer)
        yield answer


def _search_side_by_side(
    model: Simulation, twins: Iterator[Measured | None], count: int, rule: Request
) -> Iterator[str]:
    processes = min(os.cpu_count() or 1, MOST_PROCESSES, count)
    if processes == 1:
        yield from (_search(model, twin, rule) for twin in twins)
        return
    from joblib import Parallel, delayed

    side_by_side = Parallel(n_jobs=processes, return_as="generator", inner_max_num_threads=1)
    answers: Any = side_by_side(delayed(_search)(model, twin, rule) for twin in twins)
    yield from answers


def _search(model: Simulation, twin: Measured | None, request: Request) -> str:
    if twin is None:  # by its own errors of inputs it has left the record
        return LEFT
    with outside_work(), np.errstate(over="ignore", invalid="ignore"):
        return _name(discover(model, twin, request)[0])


def _name(discovery: Discovery) -> str:
    """Say an answer in short: the effects at their places, or the verdict."""
    effects = sorted(f"{effect.name}@{effect.place}" for effect in discovery.effects if not effect.small)
    return ", ".join(effects) or discovery.verdict
