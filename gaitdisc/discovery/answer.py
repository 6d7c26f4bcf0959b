"""The answer: numbers with intervals, where it acts, how far the gap shrank, and one sentence."""

from __future__ import annotations

import numpy as np

from gaitdisc.discovery.account import Part
from gaitdisc.discovery.effect_units import places_unit, unit_of
from gaitdisc.discovery.estimates import estimates_of
from gaitdisc.discovery.evidence import Judged
from gaitdisc.discovery.held_out import drawn_runs, gap_size, runs_of
from gaitdisc.discovery.inquiry import Inquiry
from gaitdisc.discovery.shaken import Shaken
from gaitdisc.discovery.wording import sentence_of
from gaitdisc.results.discovery import Discovery, Estimate, FoundEffect, GapSize, Whereabouts
from gaitdisc.simulation.evaluating import Points, evaluate
from gaitdisc.simulation.simulation import Simulation

TIE = 6.0  # fall of the criterion below which two explanations are told apart by nothing
RIVALS = 6
HALF = 0.5


def answer(
    inquiry: Inquiry, as_read: Judged, verdict: str, now: Judged, rivals: tuple[Judged, ...], shaking: Shaken | None
) -> tuple[Discovery, Simulation]:
    """Write down what an inquiry came to.

    Parameters
    ----------
    inquiry : Inquiry
        What was asked.
    as_read : Judged
        The simulation as read.
    verdict : str
        One of the contract's.
    now : Judged
        The simulation with what was found in it.
    rivals : tuple of Judged
        What else was weighed, best first.
    shaking : Shaken or None
        For process noise.

    Returns
    -------
    discovery : Discovery
        The answer.
    augmented : Simulation
        The simulation with what was found, its numbers written in.
    """
    channels = tuple(name for name, _ in inquiry.search.base.observations)
    floor = now.noise.size
    block = int(inquiry.rhythm.period * inquiry.rhythm.rate) + 1
    sizes = []
    for trials in (inquiry.learned, inquiry.held_out):
        before, after = (runs_of(inquiry, one, trials, now) for one in (as_read, now))
        sizes.append(gap_size(before, after, floor, channels, block))
    train, held_out = sizes
    effects = tuple(
        found_effects(inquiry, now, closed_share(held_out), max([one.gained for one in rivals], default=0.0))
    )
    if shaking:
        effects = (
            FoundEffect(
                shaking.place.kind, shaking.place.name, "process_noise", "", {"strength": push_of(inquiry, shaking)}
            ),
        )
    discovery = Discovery(
        verdict,
        "",
        whereabouts(inquiry, now, shaking, train.before**2, train.after**2),
        effects,
        rivals_of(inquiry, now, rivals),
        train,
        held_out,
        channels,
        units_of(inquiry),
        drawn_runs(inquiry, before, after, inquiry.held_out),
        inquiry.measured.findings,
    )
    return sentence_of(discovery, inquiry.search.base, now.account.parts), augmented_of(
        inquiry.search.base, now.account.parts
    )


def push_of(inquiry: Inquiry, shaking: Shaken) -> Estimate:
    """Return the standard deviation of a random push, in the unit of its place.

    Parameters
    ----------
    inquiry : Inquiry
        What was asked.
    shaking : Shaken
        The push.
    """
    unit = places_unit(inquiry.search.base, shaking.place.kind, shaking.place.name)
    return Estimate(shaking.strength, np.nan, np.nan, unit)


def augmented_of(base: Simulation, parts: tuple[Part, ...]) -> Simulation:
    """Return a simulation with explanations in it, their numbers written in.

    Parameters
    ----------
    base : Simulation
        As read.
    parts : tuple of Part
        The explanations.
    """
    for part in parts:
        base = part.candidate.written(base, part.written)
    return base


def closed_share(size: GapSize) -> float:
    """Return the share of a gap's variance above the noise floor that goes.

    Parameters
    ----------
    size : GapSize
        Before and after.

    Examples
    --------
    >>> closed_share(GapSize(before=3.0, after=1.0, noise_floor=1.0))
    1.0
    """
    floor = size.noise_floor**2
    return 1 - (size.after**2 - floor) / max(size.before**2 - floor, 1e-12)


