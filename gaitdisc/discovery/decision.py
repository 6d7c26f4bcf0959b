"""Which of the verdicts the data support: searched, ranked, tested on what was held out."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from gaitdisc.discovery.beam import MOST, closing_most
from gaitdisc.discovery.case import Case
from gaitdisc.discovery.criteria import CRITERIA
from gaitdisc.discovery.estimates import wrong_starts
from gaitdisc.discovery.fitted import Prior
from gaitdisc.discovery.fitted_shape import fit_shape
from gaitdisc.discovery.forward_selection import prune, select_forward
from gaitdisc.discovery.gap_share import cross_validated
from gaitdisc.discovery.held_out import Proof, free_run_error, free_runs, is_uninformative, prove, strays
from gaitdisc.discovery.process_noise import MOST_NUMBERS, ProcessNoise, rank_process_noise
from gaitdisc.discovery.result import Estimate
from gaitdisc.discovery.scored_model import Part, ScoredModel, compared, ranked, score
from gaitdisc.discovery.search import is_certain

MOST_NAMES = 2  # where they leave more than noise; where they leave nothing else, MOST
MOST_NEAR = 4


@dataclass(frozen=True)
class Verdict:
    """What the search came to."""

    found: ScoredModel  # the simulation with what was found in it
    rivals: tuple[ScoredModel, ...]
    process_noise: ProcessNoise | None = None  # for process noise: where, and how strong
    starts: dict[str, Estimate] = field(default_factory=dict)  # for wrong initial conditions: where the trials begin
    # Held-out runs that bear the model out; where nothing is named, those that do not bear the first rival out
    proof: Proof | None = None
    small: tuple[Part, ...] = ()  # explanations that close too little of the gap to be named
    # of a shape read as an expression of few pieces: the catalogue's effect that this is, empty where it is none
    reads_as: str | None = None
    # of explanations that a person gave, and none was searched: whether held-out data do without each beside the others
    given: tuple[bool, ...] = ()

    @property
    def word(self) -> str:
        """Which of the contract's verdicts it is, but for `unexplained`, which is seen in free runs alone."""
        if self.process_noise or self.starts:
            return "process_noise" if self.process_noise else "wrong_initial_condition"
        return self.found.word if self.found.parts else "no_gap"

    def with_model(self, model: ScoredModel, proof: Proof, *others: ScoredModel) -> Verdict:
        """Return the verdict on another model; this one's is its first rival, others follow."""
        return replace(self, found=model, rivals=(self.found, *others, *self.rivals), proof=proof)


def decide(case: Case, as_read: ScoredModel) -> Verdict:
    """Search, and decide which of the contract's verdicts the data support."""
    as_read, named, rivals = search_runs(case, as_read)
    named = keep_on_longer_runs(case, as_read, named)
    exact = case.leaves_noise(named)
    plain = None if exact else plainest(case, named)
    if plain:
        plain = replace(plain, rivals=(*plain.rivals, *rivals))
        return shape_that_leaves_noise(case, as_read, fit_shape(case, as_read), plain) or plain
    names = len(named.parts)
    suspect = named.noise.is_autocorrelated and not (exact and case.search.base.inexact)
    wanted = names > 1 or suspect
    shape = fit_shape(case, as_read) if wanted else None
    autocorrelated = with_autocorrelation(case, as_read, named, shape, rivals) if suspect or not names else None
    if autocorrelated:
        return autocorrelated
    if shape and not exact and (names > MOST_NAMES or (names > 1 and says_more(shape, named))):
        unnamed = proven_shape(case, as_read, shape, (named, *rivals))
        if unnamed:
            return unnamed
    if not names:
        return Verdict(as_read, tuple(rivals), starts=wrong_starts(case.search.base, as_read))
    longer, rivals = refit_longer(case, named if exact else prune(case.search, named, np.inf, MOST_NAMES), rivals)
    kept = keep_useful(case, as_read, longer)
    if kept is not longer:  # named anew: the best of fewer is not the best less a part
        alone = refit_longer(case, rivals[0], rivals) if rivals else (kept, rivals)
        if alone[0] is kept or (len(kept.parts) > 1 and prove(case, alone[0], kept, kept).bears_out):
            longer = score(kept)
        else:
            longer, rivals = alone
    proof = prove_held_out(case, as_read, longer)
    if not proof.bears_out or (not exact and names > MOST_NAMES and proof.closed < CRITERIA.half):
        blind = is_uninformative(case, as_read, longer)
        pushed = None if blind else with_random_pushes(case, as_read, as_read, [])
        return pushed or Verdict(as_read, (longer, *rivals), proof=proof)
    verdict = Verdict(longer, tuple(rivals), proof=proof)
    if not wanted and not case.leaves_noise(longer):
        shape = fit_shape(case, as_read)
    return shape_that_leaves_noise(case, as_read, shape, verdict) or verdict


