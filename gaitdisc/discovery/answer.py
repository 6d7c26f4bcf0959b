"""The answer: numbers with intervals, where it acts, how far the gap shrank, and one sentence."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from gaitdisc.discovery.candidate_model import CandidateModel, Part
from gaitdisc.discovery.corrections import corrected, corrections_of, file_bounds
from gaitdisc.discovery.decision import Verdict
from gaitdisc.discovery.effect_units import places_unit, unit_of_channel
from gaitdisc.discovery.estimates import estimates_of
from gaitdisc.discovery.held_out import drawn_runs, gap_size, proof_of, runs_of, tested
from gaitdisc.discovery.influence import nearly_off
from gaitdisc.discovery.odd_trials import KIND as ODD_TRIAL
from gaitdisc.discovery.problem import Problem
from gaitdisc.discovery.process_noise import ProcessNoise
from gaitdisc.discovery.rivals import Rival, bic_gain, rivals_of
from gaitdisc.discovery.scored_model import ScoredModel
from gaitdisc.discovery.wording import sentence_of
from gaitdisc.discovery.wrong_start import begun_at
from gaitdisc.recording import Finding
from gaitdisc.results.discovery import Discovery, Estimate, FoundEffect, GapSize, Whereabouts
from gaitdisc.simulation.evaluating import Points, evaluate
from gaitdisc.simulation.simulation import Simulation

HALF = 0.5
DIGITS = 3  # of the numbers in an expression that a person reads; those of the file are exact


def answer(
    problem: Problem,
    as_read: ScoredModel,
    verdict: Verdict,
    refitted: Callable[[ScoredModel], CandidateModel] = lambda found: found.model,
) -> tuple[Discovery, Simulation]:
    """Write down what was found.

    refitted: fits the numbers once more; the runs that are shown stay those of the search
    returns augmented: the simulation with what was found, its numbers written in
    """
    now, base = verdict.found, problem.search.base
    channels = tuple(name for name, _ in base.observations)
    floor, proof = problem.noise_floor(now.noise.size), verdict.proof
    before, after = (runs_of(problem, one, problem.learned, now) for one in (as_read, now))
    train = gap_size(before, after, floor, channels, tested(problem, before, after, now))
    held = proof if proof and now.model.parts else proof_of(problem, as_read, now, now)
    held_out = gap_size(held.before, held.after, floor, channels, (proof or held).test)
    gained = bic_gain(problem.search, now)
    stated = replace(verdict, found=replace(now, model=refitted(now)))
    parts, moved = stated.found.model.parts, corrections_of(stated.found.model, base)
    effects = effects_of(problem, stated, 1 - held_out.unexplained, gained)
    discovery = Discovery(
        verdict.word,
        "",
        whereabouts(problem, stated, train),
        effects,
        (*reported_rivals(problem, rivals_of(problem.search, now, verdict.rivals, gained)), *small_ones(verdict.small)),
        train,
        held_out,
        channels,
        units_of(problem),
        drawn_runs(problem, held.before, held.after),
        (*problem.measured.findings, *nearly_off(effects, problem.measured.source)),
        corrections=moved,
    )
    augmented = begun_at(augmented_of(corrected(base, moved), parts), verdict.starts)
    said = sentence_of(discovery, base, parts)
    return replace(said, sentence=" ".join([said.sentence, *left_out(problem.measured.findings)])), augmented


def left_out(findings: tuple[Finding, ...]) -> list[str]:
    """Say which trials were left out, and why."""
    return [f"{one.what[0].upper()}{one.what[1:]}; it was left out." for one in findings if one.kind == ODD_TRIAL]


def effects_of(problem: Problem, verdict: Verdict, closed: float, gained: float) -> tuple[FoundEffect, ...]:
    """List what was found: a random push, wrong starts, or the explanations that were selected."""
    if verdict.process_noise:
        place, push = verdict.process_noise.place, push_of(problem, verdict.process_noise)
        return (FoundEffect(place.kind, place.name, "process_noise", "", {"strength": push}),)
    if verdict.starts:
        return tuple(
            FoundEffect("state", name, "wrong_initial_condition", "", {"initial": start})
            for name, start in verdict.starts.items()
        )
    found = found_effects(problem, verdict.found, closed, gained)
    if verdict.read:
        (part,) = verdict.found.model.parts
        expression = part.candidate.term({slot: f"{value:.{DIGITS}g}" for slot, value in part.values.items()})
        found = [replace(found[0], reads_as=expression, reads_as_effect=verdict.reads_as)]
    return tuple(found)


def push_of(problem: Problem, process_noise: ProcessNoise) -> Estimate:
    """Return the standard deviation of a random push, in the unit of its place."""
    unit = places_unit(problem.search.base, process_noise.place.kind, process_noise.place.name)
    return Estimate(process_noise.strength, np.nan, np.nan, unit)


def augmented_of(base: Simulation, parts: tuple[Part, ...]) -> Simulation:
    """Return a simulation with explanations in it, their numbers written in."""
    for part in parts:
        base = part.candidate.written(base, part.written)
    return base


def found_effects(problem: Problem, now: ScoredModel, closed: float, gained: float) -> list[FoundEffect]:
    """List the explanations with their numbers and intervals."""
    found = []
    for number, part in enumerate(now.model.parts):
        candidate = part.candidate
        estimates = estimates_of(now.model, number, problem.search.base)
        place = (candidate.kind, candidate.place, candidate.name)
        found.append(
            FoundEffect(
                *place,
                part.term,
                estimates,
                closed,
                gained,
                bounds=file_bounds(problem.search.base, candidate),
                states=candidate.states_at(part.written),
            )
        )
    return found


def reported_rivals(problem: Problem, rivals: tuple[Rival, ...]) -> tuple[FoundEffect, ...]:
    """List what else was weighed, with its numbers."""
    listed = []
    for rival in rivals:
        candidate, model = rival.part.candidate, rival.scored.model
        estimates = estimates_of(model, len(model.parts) - 1, problem.search.base)
        place = (candidate.kind, candidate.place, candidate.name)
        listed.append(
            FoundEffect(
                *place,
                "",
                estimates,
                bic=rival.gained,
                tied=rival.tied,
                bounds=file_bounds(problem.search.base, candidate),
            )
        )
    return tuple(listed)


def small_ones(parts: tuple[Part, ...]) -> tuple[FoundEffect, ...]:
    """List explanations that close too little of the gap to be named."""
    return tuple(
        FoundEffect(part.candidate.kind, part.candidate.place, part.candidate.name, part.term, small=True)
        for part in parts
    )


def whereabouts(problem: Problem, verdict: Verdict, train: GapSize) -> tuple[Whereabouts, ...]:
    """Say where the gap arises.

    train: the gap before and after on the trials that were learned from
    """
    if verdict.process_noise:
        return (Whereabouts(verdict.process_noise.place.kind, verdict.process_noise.place.name, float("nan")),)
    if verdict.starts:
        return tuple(Whereabouts("state", name, float("nan")) for name in verdict.starts)
    now = verdict.found
    share = (train.before**2 - train.after**2) / train.before**2 if train.before > 0 else 0.0
    return tuple(
        Whereabouts(
            part.candidate.kind,
            part.candidate.place,
            share / len(now.model.parts),
            phase_of(problem, now, part),
            region_of(part),
        )
        for part in now.model.parts
    )


def phase_of(problem: Problem, now: ScoredModel, part: Part) -> tuple[float, ...]:
    """Return the part of the stride in which an effect is at least half as strong as at its strongest."""
    names = [one.name for one in problem.search.base.inputs]
    if "phase" not in names or part.candidate.verdict != "missing_physics":
        return ()
    term = part.candidate.term({slot: f"{value:.9g}" for slot, value in part.values.items()})
    if "delay(" in term:
        return ()
    segments, drive, fit = now.shooting.segments, problem.measured.drive, now.model.fit
    inputs = segments.of(drive.inputs)
    time = drive.time0[segments.trial][:, None] + segments.samples / drive.rate
    # run by run: what stands beside the effect may be late, and a delay needs consecutive samples
    runs = [Points(*one, fit.values, rate=drive.rate) for one in zip(time, fit.states, inputs, strict=True)]
    push = np.abs(np.concatenate([evaluate(now.model.simulation, term, run) for run in runs]))
    inputs = inputs.reshape(-1, len(names))
    phase = inputs[:, names.index("phase")]
    bins = np.minimum((phase * 100).astype(int), 99)
    mean = np.bincount(bins, push, 100) / np.maximum(np.bincount(bins, minlength=100), 1)
    strong = np.flatnonzero(mean > HALF * mean.max())
    return (float(strong[0] / 100), float((strong[-1] + 1) / 100)) if strong.size else ()


def region_of(part: Part) -> str:
    """Say in which states an effect acts."""
    candidate = part.candidate
    if candidate.name == "one_sided_spring":
        side = ">" if "- _x0" in candidate.pieces[0] else "<"
        return f"{candidate.role} {side} {part.values['x0']:.4g}"
    if candidate.name == "dead_zone_spring":
        return f"abs({candidate.role}) > {part.values['d']:.4g}"
    return ""


def units_of(problem: Problem) -> tuple[str, ...]:
    """Return the units of the observed channels."""
    base = problem.search.base
    return tuple(unit_of_channel(base, name) for name, _ in base.observations)
