"""Find, name, add, show: the whole way, from a simulation and measured trials to an answer."""

from collections.abc import Callable
from dataclasses import replace
from difflib import get_close_matches
from functools import partial

import numpy as np

from gaitdisc.discovery.answer import answer, augment_with
from gaitdisc.discovery.case import FEWEST_SAMPLES, TRIED_SUBSTEPS, Case, hangs_on_step, set_up_case, split_in_time
from gaitdisc.discovery.catalogue import ALL, Request
from gaitdisc.discovery.decision import Verdict, decide, prove_held_out
from gaitdisc.discovery.estimated_filter import note_other
from gaitdisc.discovery.held_out import grows_along_runs, holding_out_others, is_uninformative, noted, noting_alike
from gaitdisc.discovery.odd_trials import agreeing_trials, without_trial_apart
from gaitdisc.discovery.result import Discovery
from gaitdisc.discovery.scored_model import ScoredModel, score
from gaitdisc.discovery.search import Search, is_certain
from gaitdisc.discovery.second_look import look_at_whole_runs, prefer_delay, prefer_relatives, without_small
from gaitdisc.discovery.spiked_samples import without_spikes
from gaitdisc.discovery.symbolic_regression import read_instead, read_shape
from gaitdisc.discovery.uncertain_inputs import weigh_input_errors, weigh_unstated_errors
from gaitdisc.errors import SchemaError
from gaitdisc.simulation.compiled_simulation import Rows
from gaitdisc.simulation.measured import Measured
from gaitdisc.simulation.running import compile_simulation, refuse_divergence
from gaitdisc.simulation.simulation import Simulation

MOST_LOST = 0.2  # of the shortest runs; a few may begin at a bad guess of what is not measured
NEAREST = 5  # effects that stand in a refusal
CLOSE = 0.3  # of its range, moved from one sample to the next: ten samples in a period (pi / 10)


def discover(simulation: Simulation, measured: Measured, request: Request = ALL) -> tuple[Discovery, Simulation]:
    """Find where a simulation and measured trials disagree, name what is missing, add it, show the gap shrink."""
    case, as_read, verdict = explain(simulation, measured, request)
    return answer(case, as_read, verdict, request.refitted)


def explain(simulation: Simulation, measured: Measured, request: Request = ALL) -> tuple[Case, ScoredModel, Verdict]:
    """Return the case as it was decided, the simulation as read in it, and the verdict."""
    measured, progress = without_spikes(measured), request.progress
    begun = partial(set_up_case, simulation, request=request)
    whole = begun(measured)
    refuse_unknown(whole.search, request.effects)

    def explained(some: Measured) -> tuple[Case, ScoredModel, Verdict]:
        progress("fitting the simulation as it was read")
        case = whole if some is measured else begun(some)
        as_read = case.as_read()
        if not request.effects:
            return weigh_explanations(case, as_read, some, begun)
        progress(f"fitting {' and '.join(request.effects)}")
        return case, as_read, fit_given(case, as_read, request.effects)

    suspected = agreeing_trials(whole, measured)
    case, as_read, verdict = explained(suspected)
    if suspected is not measured:  # a trial is odd where what explains the others says so too
        explanation = augment_with(whole.search.base, verdict.found.parts)
        kept = agreeing_trials(replace(whole, search=replace(whole.search, base=explanation)), measured)
        if kept.trials != suspected.trials:
            progress("the identified effects explain a trial that was left out: repeating the search with this trial")
            case, as_read, verdict = explained(kept)
    progress("testing the answer on held-out data")
    return case, as_read, verdict