def shape_that_leaves_noise(
    case: Case, as_read: ScoredModel, shape: ScoredModel | None, names: Verdict
) -> Verdict | None:
    """Return the verdict on one shape without a name that leaves mere noise and that unseen data prefer to names.

    Held-out data prefer it beyond chance, and in free runs as well: several names can imitate one law that has none. A
    single name that leaves mere noise stands.
    """
    named = names.found
    if shape is None or not case.leaves_noise(shape) or (len(named.parts) == 1 and case.leaves_noise(named)):
        return None
    if free_run_error(case, shape) > free_run_error(case, named) or not prove_held_out(case, named, shape).bears_out:
        return None
    return proven_shape(case, as_read, shape, (named, *names.rivals))


def proven_shape(
    case: Case, as_read: ScoredModel, shape: ScoredModel, others: tuple[ScoredModel, ...]
) -> Verdict | None:
    """Return the verdict on a shape without a name that the held-out data bear out; None where they do not."""
    proof = prove_held_out(case, as_read, shape)
    return Verdict(shape, others, proof=proof) if proof.bears_out else None


def keep_useful(case: Case, as_read: ScoredModel, now: ScoredModel) -> ScoredModel:
    """Return what was named without the explanations that the held-out data do not bear out beside the others."""
    while len(now.parts) > 1:
        fewer = [case.search.without(now, number) for number in range(len(now.parts))]
        tests = [prove_held_out(case, model, now, as_read).test for model in fewer]
        idle = max(range(len(fewer)), key=lambda number: np.nan_to_num(tests[number].p, nan=1.0))
        if tests[idle].bears_out:
            break
        now = fewer[idle]
    return now


def plainest(case: Case, named: ScoredModel) -> Verdict | None:
    """Return the verdict on the plainest explanations that close most of the gap; None where these close too little."""
    closing = closing_most(case, (named.parts,) if named.parts else ())
    if closing is None or closing.closed < CRITERIA.half:
        return None
    closing = replace(closing, now=prefer_on_held_out(case, closing.now, closing.near))
    plain, likelier = compared([closing.as_read, closing.now])
    if likelier.bic > plain.bic:  # unseen data decide; what was learned from must not speak against it
        return None
    now = keep_useful(case, closing.as_read, closing.now)
    fit, names = now.fit, now.size
    known = fit.starts.shape[1] + names  # names that cancel each other do so whatever the file's numbers are
    alone = replace(fit, free=fit.free[:names], slopes=fit.slopes[..., :known], prior=Prior())
    if not is_certain(replace(now, fit=alone)):
        return None
    proof = prove_held_out(case, closing.as_read, now)
    if now is closing.now and proof.closed > CRITERIA.half and not proof.bears_out:  # few pieces are held out
        proof = replace(proof, test=closing.test)
    if not proof.bears_out:
        return None
    likeliest = (named,) if case.search.base.inexact else ()  # what it errs by may choose between two like names
    return Verdict(now, (closing.now, *likeliest, *closing.others), proof=proof, small=closing.small)


