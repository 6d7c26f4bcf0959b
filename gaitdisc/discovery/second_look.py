"""A second look at a verdict on unseen data: the simpler relative of a shape, a delay, or what free runs refuse."""

from dataclasses import replace

import numpy as np

from gaitdisc.discovery.candidate import Candidate
from gaitdisc.discovery.case import Case
from gaitdisc.discovery.criteria import CRITERIA
from gaitdisc.discovery.decision import MOST_NEAR, Verdict, prove_held_out
from gaitdisc.discovery.forward_selection import select_forward
from gaitdisc.discovery.gap_share import cross_validated, errs_more
from gaitdisc.discovery.grids import delays
from gaitdisc.discovery.held_out import free_run_error, gap_size, grows_along_runs, is_uninformative, prove, strays
from gaitdisc.discovery.result import ALPHA
from gaitdisc.discovery.scored_model import Part, ScoredModel, compared, ranked, score
from gaitdisc.discovery.search import TURNS, is_certain, may_vanish

AT_ONCE, LATE = "linear_stiffness", "delayed_feedback"
STEP = 4  # of the delays that a search begins with
# What a shape is where one of its constants vanishes or has no end, or where the motion shows but one side of it
RELATIVES = {
    "one_sided_spring": ("linear_stiffness",),
    "dead_zone_spring": ("linear_stiffness",),
    "one_sided_damper": ("viscous_damping",),
    "contact_damper": ("viscous_damping",),
    "hysteresis": ("coulomb_friction", "linear_stiffness"),
    "series_elasticity": ("linear_stiffness", "viscous_damping"),
    "delayed_feedback": ("linear_stiffness", "viscous_damping"),
    "input_lag": ("wrong_parameter",),
    "product_coupling": ("linear_coupling", "linear_stiffness", "viscous_damping"),
}


def prefer_relatives(case: Case, as_read: ScoredModel, verdict: Verdict) -> Verdict:
    """Return a verdict with the simpler relative of each shape in its place, where this leaves no more of unseen data.

    Where a model leaves mere noise, the likelihood says so; where none does, it prefers whatever is more flexible. What
    relaxes or yields beyond the record's length or range is its relative, or nothing is named.
    """
    shows = case.search.shows
    if verdict.word in ("unnamed", "process_noise", "no_gap") or not verdict.proof:
        return replace(verdict, rivals=tuple(rival for rival in verdict.rivals if shows(rival)))
    for number in range(len(verdict.found.parts)):
        model = verdict.found
        tried = [in_its_place(case, model, number, candidate) for candidate in list_relatives(case, model, number)]
        for now in sorted((model for model in tried if model), key=lambda model: model.bic):
            idle = not shows(model) or may_vanish(model, number)
            if model.parts[number].candidate.kind == "input":  # what is added takes half of what a number leaves
                idle = idle or free_run_error(case, model) > CRITERIA.half * free_run_error(case, now)
            if not idle and is_needed(case, now, model):
                continue
            proof = prove_held_out(case, as_read, now)
            if proof.bears_out:
                verdict = verdict.with_model(now, proof)
                break
    rivals = tuple(rival for rival in verdict.rivals if shows(rival))
    if not shows(verdict.found):
        return Verdict(as_read, rivals, proof=verdict.proof)
    return replace(verdict, rivals=rivals)


def prefer_delay(case: Case, as_read: ScoredModel, verdict: Verdict) -> Verdict:
    """Return a verdict with a feedback that comes late in the place of one at once, where unseen data show the delay.

    Whatever answers with a delay (a person, a controller) looks like a spring to a search that begins without one: run
    freely, the simulation as read leaves the data, and no delay of it says anything. Beside the spring it does not.
    """
    parts = verdict.found.parts
    firsts = {place.motions[0] for place in case.search.places}
    springs = [part for part in parts if part.candidate.name == AT_ONCE and (part.candidate.role, "") in firsts]
    if len(parts) != 1 or not springs or not verdict.proof:
        return verdict
    named, search, at_once = verdict.found, case.search, springs[0].candidate
    begun = [
        Part(candidate, {"factor": springs[0].values["factor"], "d": float(delay)})
        for candidate in search.candidates
        if (candidate.name, candidate.place, candidate.role) == (LATE, at_once.place, at_once.role)
        for delay in delays(case.rhythm)[::STEP]
    ]
    tried = [search.with_others(named, (part,)) for part in begun]
    tried = [model for model in tried if search.sensible(model) and is_certain(model) and not may_vanish(model, 0)]
    if not tried:
        return verdict
    now = replace(min(tried, key=lambda model: model.bic), gained=named.gained)
    _, now = compared([named, now])
    proof = prove_held_out(case, as_read, now)
    if not prove(case, named, now, now).bears_out or not proof.bears_out:
        return verdict
    return verdict.with_model(now, proof)


