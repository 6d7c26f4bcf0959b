"""Twins of a record: simulated with what was found and without it, and searched again by the same rule.

How often the same answer returns says how far it can be trusted: a parametric bootstrap of the whole search.
Source: Efron and Tibshirani 1993, An Introduction to the Bootstrap, section 6.5.
"""

from __future__ import annotations

import math
import os
import time
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import product, starmap
from typing import Any, NoReturn

import numpy as np
from scipy.signal import lfilter

from gaitdisc.discovery.case import Case
from gaitdisc.discovery.catalogue import Request
from gaitdisc.discovery.decision import Verdict
from gaitdisc.discovery.discover import discover
from gaitdisc.discovery.first_states import StateGuess
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
    """What twins are drawn from: a case, the simulation as read in it, and the verdict."""

    case: Case
    as_read: ScoredModel
    verdict: Verdict

    def draw(self, with_effects: bool, seed: int) -> Measured | None:
        """Draw a record like the user's: its inputs, trials and gaps, free runs of the simulation, and noise as found.

        with_effects: whether what was found acts in it
        returns: None where a free run leaves the record
        """
        now, case = self.verdict.found if with_effects else self.as_read, _join_halves(self.case)
        measured, machine, rng = case.measured, now.model.machine, np.random.default_rng((seed, with_effects))
        erring, seen = with_drawn_errors(measured, case.search.base, seed), np.full_like(measured.observed, np.nan)
        for trial, samples in enumerate(map(int, measured.samples)):
            with outside_work():
                begun = begin_by_first_samples(case, now, trial).fit
            whole = replace(case.shooting(Segments(np.array([trial]), np.array([0]), samples)), measured=erring)
            seen[trial, :samples] = whole.run(machine, begun.starts[None], begun.values[None])[1][0, 0]
        known, record = np.isfinite(measured.observed), measured.observed
        low, high = np.nanmin(record, axis=(0, 1)), np.nanmax(record, axis=(0, 1))
        if not np.all((np.maximum(low - seen, seen - high) < FLED * (high - low))[known]):
            return None
        return replace(
            measured, observed=np.where(known, seen + self._draw_noise(seen.shape, rng), np.nan), findings=()
        )

    def _draw_noise(self, shape: tuple[int, ...], rng: np.random.Generator) -> Values:
        """Draw noise (trial, sample, channel) as it was found; where the record was filtered, white noise is too."""
        noise, passed = self.verdict.found.noise, self.case.record_filter
        if not passed.margin:
            return draw_noise(noise, shape, rng)
        white = rng.normal(size=(shape[0], shape[1] + 2 * passed.margin, shape[2]))
        return passed.filtered(white, 1)[:, passed.margin : -passed.margin] / passed.gains * noise.size


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


def _join_halves(case: Case) -> Case:
    """Return a case with its only trial whole again, where it was split in time."""
    measured, drive = case.measured, case.measured.drive
    first = measured.trials[0]
    if measured.trials not in [(first, f"{first}, {which} quarter") for which in ("last", "first")]:
        return case
    order = np.argsort(drive.time0)
    inputs, observed, states = (
        np.concatenate([one[part, : drive.samples[part]] for part in order])[None]
        for one in (drive.inputs, measured.observed, case.guess.states)
    )
    whole = Drive.of([*inputs], drive.rate, [float(drive.time0.min())])
    measured = replace(measured, drive=whole, observed=observed, trials=(first,))
    return replace(case, measured=measured, guess=StateGuess(states))


def refuse_twins(model: str) -> NoReturn:
    """Refuse twins of what only an engine or a study can run."""
    raise SchemaError(
        "twins need a simulation file or a Python function", f"{model} is neither", "Leave out the number of twins."
    )


def search_twins(found: Discovery, source: TwinSource, model: Simulation, request: Request) -> Discovery:
    """Return an answer with what the same search says of its twins: with what was found in them, and without.

    model: the simulation that was searched
    """
    count, named = request.twins, _name(found)
    acts = bool(source.verdict.found.model.parts) and found.verdict not in RANDOM
    kinds = (True, False) if acts else (False,)
    jobs = [*product(kinds, range(count))]
    if any(source.draw(with_effects, 0) is None for with_effects in kinds):
        what = "a free run of the simulation leaves the record, so that records like these cannot be simulated"
        return replace(
            found,
            findings=(
                *found.findings,
                Finding("note", "twins", source.case.measured.source, what, "how often this answer is right"),
            ),
        )
    note_found("")
    answers, begun = Counter[tuple[bool, str]](), time.perf_counter()
    same_rule, pending = replace(request, effects=(), twins=0, progress=lambda _: None), None
    for done, (with_effects, seed) in enumerate(jobs):
        answer = recall(f"twin {with_effects} {seed}")
        if answer is None:
            pending = pending or _answer(source, model, same_rule, jobs[done:])
            answer = next(pending)
            left = (time.perf_counter() - begun) / (done + 1) * (len(jobs) - done - 1)
            request.progress(f"twin {done + 1} of {len(jobs)} searched, about {math.ceil(left / 10) * 10} s left")
            keep(answer)
        answers[with_effects, answer] += 1
    both = ({answer: n for (acted, answer), n in answers.items() if acted is kind} for kind in (True, False))
    return replace(found, twins=Twins(count, named, *both))


def _answer(source: TwinSource, model: Simulation, request: Request, jobs: list[tuple[bool, int]]) -> Iterator[str]:
    """Search twins side by side, and give the answers in their order."""
    processes = min(os.cpu_count() or 1, MOST_PROCESSES, len(jobs))
    drawn = ((model, source.draw(*job), request) for job in jobs)
    if processes == 1:
        yield from starmap(_search, drawn)
        return
    from joblib import Parallel, delayed

    side_by_side = Parallel(n_jobs=processes, return_as="generator", inner_max_num_threads=1)
    answers: Any = side_by_side(delayed(_search)(*one) for one in drawn)
    yield from answers


def _search(model: Simulation, twin: Measured | None, request: Request) -> str:
    if twin is None:  # by its own errors of inputs it has left the record
        return LEFT
    with outside_work(), np.errstate(over="ignore", invalid="ignore"):
        return _name(discover(model, twin, request)[0])


def _name(found: Discovery) -> str:
    """Say an answer in short: the effects at their places, or the verdict."""
    return ", ".join(sorted(f"{one.name}@{one.place}" for one in found.effects if not one.small)) or found.verdict