def prefer_on_held_out(case: Case, now: ScoredModel, near: tuple[ScoredModel, ...]) -> ScoredModel:
    """Return the plainest near model with no more numbers that held-out data prefer beyond chance; else `now`."""
    equal = [model for model in near if model.size <= now.size]
    proofs = [prove(case, now, model, model) for model in equal]
    better = [
        (model.penalty, -proof.test.fall, model)
        for proof, model in zip(proofs, equal, strict=True)
        if proof.bears_out and proof.test.p < case.alpha / len(equal)
    ]
    return min(better, key=lambda rank: rank[:2])[2] if better else now


def search_runs(case: Case, as_read: ScoredModel) -> tuple[ScoredModel, ScoredModel, list[ScoredModel]]:
    """Search short runs, or longer ones if these show nothing without chaos: as read, named (same runs), rivals."""
    named, rivals = select_forward(case.search, as_read, MOST, case.scale)
    if named.parts or not case.spans_a_period(as_read):
        return as_read, named, rivals
    longer = case.lengthen(as_read)
    if longer is as_read:
        return as_read, named, rivals
    named, rivals = select_forward(case.search, longer, MOST, case.scale)
    return (longer, named, rivals) if named.parts else (as_read, as_read, rivals)


def keep_on_longer_runs(case: Case, as_read: ScoredModel, named: ScoredModel) -> ScoredModel:
    """Return what was selected less what longer runs have no use for, on the runs that it was found on.

    Where chaos keeps runs short, several explanations together can do what one does with another number.
    """
    if len(named.parts) < 2 or case.spans_a_period(as_read):
        return named
    longer = case.lengthen(named)
    kept = prune(case.search, longer, CRITERIA.margin).parts
    if len(kept) == len(named.parts):
        return named
    return score(named.refitted(named.shooting, kept))


def with_autocorrelation(
    case: Case, as_read: ScoredModel, named: ScoredModel, shape: ScoredModel | None, rivals: list[ScoredModel]
) -> Verdict | None:
    """Return a verdict where residuals are autocorrelated, and process noise or a shape explain it better."""
    plain, *fits = compared([as_read, named, *([shape] if shape else [])])
    likelier = [model for model in fits if model.parts and plain.bic - model.bic >= CRITERIA.margin]
    ordered = [model for model in likelier if prove_held_out(case, plain, model).bears_out]
    if not ordered:
        return with_random_pushes(case, as_read, named, rivals)
    worth = CRITERIA.matters * (plain.bic - fits[0].bic) + CRITERIA.margin
    if shape and fits[1] in ordered and fits[1].bic < fits[0].bic - worth:
        return Verdict(fits[1], (named, *rivals), proof=prove_held_out(case, plain, fits[1]))
    return None


def with_random_pushes(
    case: Case, as_read: ScoredModel, named: ScoredModel, rivals: list[ScoredModel]
) -> Verdict | None:
    """Return the verdict on random pushes, or on a term that goes before them; None where they explain nothing.

    The runs, or free runs of unseen data, where pushes add up, must err by more than noise and a simulation may.
    """
    (error, doubt), scale = free_runs(case, as_read), case.scale
    own_error = case.leaves_noise(as_read) or scale.excess(as_read.fit) < CRITERIA.model_error
    noise = case.noise_floor(as_read.noise.size) / scale.spread
    if own_error and error - doubt - np.mean(noise**2) < CRITERIA.model_error**2:
        return None
    longer = runs_that_pushes_move(case, as_read)
    pushes = rank_process_noise(longer, case.search.places)
    if not pushes[0].rival - pushes[0].bic > CRITERIA.margin + 2 * np.log(len(pushes)):  # noise of the sensors does it
        return None
    return find_term_before(case, as_read, named, rivals) or Verdict(as_read, tuple(rivals), pushes[0])


