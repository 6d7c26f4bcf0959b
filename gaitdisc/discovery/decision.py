"""Which of the verdicts the data support: searched, weighed, tested on what was held out."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from gaitdisc.discovery.account import account_for
from gaitdisc.discovery.beam import MOST
from gaitdisc.discovery.by_share import closing_most, leaves_noise, scale_of
from gaitdisc.discovery.evidence import Judged, compared, judged
from gaitdisc.discovery.fitted_shape import fitted_shape
from gaitdisc.discovery.gap_share import GapScale
from gaitdisc.discovery.growth import grown, pruned
from gaitdisc.discovery.held_out import Proof, proof_of
from gaitdisc.discovery.inquiry import Inquiry
from gaitdisc.discovery.nameless import NAME as NAMELESS
from gaitdisc.discovery.ranking import MARGIN, ranked
from gaitdisc.discovery.search import Search
from gaitdisc.discovery.shaken import Shaken, shaken
from gaitdisc.discovery.verdict import Verdict
from gaitdisc.discovery.wrong_start import wrong_starts

MOST_NAMES = 2  # where they leave more than noise; where they leave nothing else, MOST
NEAR = 40.0  # by which a rival's evidence may be worse and still be tried on long runs
MOST_NEAR = 4
REPEATS = 0.2  # of the misfit, which something that repeats itself has to take away where random pushes would do
PUSHED = 0.03  # by which random pushes must be likelier than a sensor's own memory, for each number
HALF = 0.5  # of the held-out squared error, which names must take where more were found than are named
WORTH = 0.05  # of what was named, which a shape without a name must explain beyond it


def judge(inquiry: Inquiry, as_read: Judged) -> Verdict:
    """Search, and decide which of the contract's verdicts the data support."""
    scale = scale_of(inquiry)
    as_read, named, rivals = searched(inquiry, as_read, scale)
    named = lasting(inquiry, as_read, named)
    exact = leaves_noise(inquiry, named)
    plain = None if exact else plainest(inquiry, scale, named)
    if plain:
        return shape_that_leaves_noise(inquiry, as_read, scale, plain) or plain
    wanted = len(named.account.parts) > 1 or named.noise.remembers
    shape = fitted_shape(as_read, inquiry.search, scale) if wanted else None
    remembered = weighed_with_memory(inquiry, as_read, named, shape, rivals) if named.noise.remembers else None
    if remembered and not (remembered.word == "process_noise" and scale.agrees(as_read.account.fit)):
        return remembered
    names = len(named.account.parts)
    if shape and not exact and (names > MOST_NAMES or (names > 1 and says_more(inquiry, shape, named))):
        unnamed = proven_shape(inquiry, as_read, shape, (named, *rivals))
        if unnamed:
            return unnamed
    if not names:
        wrong = wrong_starts(inquiry.search.base, as_read)
        return Verdict("wrong_initial_condition" if wrong else "no_gap", as_read, tuple(rivals), starts=wrong)
    longer, rivals = decided(inquiry, named if exact else strongest(inquiry.search, named), rivals)
    kept = needed(inquiry, as_read, longer)
    if len(kept.account.parts) == 1 < len(longer.account.parts) and rivals:
        longer, rivals = decided(inquiry, rivals[0], rivals)
    elif kept is not longer:
        longer = judged(kept.shooting, inquiry.search.base, kept.account)
    proof = borne_out(inquiry, as_read, longer)
    if not proof.bears_out or (not exact and names > MOST_NAMES and proof.closed < HALF):
        return Verdict("no_gap", as_read, (longer, *rivals), proof=proof)
    return Verdict(longer.account.parts[0].candidate.verdict, longer, tuple(rivals), proof=proof)


def shape_that_leaves_noise(inquiry: Inquiry, as_read: Judged, scale: GapScale, names: Verdict) -> Verdict | None:
    """Return the verdict on one shape without a name that leaves mere noise where several names together do not."""
    if len(names.account.account.parts) < 2:
        return None
    shape = fitted_shape(as_read, inquiry.search, scale)
    if shape is None or not leaves_noise(inquiry, shape):
        return None
    return proven_shape(inquiry, as_read, shape, (names.account, *names.rivals))


