"""Find, name, add, show: the whole inquiry, from a simulation and measured trials to an answer."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from gaitdisc.discovery.answer import answer
from gaitdisc.discovery.by_share import leaves_noise
from gaitdisc.discovery.candidate import Candidate
from gaitdisc.discovery.catalogue import Shape
from gaitdisc.discovery.decision import judge
from gaitdisc.discovery.held_out import holding_out_others, noted, tells_nothing
from gaitdisc.discovery.inquiry import begin_inquiry, split_in_time
from gaitdisc.discovery.odd_trials import agreeing_trials
from gaitdisc.discovery.reading import read_instead, read_shape
from gaitdisc.discovery.spiked_samples import without_spikes
from gaitdisc.discovery.trial_apart import without_trial_apart
from gaitdisc.results.discovery import Discovery
from gaitdisc.simulation.measured import Measured
from gaitdisc.simulation.simulation import Simulation


def discover(
    simulation: Simulation,
    measured: Measured,
    shapes: tuple[Shape, ...] = (),
    told: Callable[[str], None] = lambda _: None,
    weighed: Callable[[Candidate], bool] = lambda _: True,
) -> tuple[Discovery, Simulation]:
    """Find where a simulation and measured trials disagree, name what is missing, add it, show the gap shrink."""
    measured = without_spikes(measured)
    begun = partial(begin_inquiry, simulation, shapes=shapes, told=told, weighed=weighed)
    inquiry = begun(measured)
    agreeing = agreeing_trials(inquiry, measured)
    if agreeing is not measured:
        measured, inquiry = agreeing, begun(agreeing)
    told("fitting the simulation as it was read")
    as_read = inquiry.as_read()
    told(f"weighing {len(inquiry.search.candidates)} explanations")
    verdict = judge(inquiry, as_read)
    if not leaves_noise(inquiry, verdict.account):
        kept = without_trial_apart(inquiry)
        if kept is not inquiry.measured:
            told("one trial goes with no explanation of the others: it is left out")
            measured, inquiry = kept, begun(kept)
            as_read = inquiry.as_read()
            verdict = judge(inquiry, as_read)
    unproven = verdict.rivals[:1] if verdict.word == "no_gap" else ()
    if unproven and tells_nothing(inquiry, as_read, *unproven):
        if len(measured.trials) == 1:
            other = begun(split_in_time(measured, last=False))
        else:
            other = holding_out_others(inquiry, as_read, *unproven)
        told("what is held out never goes where it would act: other data are held out")
        inquiry, as_read = noted(inquiry, other), other.as_read()
        verdict = judge(inquiry, as_read)
    verdict = read_instead(inquiry, as_read, read_shape(inquiry, as_read, verdict))
    told("showing it on what was held out")
    return answer(inquiry, as_read, verdict)
