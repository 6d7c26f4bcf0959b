"""The answer: numbers with intervals, where it acts, how far the gap shrank, and one sentence."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from gaitdisc.discovery.candidate import Candidate
from gaitdisc.discovery.case import Case
from gaitdisc.discovery.criteria import CRITERIA
from gaitdisc.discovery.decision import Verdict
from gaitdisc.discovery.effect_words import amount, spoken
from gaitdisc.discovery.estimates import NORMAL_95, list_estimates
from gaitdisc.discovery.held_out import (
    Proof,
    compare_runs,
    gap_size,
    grows_along_runs,
    prove,
    run_trials,
    tabulate_runs,
)
from gaitdisc.discovery.result import Correction, Discovery, Estimate, Explanation, FoundEffect, GapSize, Whereabouts
from gaitdisc.discovery.scored_model import Part, ScoredModel
from gaitdisc.discovery.search import Search
from gaitdisc.discovery.wording import write_sentence
from gaitdisc.recording import Finding
from gaitdisc.recording.arrays import Values
from gaitdisc.simulation.simulation import Simulation
from gaitdisc.simulation.unit_check import places_unit, unit_of_channel
from gaitdisc.words import with_unit

MOST_EXPLANATIONS = 5
MOST_RIVALS = 6
DRAWN = 200  # samples of a run
NEARLY_OFF = 0.3  # a gain by which little of an input is left
DIGITS = 3  # of the numbers in an expression that a person reads; those of the file are exact


@dataclass(frozen=True)
class Rival:
    """Another explanation of the same data."""

    scored: ScoredModel
    gained: float  # fall of the information criterion from the simulation as read
    tied: bool  # whether these data cannot distinguish it from the answer


def answer(
    case: Case,
    as_read: ScoredModel,
    verdict: Verdict,
    refitted: Callable[[ScoredModel], ScoredModel] = lambda model: model,
) -> tuple[Discovery, Simulation]:
    """Write down what was found.

    refitted: fits the numbers once more; the runs that are shown stay those of the search
    """
    now, base, proof = verdict.found, case.search.base, verdict.proof
    train = gap_size(case, prove(case, as_read, now, now, case.learned), now)
    held = proof if proof and now.parts else prove(case, as_read, now, now)
    of = f"trial {', '.join(case.measured.trials[number] for number in case.held_out)}"
    held_out = replace(gap_size(case, replace(held, test=(proof or held).test), now), of=of)
    gained = case.search.with_others(now, ()).bic - now.bic if now.parts else 0.0
    rivals = weigh_rivals(case.search, now, verdict.rivals, gained)
    stated = replace(verdict, found=refitted(now))
    parts, moved = stated.found.parts, list_corrections(stated.found, base)
    effects = list_effects(case, stated, 1 - held_out.unexplained, gained)
    if verdict.given:
        effects = tuple(replace(effect, small=idle) for effect, idle in zip(effects, verdict.given, strict=True))
    named = (Explanation(effects, held_out, *first_run(case, held.after, held_out)),) if effects else ()
    agrees = verdict.word != "no_gap" or not grows_along_runs(case, as_read)
    discovery = Discovery(
        verdict.word if agrees else "unexplained",
        "",
        where=whereabouts(case, stated, effects, train) if effects or not agrees else (),
        effects=effects,
        rivals=(
            *(report_rival(case, rival) for rival in rivals if rival.scored.labels[-1] not in now.labels),
            *(
                FoundEffect(part.candidate.kind, part.candidate.place, part.candidate.name, part.term, small=True)
                for part in verdict.small  # that close too little of the gap to be named
            ),
        ),
        train=train,
        held_out=held_out,
        channels=case.measured.channels,
        units=tuple(unit_of_channel(base, name) for name in case.measured.channels),
        runs=tabulate_runs(case, held.before, held.after),
        findings=(*case.measured.findings, *nearly_off(effects, case.measured.source), *exact_inputs(case, now)),
        corrections=moved,
        explanations=(*named, *list_explanations(case, verdict, held, held_out, rivals))[:MOST_EXPLANATIONS],
        given=("proven" if held.bears_out and not all(verdict.given) else "refuted") if verdict.given else "",
    )
    starts = {name: float(f"{start.value:.6g}") for name, start in verdict.starts.items()}
    corrected = base.with_values({each.parameter: each.found.value for each in moved})
    augmented = augment_with(corrected, parts).with_starts(starts)
    return write_sentence(discovery, base, parts), augmented


def list_effects(case: Case, verdict: Verdict, closed: float, gained: float) -> tuple[FoundEffect, ...]:
    """List what was found: a random push, wrong starts, or the explanations that were selected."""
    if verdict.process_noise:
        place = verdict.process_noise.place
        unit = places_unit(case.search.base, place.kind, place.name)
        push = Estimate(verdict.process_noise.strength, np.nan, np.nan, unit)
        return (FoundEffect(place.kind, place.name, "process_noise", "", {"strength": push}),)
    if verdict.starts:
        return tuple(
            FoundEffect("state", name, "wrong_initial_condition", "", {"initial": start})
            for name, start in verdict.starts.items()
        )
    parts = verdict.found.parts
    effects = [replace(_effect(case, verdict.found, n), held_out=closed, bic=gained) for n in range(len(parts))]
    if verdict.reads_as is not None:
        (part,) = parts
        expression = part.candidate.term({slot: f"{value:.{DIGITS}g}" for slot, value in part.values.items()})
        effects = [replace(effects[0], reads_as=expression, reads_as_effect=verdict.reads_as)]
    return tuple(effects)


def augment_with(base: Simulation, parts: tuple[Part, ...]) -> Simulation:
    """Return a simulation with explanations in it, their numbers written in."""
    for part in parts:
        base = part.candidate.written(base, part.written)
    return base


def report_rival(case: Case, rival: Rival, part: int = -1) -> FoundEffect:
    """Say one of a rival's explanations, the last by default, with its numbers."""
    return replace(_effect(case, rival.scored, part), term="", states={}, bic=rival.gained, tied=rival.tied)