def look_at_whole_runs(case: Case, as_read: ScoredModel, verdict: Verdict) -> tuple[ScoredModel, Verdict]:
    """Return a verdict whose free runs err no more than the simulation's, with what takes half of what they leave.

    In short runs a part of what is missing leaves mere noise; along whole ones the rest adds up. Where a small change
    of the start grows, free runs say nothing.
    """
    if verdict.word == "process_noise" or verdict.starts or not case.spans_a_period(as_read):
        return as_read, verdict
    base, named = fit_whole_runs(case, as_read), verdict.found
    if not named.parts:
        return base, replace(verdict, found=base)
    most = free_run_error(case, base)
    for model in (named, *verdict.rivals):
        if not model.parts or strays(case, model, most):
            continue
        if model is named:
            return base, complete_on_whole_runs(case, as_read, verdict)
        proof = prove_held_out(case, as_read, model)
        if proof.bears_out:
            return base, verdict.with_model(model, proof)
    return base, Verdict(base, (named, *verdict.rivals), proof=verdict.proof)


def fit_whole_runs(case: Case, now: ScoredModel) -> ScoredModel:
    """Return a model fitted to the learned trials whole, where a small error of a number shows; else as it was.

    All errors weigh alike: the autocorrelation of what short runs leave takes a slow drift away for noise.
    """
    model = case.fit_over(case.longest, now, case.scale.white_error(now.fit))
    return model.with_own_past() if case.search.sensible(model) else now


def complete_on_whole_runs(case: Case, as_read: ScoredModel, verdict: Verdict) -> Verdict:
    """Return a verdict with one explanation more, where this takes half of what free runs of the others leave."""
    model, search = verdict.found, case.search
    if verdict.word == "unnamed" or not grows_along_runs(case, model):
        return verdict
    whole = fit_whole_runs(case, model)
    whole = score(whole)
    own_error = case.scale.excess(whole.fit) < CRITERIA.model_error
    if own_error or case.leaves_noise(whole):
        return verdict
    named, rivals = select_forward(search, whole, len(model.parts) + 1)
    if named is whole:
        return verdict
    tried = [rival for rival in rivals if len(rival.parts) == len(named.parts)]
    left = [(free_run_error(case, rival), rival) for rival in (named, *tried[:MOST_NEAR])]
    least, before = min(error for error, _ in left), min(free_run_error(case, rival) for rival in (model, whole))
    closed = (np.sqrt(before) - np.sqrt(least)) / np.sqrt(free_run_error(case, as_read))
    if least > CRITERIA.half * before or closed < CRITERIA.matters:
        return verdict
    more = ranked([rival for error, rival in left if error <= (1 + CRITERIA.model_error) * least], search.candidates)[0]
    beside, proof = prove_held_out(case, whole, more, as_read), prove_held_out(case, as_read, more)
    if not beside.bears_out or not proof.bears_out:
        return verdict
    return verdict.with_model(more, proof, *tried)


def without_small(case: Case, as_read: ScoredModel, verdict: Verdict) -> Verdict:
    """Return a verdict that names nothing where unseen data err more with it, or hardly less beside what it leaves.

    The gap is that of unseen data above the sensors' noise; data that run alike without it say nothing.
    """
    model, proof = verdict.found, verdict.proof
    if not model.parts or not proof or is_uninformative(case, as_read, model):
        return verdict
    size = gap_size(case, proof, model)
    small = not case.leaves_noise(model) and 1 - np.sqrt(size.unexplained) < CRITERIA.matters
    if size.after <= size.before and not small:
        return verdict
    return Verdict(as_read, (model, *verdict.rivals), proof=proof)


def list_relatives(case: Case, now: ScoredModel, number: int) -> list[Candidate]:
    """List the simpler relatives of one of a model's explanations: at its place, of the same motion."""
    replaced = now.parts[number].candidate
    names, present = RELATIVES.get(replaced.name, ()), now.explanations
    relatives = []
    for candidate in case.search.candidates:
        if candidate.name not in names or candidate.identity in present:
            continue
        same = candidate.role == replaced.role or candidate.pieces[0] in replaced.pieces[0].split("*")
        # a lag of what drives it may be a time constant of the simulation's own
        if replaced.kind == "input" or ((candidate.kind, candidate.place) == (replaced.kind, replaced.place) and same):
            relatives.append(candidate)
    return sorted(relatives, key=lambda one: names.index(one.name))


def in_its_place(case: Case, now: ScoredModel, number: int, relative: Candidate) -> ScoredModel | None:
    """Return a model with a relative in the place of one of its explanations; None where it does not fit."""
    search, fewer = case.search, case.search.without(now, number)
    scores = search.scorer(fewer).scores((relative,))
    if not scores:
        return None
    parts = [*fewer.parts]
    parts.insert(number, scores[0])
    model = fewer.refitted(now.shooting, tuple(parts), now.fit.starts, TURNS)
    return replace(model, gained=now.gained) if search.sensible(model) else None


def is_needed(case: Case, relative: ScoredModel, general: ScoredModel) -> bool:
    """Whether data show that a general shape explains more than its relative."""
    first, second = compared([relative, general])
    if case.leaves_noise(second):
        return first.bic - second.bic > CRITERIA.margin
    proof = prove(case, first, second, second)
    if proof.bears_out:
        return True
    left = [cross_validated(case.scale, model, model.parts) for model in (first, second)]
    return proof.test.fall > 0 and errs_more(*left) < ALPHA