def find_term_before(case: Case, as_read: ScoredModel, named: ScoredModel, rivals: list[ScoredModel]) -> Verdict | None:
    """Return the verdict on the term that goes before random pushes; None where none does.

    Random pushes explain anything, so that a term that is likelier than these goes before them: with noise of the
    sensors, or with pushes beside it, over the same numbers by the same criterion, and over what is held out. All is
    weighed by its size, with its autocorrelation, and one term was picked among all that were open. A term with states
    of its own begins each held-out run where it suits: free runs must not stray with it.
    """
    pushes = rank_process_noise(as_read, case.search.places)[0]
    scale, among = case.scale, len(case.search.candidates)
    span = as_read.shooting.segments.span
    others = [rival for rival in rivals if rival.labels != named.labels and rival.bic < named.bic + CRITERIA.support]
    others = [model for model in others if model.shooting.segments.span == span]
    borne: list[tuple[float, ScoredModel, Proof]] = []
    for model in (named, *others[:MOST_NEAR]):
        before, now = compared([as_read, model])
        beside = rank_process_noise(now, case.search.places)[0]
        likelier = pushes.bic - min(beside.bic, beside.rival) - now.size * float(np.log(beside.numbers))
        proof = prove_held_out(case, before, now)
        likelier += proof.gained - 2 * float(np.log(among))
        stays = not case.spans_a_period(as_read) or not strays(case, now, free_run_error(case, before))
        if model.parts and likelier > CRITERIA.margin and stays:
            pair = [cross_validated(scale, now, each.parts) for each in (before, now)]
            if pair[0].errors.sum() > pair[1].errors.sum():  # of pieces left out of the fit
                borne.append((likelier, now, proof))
    if not borne:
        return None
    likelier, now, proof = max(borne, key=lambda row: row[0])
    if not proof.bears_out:  # what is held out hardly shows it: all data together
        proof = replace(proof, test=replace(proof.test, p=float(np.exp(-likelier / 2))))
    return Verdict(now, (now, *(rival for rival in (named, *rivals) if rival.labels != now.labels)), proof=proof)


def says_more(shape: ScoredModel, named: ScoredModel) -> bool:
    """Whether one shape without a name explains more than several names together."""
    named, shape = compared([named, shape])
    return shape.bic < named.bic - CRITERIA.margin


def refit_longer(case: Case, named: ScoredModel, rivals: list[ScoredModel]) -> tuple[ScoredModel, list[ScoredModel]]:
    """Return what was named, fitted to long runs; where a rival comes near, the one that long runs prefer."""
    longer = case.lengthen(named)
    if len(named.parts) > 1:
        return longer, rivals
    near = [rival for rival in rivals if rival is not named and rival.bic < named.bic + CRITERIA.support][:MOST_NEAR]
    near = [case.lengthen(model, longer.shooting.segments.span) for model in near]
    near = [model for model in near if model.shooting.segments.span == longer.shooting.segments.span]
    first, *others = ranked(compared([longer, *near]), case.search.candidates)
    others = [replace(model, gained=first.gained + first.bic - model.bic) for model in others]
    decided_on = {model.labels for model in (first, *others)}
    return first, [first, *others, *(rival for rival in rivals if rival.labels not in decided_on)]


def runs_that_pushes_move(case: Case, as_read: ScoredModel) -> ScoredModel:
    """Return the simulation as read on runs so long that pushes add up; in chaos, on those of the search."""
    fit = as_read.fit
    samples = min(case.longest, MOST_NUMBERS // fit.residual.shape[2])
    if samples < 2 * as_read.shooting.segments.span or not case.spans_a_period(as_read):
        return as_read
    model = case.fit_over(samples, as_read, as_read.noise)
    return model if np.isfinite(model.fit.misfit) else as_read


def prove_held_out(case: Case, before: ScoredModel, now: ScoredModel, as_read: ScoredModel | None = None) -> Proof:
    """Test on the held-out trials whether the error falls with what was found.

    Over runs as long as it was fitted to, which show a small effect best; where chaos makes these too long, over those
    that the search began with will do.

    as_read: the simulation as read, on the runs that the search began with; `before` where absent
    """
    proof, first = prove(case, before, now, now), as_read or before
    if proof.bears_out or case.spans_a_period(first):
        return proof
    shorter = prove(case, before, now, replace(first, shooting=first.shooting.with_noise(now.noise)))
    return shorter if shorter.bears_out else proof
