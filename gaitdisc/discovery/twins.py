"""Twins of a record: simulated with what was found and without it, and searched again by the same rule.

How often the same answer returns says how far it can be trusted: a parametric bootstrap of the whole search.
Source: Efron and Tibshirani 1993, An Introduction to the Bootstrap, section 6.5.
"""

from __future__ import annotations

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

from gaitdisc.discovery.case import Case
from gaitdisc.discovery.catalogue import Request
from gaitdisc.discovery.decision import Verdict
from gaitdisc.discovery.discover import discover
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
            np.concatenate([one[part, : drive.samples[part]] for part in order])[None]
            for one in (drive.inputs, measured.observed, case.guess)
        )
        whole = Drive.of([*inputs], drive.rate, [float(drive.time0.min())])
        measured = replace(measured, drive=whole, observed=observed, trials=(first,))
        return replace(case, measured=measured, search=replace(case.search, guess=states))

    @cached_property
    def starts(self) -> list[Values]:
        """Where each trial begins by its first samples (1, state)."""
        trials = range(len(self.case.measured.trials))
        with outside_work():
            return [begin_by_first_samples(self.case, self.begun or self.now, trial).fit.starts for trial in trials]

    def draw(self, number: int) -> Measured | None:
        """Draw a record like the user's: its inputs, trials and gaps, free runs of the model, and noise.

        number: of the record, which seeds what is drawn
        returns: None where a free run leaves the record
        """
        case, measured, model = self.case, self.case.measured, self.now
        erring, seen = with_drawn_errors(measured, case.search.base, number), np.full_like(measured.observed, np.nan)
        for trial, samples in enumerate(map(int, measured.samples)):
            whole = replace(case.shooting(Segments(np.array([trial]), np.array([0]), samples)), measured=erring)
            _, runs = whole.run(model.machine, self.starts[trial][None], model.fit.values[None])
            seen[trial, :samples] = runs[0, 0]
        known, record = np.isfinite(measured.observed), measured.observed
        low, high = np.nanmin(record, axis=(0, 1)), np.nanmax(record, axis=(0, 1))
        if not np.all((np.maximum(low - seen, seen - high) < FLED * (high - low))[known]):
            return None
        noise = self._draw_noise(seen.shape, np.random.default_rng(number))
        return replace(measured, observed=np.where(known, seen + noise, np.nan), findings=())

    def _draw_noise(self, shape: tuple[int, ...], rng: np.random.Generator) -> Values:
        """Draw noise (trial, sample, channel); where the record was filtered, white noise that was filtered alike."""
        passed = self.case.record_filter
        if not passed.margin:
            return draw_noise(self.noise, shape, rng)
        white = rng.normal(size=(shape[0], shape[1] + 2 * passed.margin, shape[2]))
        return passed.filtered(white, 1)[:, passed.margin : -passed.margin] / passed.gains * self.noise.size


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


def refuse_twins(model: str) -> NoReturn:
    """Refuse twins, and a plan, of what only an engine or a study can run."""
    raise SchemaError(
        "twins and a plan need a simulation file or a Python function", f"{model} is neither", "Leave them out."
    )


def search_twins(
    found: Discovery, case: Case, as_read: ScoredModel, verdict: Verdict, model: Simulation, request: Request
) -> Discovery:
    """Return an answer with what the same search says of its twins: with what was found in them, and without.

    case, as_read: that was decided, and the simulation as read in it
    model: the simulation that was searched
    """
    acts = verdict.found.parts and found.verdict not in RANDOM
    models = [verdict.found, as_read] if acts else [as_read]
    sources = [TwinSource(case, now, verdict.found.noise) for now in models]
    if any(source.draw(0) is None for source in sources):
        what = "a free run of the simulation departs from the record, so that records like these cannot be simulated"
        finding = Finding("note", "twins", case.measured.source, what, "the reliability of this answer")
        return replace(found, findings=(*found.findings, finding))
    note_found("")
    answers = [*search_records(sources, model, request)]
    acting, without = (dict(Counter(some)) for some in (answers[: -request.twins], answers[-request.twins :]))
    return replace(found, twins=Twins(request.twins, _name(found), acting, without))


def search_records(sources: Sequence[TwinSource], model: Simulation, request: Request) -> Iterator[str]:
    """Search as many records of each source as a request has twins, side by side by its rule; the answers in order."""
    rule, begun = replace(request, effects=(), twins=0, progress=lambda _: None), time.perf_counter()
    records, pending = [*product(sources, range(request.twins))], None
    for done, (source, number) in enumerate(records, 1):
        answer = recall(f"record {number}", source.now.fit.values.tobytes())
        if answer is None:
            if pending is None:  # those before were kept by an earlier run
                twins = (one.draw(its_number) for one, its_number in records[done - 1 :])
                pending = _search_side_by_side(model, twins, len(records) - done + 1, rule)
            answer = next(pending)
            left = (time.perf_counter() - begun) / done * (len(records) - done)
            request.progress(f"{done} of {len(records)} simulated records are searched; about {left:.0f} s remain")
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


def _name(found: Discovery) -> str:
    """Say an answer in short: the effects at their places, or the verdict."""
    return ", ".join(sorted(f"{one.name}@{one.place}" for one in found.effects if not one.small)) or found.verdict