def _effect(case: Case, now: ScoredModel, number: int) -> FoundEffect:
    """Return one of a model's explanations with its numbers."""
    part, base = now.parts[number], case.search.base
    what, estimates = part.candidate, list_estimates(now, number, base)
    bounds, states = file_bounds(base, what), what.states_at(part.written)
    return FoundEffect(what.kind, what.place, what.name, part.term, estimates, bounds=bounds, states=states)


def weigh_rivals(search: Search, now: ScoredModel, tried: tuple[ScoredModel, ...], gained: float) -> tuple[Rival, ...]:
    """Weigh other explanations against an answer: alone, and in the place of each that the answer is made of.

    now: the simulation with what was found; without any explanation, rivals keep the criterion that they were found
        with
    returns: best first; none of them is of the same effects at the same places as the answer
    """
    named = sorted(now.labels)
    others: dict[tuple[str, ...], ScoredModel] = {}
    for scored in tried:
        if scored.parts and sorted(scored.labels) != named:
            others.setdefault(tuple(sorted(scored.labels)), scored)
    adding = {labels for labels in others if named and set(named) < set(labels)}  # no other answer: they only add to it
    listed = [others[labels] for labels in sorted(others, key=lambda labels: labels in adding)][:MOST_RIVALS]
    if not named:
        return tuple(Rival(model, model.gained, False) for model in listed)
    fitted: dict[tuple[str, ...], ScoredModel] = {}
    for scored in listed:
        parts, sets = now.parts, [scored.parts]
        if scored.labels[-1] not in named:  # its last explanation alone, as it was, or beside the answer's but one
            last = scored.parts[-1]
            beside = [(*parts[:k], *parts[k + 1 :], last) for k in range(len(parts))] if len(parts) > 1 else []
            sets = [(last,), *(sets if len(sets[0]) > 1 else []), *beside]
        best = min((search.with_others(now, each) for each in sets), key=lambda model: model.bic)
        fitted.setdefault(tuple(sorted(best.labels)), best)
    rivals = []
    for model in fitted.values():
        behind, adds = model.bic - now.bic, set(named) < set(model.labels)
        rivals.append(Rival(model, gained - behind, behind < CRITERIA.tie and not adds))
    return tuple(sorted(rivals, key=lambda rival: -rival.gained))


def list_explanations(
    case: Case, verdict: Verdict, held: Proof, size: GapSize, rivals: tuple[Rival, ...]
) -> list[Explanation]:
    """List what else was weighed by what it leaves of the held-out data, the least first."""
    ordered: list[tuple[float, Explanation]] = []
    for rival in rivals:
        after = run_trials(case, rival.scored, case.held_out, verdict.found)
        effects = tuple(report_rival(case, rival, number) for number in range(len(rival.scored.parts)))
        test = compare_runs(case, held.before, after, verdict.found)
        left = gap_size(case, Proof(held.before, after, test), verdict.found)
        explanation = Explanation(effects, replace(left, of=size.of), *first_run(case, after, size))
        ordered.append((float(np.nan_to_num(left.after, nan=np.inf)), explanation))
    return [explanation for _, explanation in sorted(ordered, key=lambda rival: rival[0])]


