"""Find, name, add, show: the whole inquiry, from a simulation and measured trials to an answer."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from gaitdisc.discovery.answer import answer
from gaitdisc.discovery.catalogue import Shape
from gaitdisc.discovery.evidence import Judged, compared
from gaitdisc.discovery.fitted_shape import fitted_shape
from gaitdisc.discovery.held_out import runs_of
from gaitdisc.discovery.inquiry import Inquiry, begin_inquiry
from gaitdisc.discovery.search import MARGIN, ranked
from gaitdisc.discovery.shaken import Shaken, shaken
from gaitdisc.discovery.wording import sentence_of
from gaitdisc.discovery.wrong_start import begun_at, wrong_starts
from gaitdisc.results.discovery import Discovery, Estimate, FoundEffect, Whereabouts
from gaitdisc.simulation.measured import Measured
from gaitdisc.simulation.simulation import Simulation

MOST_NAMES = 2
NEAR = 40.0  # by which a rival's evidence may be worse and still be tried on long runs
MOST_NEAR = 4
REPEATS = 0.2  # of the misfit, which something that repeats itself has to take away where random pushes would do
PUSHED = 0.03  # by which random pushes must be likelier than a sensor's own memory, for each number
WORTH = 0.05  # of what was named, which a shape without a name must explain beyond it


@dataclass(frozen=True)
class Verdict:
    """What the search came to.

    Parameters
    ----------
    word : str
        One of the contract's verdicts.
    account : Judged
        The simulation with what was found in it.
    rivals : tuple of Judged
        What else was weighed, best first.
    shaking : Shaken or None
        For process noise: where, and how strong.
    starts : dict of str to Estimate
        For wrong initial conditions: where the trials begin.
    """

    word: str
    account: Judged
    rivals: tuple[Judged, ...]
    shaking: Shaken | None = None
    starts: dict[str, Estimate] = field(default_factory=dict)


def discover(
    simulation: Simulation,
    measured: Measured,
    shapes: tuple[Shape, ...] = (),
    told: Callable[[str], None] = lambda _: None,
) -> tuple[Discovery, Simulation]:
    """Find where a simulation and measured trials disagree, name what is missing, add it, show the gap shrink.

    Parameters
    ----------
    simulation : Simulation
        As read.
    measured : Measured
        Its trials; a quarter is held out.
    shapes : tuple of Shape
        Effects of the user's own, beside the catalogue.
    told : callable
        Takes one line about each step.

    Returns
    -------
    discovery : Discovery
        The answer.
    augmented : Simulation
        The simulation with what was found in it.
    """
    inquiry = begin_inquiry(simulation, measured, shapes)
    told("fitting the simulation as it was read")
    as_read = inquiry.as_read()
    told(f"weighing {len(inquiry.search.candidates)} explanations")
    verdict = judge(inquiry, as_read)
    told("showing it on what was held out")
    found, augmented = answer(inquiry, as_read, verdict.word, verdict.account, verdict.rivals, verdict.shaking)
    if not verdict.starts:
        return found, augmented
    effects = tuple(
        FoundEffect("state", name, "wrong_initial_condition", "", {"initial": start})
        for name, start in verdict.starts.items()
    )
    where = tuple(Whereabouts("state", name, float("nan")) for name in verdict.starts)
    found = sentence_of(replace(found, effects=effects, where=where), simulation, ())
    return found, begun_at(simulation, verdict.starts)


def judge(inquiry: Inquiry, as_read: Judged) -> Verdict:
    """Search, and decide which of the contract's verdicts the data support.

    Parameters
    ----------
    inquiry : Inquiry
        What is asked.
    as_read : Judged
        The simulation as read.
    """
    named, rivals = inquiry.search.grown(as_read, MOST_NAMES + 1)
    if not named.account.parts and inquiry.is_tame(as_read):
        longer = inquiry.lengthened(as_read)
        if longer is not as_read:
            named, rivals = inquiry.search.grown(longer, MOST_NAMES + 1)
            as_read = longer if named.account.parts else as_read
            named = named if named.account.parts else as_read
    if named.noise.remembers:
        shape = fitted_shape(as_read, inquiry.search)
        plain, *found = compared([as_read, named, *([shape] if shape else [])], inquiry.search.base)
        shaking = random_push(inquiry, as_read)
        ordered = [one for one in found if explains(inquiry, plain, one, shaking)]
        if shaking and not ordered:
            return Verdict("process_noise", as_read, tuple(rivals), shaking)
        if (
            shape
            and found[1] in ordered
            and found[1].evidence < found[0].evidence - WORTH * (plain.evidence - found[0].evidence) - MARGIN
        ):
            return Verdict("unnamed", found[1], (named, *rivals))
    if len(named.account.parts) > MOST_NAMES:
        shape = fitted_shape(as_read, inquiry.search)
        return Verdict("unnamed", shape or named, (named, *rivals))
    if not named.account.parts:
        wrong = wrong_starts(inquiry.search.base, as_read)
        return Verdict("wrong_initial_condition" if wrong else "no_gap", as_read, tuple(rivals), starts=wrong)
    longer, rivals = decided(inquiry, named, rivals)
    if not proven(inquiry, as_read, longer):
        return Verdict("no_gap", as_read, (named, *rivals))
    return Verdict(longer.account.parts[0].candidate.verdict, longer, tuple(rivals))


def decided(inquiry: Inquiry, named: Judged, rivals: list[Judged]) -> tuple[Judged, list[Judged]]:
    """Return what was named, fitted to long runs; where a rival comes near, the one that long runs prefer.

    Parameters
    ----------
    inquiry : Inquiry
        What is asked.
    named : Judged
        What the search let in.
    rivals : list of Judged
        What else stood for the first place.

    Returns
    -------
    now : Judged
        On long runs.
    rivals : list of Judged
        All that stood for the first place, best first.
    """
    longer = inquiry.lengthened(named)
    if len(named.account.parts) > 1:
        return longer, rivals
    near = [one for one in rivals if one is not named and one.evidence < named.evidence + NEAR][:MOST_NEAR]
    near = [inquiry.lengthened(one, longer.shooting.segments.length) for one in near]
    near = [one for one in near if one.shooting.segments.length == longer.shooting.segments.length]
    first, *others = ranked(compared([longer, *near], inquiry.search.base))
    others = [replace(one, gained=first.gained + first.evidence - one.evidence) for one in others]
    decided_on = {one.labels for one in (first, *others)}
    return first, [first, *others, *(one for one in rivals if one.labels not in decided_on)]


def random_push(inquiry: Inquiry, as_read: Judged) -> Shaken | None:
    """Return the random push that explains the gap better than noise of the sensors, if there is one.

    Parameters
    ----------
    inquiry : Inquiry
        What is asked.
    as_read : Judged
        The simulation as read.
    """
    best = shaken(as_read.shooting, as_read.account, inquiry.search.places)[0]
    return best if best.rival - best.evidence > PUSHED * best.numbers + MARGIN else None


def explains(inquiry: Inquiry, as_read: Judged, now: Judged, shaking: Shaken | None) -> bool:
    """Whether something that repeats itself explains the gap, also on held-out trials.

    Parameters
    ----------
    inquiry : Inquiry
        What is asked.
    as_read, now : Judged
        The simulation as read and with what was found, under one noise.
    shaking : Shaken or None
        Random pushes that would explain it as well; they leave nothing for anything that repeats itself.
    """
    if not now.account.parts or as_read.evidence - now.evidence < MARGIN:
        return False
    share = REPEATS if shaking else 0.0
    return proven(inquiry, as_read, now) and 1 - now.account.fit.misfit / as_read.account.fit.misfit > share


def proven(inquiry: Inquiry, as_read: Judged, now: Judged) -> bool:
    """Whether what was found makes the misfit fall on the trials that were held out.

    Parameters
    ----------
    inquiry : Inquiry
        What is asked.
    as_read, now : Judged
        The simulation as read and with what was found.
    """
    like = replace(as_read, shooting=as_read.shooting.with_noise(now.noise))
    before, after = (runs_of(inquiry, one, inquiry.held_out, like) for one in (as_read, now))
    return bool(np.nan_to_num(before.misfits - after.misfits, nan=0.0).sum() > 0)