def proven_shape(inquiry: Inquiry, as_read: Judged, shape: Judged, others: tuple[Judged, ...]) -> Verdict | None:
    """Return the verdict on a shape without a name that the held-out data bear out; None where they do not."""
    proof = borne_out(inquiry, as_read, shape)
    return Verdict("unnamed", shape, others, proof=proof) if proof.bears_out else None


def strongest(search: Search, named: Judged) -> Judged:
    """Return what was named with as many explanations as are named at most, those left out that are missed least."""
    while len(named.account.parts) > MOST_NAMES:
        fewer = [search.without(named, number) for number in range(len(named.account.parts))]
        named = min(fewer, key=lambda one: one.evidence)
    return named


def needed(inquiry: Inquiry, as_read: Judged, now: Judged) -> Judged:
    """Return what was named without the explanations that the held-out data do not bear out beside the others."""
    while len(now.account.parts) > 1:
        fewer = [inquiry.search.without(now, number) for number in range(len(now.account.parts))]
        tests = [borne_out(inquiry, one, now, as_read).test for one in fewer]
        idle = max(range(len(fewer)), key=lambda number: np.nan_to_num(tests[number].p, nan=1.0))
        if tests[idle].bears_out:
            break
        now = fewer[idle]
    return now


def plainest(inquiry: Inquiry, scale: GapScale, named: Judged) -> Verdict | None:
    """Return the verdict on the plainest explanations that close most of the gap; None where these close too little.

    named: the simulation with what the search let in, which leaves more than noise
    """
    found = closing_most(inquiry, scale, (named.account.parts,) if named.account.parts else ())
    if found is None or found.closed < HALF:
        return None
    plain, likelier = compared([found.as_read, found.now], inquiry.search.base)
    if plain.evidence - likelier.evidence < MARGIN:
        return None
    now = needed(inquiry, found.as_read, found.now)
    proof = borne_out(inquiry, found.as_read, now)
    if now is found.now and proof.closed > HALF and not proof.bears_out:  # few pieces are held out
        proof = replace(proof, test=found.test)
    if not proof.bears_out:
        return None
    names = {part.candidate.name for part in now.account.parts}
    word = NAMELESS if NAMELESS in names else now.account.parts[0].candidate.verdict
    return Verdict(word, now, (found.now, *found.near), proof=proof, small=found.small)


def searched(inquiry: Inquiry, as_read: Judged, scale: GapScale) -> tuple[Judged, Judged, list[Judged]]:
    """Search on short runs, and on longer ones where these show nothing and the system is not chaotic.

    returns as_read, named: the simulation as read and with what was let in, on the same runs
    returns rivals: what else stood for the first place, best first
    """
    named, rivals = grown(inquiry.search, as_read, MOST, scale.noise)
    if named.account.parts or not inquiry.is_tame(as_read):
        return as_read, named, rivals
    longer = inquiry.lengthened(as_read)
    if longer is as_read:
        return as_read, named, rivals
    named, rivals = grown(inquiry.search, longer, MOST, scale.noise)
    return (longer, named, rivals) if named.account.parts else (as_read, as_read, rivals)


def lasting(inquiry: Inquiry, as_read: Judged, named: Judged) -> Judged:
    """Return what was named less what longer runs have no use for, on the runs that it was found on.

    Where fear of chaos keeps runs short, several explanations together can do what one does with another number.

    as_read, named: the simulation as read and with what the search let in, on the same runs
    """
    if len(named.account.parts) < 2 or inquiry.is_tame(as_read):
        return named
    longer = inquiry.lengthened(named)
    kept = pruned(inquiry.search, longer, MARGIN).account.parts
    if len(kept) == len(named.account.parts):
        return named
    account = account_for(named.shooting, inquiry.search.base, kept, named.account.fit.starts, like=named.account)
    return judged(named.shooting, inquiry.search.base, account)