def first_run(case: Case, after: ScoredModel, size: GapSize) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Return times [s] of the first held-out run, and measured minus run of the channel with the largest gap."""
    left = after.fit.residual[0, :DRAWN, [*size.channels].index(size.ranked[0])]
    segments = after.shooting.segments
    time = segments.samples[0, segments.compared][:DRAWN] / case.measured.rate
    return tuple(time.tolist()), tuple(left.tolist())


def whereabouts(
    case: Case, verdict: Verdict, effects: tuple[FoundEffect, ...], train: GapSize
) -> tuple[Whereabouts, ...]:
    """Say where the gap arises; train: the gap before and after on the training trials."""
    now = verdict.found
    if verdict.process_noise or verdict.starts or not now.parts:
        named = effects or [rival.parts[0].candidate for rival in verdict.rivals[:1] if rival.parts]
        return tuple(Whereabouts(effect.kind, effect.place, float("nan")) for effect in named)
    share = (train.before**2 - train.after**2) / train.before**2 if train.before > 0 else 0.0
    share /= len(now.parts)
    return tuple(
        Whereabouts(part.candidate.kind, part.candidate.place, share, find_phase(case, now, part), find_region(part))
        for part in now.parts
    )


def push_along(case: Case, now: ScoredModel, part: Part) -> Values | None:
    """Return how strongly an effect acts along the fitted runs (run, sample); None if it is late or no term."""
    term = part.candidate.term({slot: f"{value:.9g}" for slot, value in part.values.items()})
    if part.candidate.verdict != "missing_physics" or "delay(" in term:
        return None
    return np.abs(case.search.scorer(now).along([term])[..., 0])


def find_phase(case: Case, now: ScoredModel, part: Part) -> tuple[float, ...]:
    """Return the part of the stride in which an effect is at least half as strong as at its strongest."""
    names = [signal.name for signal in case.search.base.inputs]
    push = push_along(case, now, part) if "phase" in names else None
    if push is None:
        return ()
    phase = now.shooting.segments.of(case.measured.drive.inputs)[:, :, names.index("phase")].ravel()
    bins = np.minimum((phase * 100).astype(int), 99)
    mean = np.bincount(bins, push.ravel(), 100) / np.maximum(np.bincount(bins, minlength=100), 1)
    strong = np.flatnonzero(mean > CRITERIA.half * mean.max())
    return (float(strong[0] / 100), float((strong[-1] + 1) / 100)) if strong.size else ()


def exact_inputs(case: Case, now: ScoredModel) -> tuple[Finding, ...]:
    """Say how large an error of the inputs would explain a missing term as well: they were taken as exact."""
    base, findings = case.search.base, []
    for part in now.parts:
        push, candidate = push_along(case, now, part), part.candidate
        if push is None:
            continue
        unit = places_unit(base, candidate.kind, candidate.place)
        like = [repr(signal.name) for signal in base.driving if signal.unit == unit and not (signal.sd or signal.gain)]
        if like:
            size = with_unit(amount(float(np.sqrt(np.mean(push**2)))), unit)
            what = (
                f"an error of {size} (rms) in {' or '.join(like)}, with the time course of the "
                f"{spoken(candidate.name)}, would explain the gap as well; the inputs were assumed to be exact"
            )
            spoils = "which effect is named, if an input has this error"
            findings.append(Finding("note", "exact inputs", case.measured.source, what, spoils))
    return tuple(findings)


def nearly_off(effects: tuple[FoundEffect, ...], source: str) -> tuple[Finding, ...]:
    """Warn where an answer takes several inputs nearly away: what nothing acts on follows its record by itself."""
    gains = {
        effect.place: effect.estimates["gain"].value
        for effect in effects
        if effect.name == "input_gain" and abs(effect.estimates["gain"].value) < NEARLY_OFF
    }
    if len(gains) < 2:
        return ()
    what = " and ".join(f"{name!r} (gain {gain:.2g})" for name, gain in gains.items()) + " are nearly switched off"
    spoils = "the answer, if the simulation follows a recorded motion; combine signals of one recording into one input"
    return (Finding("warning", "inputs switched off", source, what, spoils),)


def find_region(part: Part) -> str:
    """Say in which states an effect acts."""
    candidate = part.candidate
    if candidate.name == "one_sided_spring":
        side = ">" if "- _x0" in candidate.pieces[0] else "<"
        return f"{candidate.role} {side} {part.values['x0']:.4g}"
    if candidate.name == "dead_zone_spring":
        return f"abs({candidate.role}) > {part.values['d']:.4g}"
    return ""


def list_corrections(model: ScoredModel, base: Simulation) -> tuple[Correction, ...]:
    """List the numbers that were fitted within their bounds and moved, each with its 95 % interval inside these."""
    prior, free = model.fit.prior, model.fit.free
    error = np.sqrt(np.diag(model.fit.covariance))
    units, moved = {parameter.name: parameter.unit for parameter in base.parameters}, []
    for name, place, given, low, high in zip(
        prior.names, prior.places, prior.value, prior.low, prior.high, strict=True
    ):
        value, half = float(f"{model.fit.values[place]:.6g}"), NORMAL_95 * float(error[free.index(name)])
        if value != float(f"{given:.6g}"):
            interval = max(value - half, float(low)), min(value + half, float(high))
            moved.append(Correction(name, float(given), Estimate(value, *interval, units[name])))
    return tuple(moved)


def file_bounds(base: Simulation, candidate: Candidate) -> tuple[float, ...]:
    """Return the bounds that the file gives a wrong parameter, infinite where it has but one."""
    for parameter in base.parameters if candidate.verdict == "wrong_parameter" else ():
        if parameter.name == candidate.place and (parameter.low is not None or parameter.high is not None):
            return (
                -np.inf if parameter.low is None else parameter.low,
                np.inf if parameter.high is None else parameter.high,
            )
    return ()