def found_effects(inquiry: Inquiry, now: Judged, closed: float, gained: float) -> list[FoundEffect]:
    """List the explanations with their numbers and intervals.

    Parameters
    ----------
    inquiry : Inquiry
        What was asked.
    now : Judged
        The account.
    closed : float
        Share of the held-out gap that is closed.
    gained : float
        Fall of the criterion.
    """
    found = []
    for number, part in enumerate(now.account.parts):
        candidate = part.candidate
        estimates = estimates_of(now.account, number, inquiry.search.base)
        term = candidate.term(part.written) if candidate.verdict == "missing_physics" else ""
        found.append(FoundEffect(candidate.kind, candidate.place, candidate.name, term, estimates, closed, gained))
    return found


def rivals_of(inquiry: Inquiry, now: Judged, rivals: tuple[Judged, ...]) -> tuple[FoundEffect, ...]:
    """List what else was weighed for the first place.

    Parameters
    ----------
    inquiry : Inquiry
        What was asked.
    now : Judged
        The simulation with what was found.
    rivals : tuple of Judged
        Best first.
    """
    own = {part.candidate.label for part in now.account.parts}
    best = max([one.gained for one in rivals], default=0.0)
    listed = []
    for rival in (one for one in rivals if one.account.parts):
        last = rival.account.parts[-1]
        if last.candidate.label in own:
            continue
        estimates = estimates_of(rival.account, len(rival.account.parts) - 1, inquiry.search.base)
        listed.append(
            FoundEffect(
                last.candidate.kind,
                last.candidate.place,
                last.candidate.name,
                "",
                estimates,
                bic=rival.gained,
                tied=bool(own and best - rival.gained < TIE),
            )
        )
    return tuple(listed[:RIVALS])


def whereabouts(
    inquiry: Inquiry, now: Judged, shaking: Shaken | None, before: float, after: float
) -> tuple[Whereabouts, ...]:
    """Say where the gap arises.

    Parameters
    ----------
    inquiry : Inquiry
        What was asked.
    now : Judged
        The account.
    shaking : Shaken or None
        For process noise.
    before, after : float
        Mean squared gap, as shares of the channels' variance.
    """
    if shaking:
        return (Whereabouts(shaking.place.kind, shaking.place.name, float("nan")),)
    share = (before - after) / before if before > 0 else 0.0
    return tuple(
        Whereabouts(
            part.candidate.kind,
            part.candidate.place,
            share / len(now.account.parts),
            phase_of(inquiry, now, part),
            region_of(part),
        )
        for part in now.account.parts
    )


def phase_of(inquiry: Inquiry, now: Judged, part: Part) -> tuple[float, ...]:
    """Return the part of the stride in which an effect is at least half as strong as at its strongest.

    Parameters
    ----------
    inquiry : Inquiry
        What was asked.
    now : Judged
        The account.
    part : Part
        One of its explanations.
    """
    names = [one.name for one in inquiry.search.base.inputs]
    if "phase" not in names or part.candidate.verdict != "missing_physics":
        return ()
    segments, drive = now.shooting.segments, inquiry.measured.drive
    inputs = segments.of(drive.inputs).reshape(-1, len(names))
    states = now.account.fit.states.reshape(len(inputs), -1)
    time = (drive.time0[segments.trial][:, None] + segments.samples / drive.rate).ravel()
    term = part.candidate.term({slot: f"{value:.9g}" for slot, value in part.values.items()})
    if "delay(" in term:
        return ()
    push = np.abs(evaluate(inquiry.search.base, term, Points(time, states, inputs)))
    phase = inputs[:, names.index("phase")]
    bins = np.minimum((phase * 100).astype(int), 99)
    mean = np.bincount(bins, push, 100) / np.maximum(np.bincount(bins, minlength=100), 1)
    strong = np.flatnonzero(mean > HALF * mean.max())
    return (float(strong[0] / 100), float((strong[-1] + 1) / 100)) if strong.size else ()


def region_of(part: Part) -> str:
    """Say in which states an effect acts.

    Parameters
    ----------
    part : Part
        An explanation.
    """
    candidate = part.candidate
    if candidate.name == "one_sided_spring":
        side = ">" if "- _x0" in candidate.pieces[0] else "<"
        return f"{candidate.role} {side} {part.values['x0']:.4g}"
    if candidate.name == "dead_zone_spring":
        return f"abs({candidate.role}) > {part.values['d']:.4g}"
    return ""


def units_of(inquiry: Inquiry) -> tuple[str, ...]:
    """Return the units of the observed channels.

    Parameters
    ----------
    inquiry : Inquiry
        What was asked.
    """
    base = inquiry.search.base
    units = {part.name: part.unit for part in (*base.states, *base.inputs, *base.parameters)} | {"t": "s"}
    return tuple(unit_of(text, units) for _, text in base.observations)