def weigh_explanations(
    case: Case, as_read: ScoredModel, measured: Measured, begun: Callable[[Measured], Case]
) -> tuple[Case, ScoredModel, Verdict]:
    """Search and decide; again without a trial that goes with no other, or with other data held out where need be."""
    progress = case.search.progress
    progress(f"weighing {len(case.search.candidates)} explanations")
    verdict = decide(case, as_read)
    for other in case.at_other_cutoffs if verdict.found.parts else ():
        if other.leaves_noise(again := other.as_read()):
            return other.noting(note_other(other.record_filter, case.measured.source)), again, Verdict(again, ())
    while hangs_on_step(case, verdict.found) and case.substeps < TRIED_SUBSTEPS[-1]:
        progress("the identified effects depend on the integration step: repeating the search with half the step")
        case = replace(case, substeps=2 * case.substeps)
        as_read = case.as_read()
        verdict = decide(case, as_read)
    if not case.leaves_noise(verdict.found):
        kept = without_trial_apart(case)
        if kept is not case.measured:
            progress("no single model fits one trial together with the others: this outlier is left out")
            measured, case = kept, begun(kept)
            as_read = case.as_read()
            verdict = decide(case, as_read)
    unproven, alone = verdict.rivals[:1] if verdict.word == "no_gap" else (), len(measured.trials) == 1
    if unproven and is_uninformative(case, as_read, *unproven):
        first = begun(split_in_time(measured, last=False)) if alone else holding_out_others(case, as_read, *unproven)
        progress("the held-out data never reach the range in which the effect acts: other data are held out")
        case, as_read = noted(case, first), first.as_read()
        verdict = decide(case, as_read)
    elif unproven and alone and grows_along_runs(case, as_read):  # a fall, after a rise that was learned; two tries
        progress("the held-out data show a gap that the training data do not show: other data are held out")
        first = begun(split_in_time(measured, last=False))
        first = replace(noted(case, first, "the training data do not show the gap of"), alpha=case.alpha / 2)
        as_read_first = first.as_read()
        tried = decide(first, as_read_first)
        if tried.found.parts:
            case, as_read, verdict = first, as_read_first, tried
    for step in (prefer_relatives, prefer_delay, read_shape, read_instead):
        verdict = step(case, as_read, verdict)
    as_read, verdict = look_at_whole_runs(case, as_read, verdict)
    progress("testing errors of the inputs as explanations")
    case, verdict = weigh_input_errors(case, verdict)
    case, verdict = weigh_unstated_errors(case, verdict)
    verdict = without_small(case, as_read, verdict)
    if verdict.proof and verdict.proof.test.fall < 0 and is_uninformative(case, as_read, verdict.found):
        case = noting_alike(case)
    return case, as_read, verdict


def refuse_blow_up(simulation: Simulation, measured: Measured) -> bool:
    """Refuse a simulation whose short runs do not stay finite; return whether samples are close enough for it."""
    case, machine = set_up_case(simulation, without_spikes(measured)), compile_simulation(simulation)
    segments = case.segments((*case.learned, *case.held_out), 0.0)
    rows = Rows(segments.trial, segments.begin, segments.starts(case.guess))
    drive = case.measured.drive
    states, ok = machine.run(drive, rows, FEWEST_SAMPLES - 1)
    if np.mean(~ok) > MOST_LOST:
        refuse_divergence(machine, drive, rows, states, ok)
    spread = np.maximum(np.ptp(states[ok, 0], axis=0), np.finfo(float).tiny)
    return bool(np.median((np.abs(states[ok, 1] - states[ok, 0]) / spread).max(axis=1)) < CLOSE)


def refuse_unknown(search: Search, effects: tuple[str, ...]) -> None:
    """Refuse an effect or a place that does not exist, with the nearest."""
    known = {candidate.label for candidate in search.candidates}
    for given in effects:
        if given not in known:
            near = get_close_matches(given, sorted(known), NEAREST, 0.0)
            raise SchemaError(
                "an effect to be fitted must be written as effect@place, with a known effect and a known place",
                f"found {given!r}; nearest are {', '.join(near)}",
                "Give one of these.",
            )


def fit_given(case: Case, as_read: ScoredModel, effects: tuple[str, ...]) -> Verdict:
    """Fit a simulation with exactly these effects in it, each `name@place`, and test it on what is held out."""
    search, now = case.search, as_read
    for given in effects:
        castings = tuple(candidate for candidate in search.open_beside(now) if candidate.label == given)
        scores = search.scorer(now).scores(castings)
        tried = [search.with_part(now, casting) for casting in scores]
        tried = [model for model in tried if np.isfinite(model.fit.misfit)]
        if not tried:
            raise SchemaError(
                "an effect to be fitted must change a measured channel, and may be given only once",
                f"if {given!r} is added, the simulation diverges or does not change",
                "Give another effect or place.",
            )
        now = score(min(tried, key=lambda model: model.fit.misfit))
    now = case.lengthen(now)
    count = len(now.parts)
    idle = [
        not is_certain(now, number, number + 1)
        or (count > 1 and not prove_held_out(case, search.without(now, number), now, as_read).bears_out)
        for number in range(count)
    ]
    return Verdict(now, (), proof=prove_held_out(case, as_read, now), given=tuple(idle))