def weighed_with_memory(
    inquiry: Inquiry, as_read: Judged, named: Judged, shape: Judged | None, rivals: list[Judged]
) -> Verdict | None:
    """Return a verdict where what is left remembers its past, and random pushes or a shape explain it better.

    as_read, named: the simulation as read and with what the search let in
    """
    plain, *found = compared([as_read, named, *([shape] if shape else [])], inquiry.search.base)
    shaking = random_push(inquiry, as_read)
    ordered = [one for one in found if explains(inquiry, plain, one, shaking)]
    if shaking and not ordered:
        return Verdict("process_noise", as_read, tuple(rivals), shaking)
    worth = WORTH * (plain.evidence - found[0].evidence) + MARGIN
    if shape and found[1] in ordered and found[1].evidence < found[0].evidence - worth:
        return Verdict("unnamed", found[1], (named, *rivals), proof=borne_out(inquiry, plain, found[1]))
    return None


def says_more(inquiry: Inquiry, shape: Judged, named: Judged) -> bool:
    """Whether one shape without a name explains more than several names together.

    shape, named: the simulation with a fitted shape, and with what the search let in
    """
    named, shape = compared([named, shape], inquiry.search.base)
    return shape.evidence < named.evidence - MARGIN


def decided(inquiry: Inquiry, named: Judged, rivals: list[Judged]) -> tuple[Judged, list[Judged]]:
    """Return what was named, fitted to long runs; where a rival comes near, the one that long runs prefer.

    returns rivals: all that stood for the first place, best first
    """
    longer = inquiry.lengthened(named)
    if len(named.account.parts) > 1:
        return longer, rivals
    near = [one for one in rivals if one is not named and one.evidence < named.evidence + NEAR][:MOST_NEAR]
    near = [inquiry.lengthened(one, longer.shooting.segments.span) for one in near]
    near = [one for one in near if one.shooting.segments.span == longer.shooting.segments.span]
    first, *others = ranked(compared([longer, *near], inquiry.search.base), inquiry.search.candidates)
    others = [replace(one, gained=first.gained + first.evidence - one.evidence) for one in others]
    decided_on = {one.labels for one in (first, *others)}
    return first, [first, *others, *(one for one in rivals if one.labels not in decided_on)]


def random_push(inquiry: Inquiry, as_read: Judged) -> Shaken | None:
    """Return the random push that explains the gap better than noise of the sensors, if there is one."""
    best = shaken(as_read.shooting, as_read.account, inquiry.search.places)[0]
    return best if best.rival - best.evidence > PUSHED * best.numbers + MARGIN else None


def explains(inquiry: Inquiry, as_read: Judged, now: Judged, shaking: Shaken | None) -> bool:
    """Whether something that repeats itself explains the gap, also on held-out trials.

    as_read, now: the simulation as read and with what was found, under one noise
    shaking: random pushes that would explain it as well; they leave nothing for anything that repeats itself
    """
    if not now.account.parts or as_read.evidence - now.evidence < MARGIN:
        return False
    share = REPEATS if shaking else 0.0
    if 1 - now.account.fit.misfit / as_read.account.fit.misfit <= share:
        return False
    return borne_out(inquiry, as_read, now).bears_out


def borne_out(inquiry: Inquiry, before: Judged, now: Judged, as_read: Judged | None = None) -> Proof:
    """Test on the held-out trials whether the error falls with what was found.

    Over runs as long as it was fitted to, which show a small effect best; where chaos makes these too long, over those
    that the search began with will do.

    as_read: the simulation as read, on the runs that the search began with; `before` where absent
    """
    proof, first = proof_of(inquiry, before, now, now), as_read or before
    if proof.bears_out or inquiry.is_tame(first):
        return proof
    shorter = proof_of(inquiry, before, now, replace(first, shooting=first.shooting.with_noise(now.noise)))
    return shorter if shorter.bears_out else proof
