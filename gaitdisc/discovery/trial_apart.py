"""A trial that goes with no explanation of the others: a gain, an offset, a sensor that stood still, another person."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from gaitdisc.discovery.gap_share import MODEL_ERROR
from gaitdisc.discovery.growth import leaves
from gaitdisc.discovery.inquiry import Inquiry
from gaitdisc.discovery.odd_trials import KIND
from gaitdisc.recording import Finding
from gaitdisc.simulation.measured import Measured

FEWEST_TRIALS, MOST_TRIALS = 4, 8  # each is left out once
APART = 2.0  # times the error must stay whichever other trial is left out


def without_trial_apart(inquiry: Inquiry) -> Measured:
    """Return the trials without the one that goes with no explanation of the others, with a finding.

    Each trial is left out in turn and the best single explanation of the others is found. Where these are explained
    far better without one of the trials than without any other, that trial stands apart.

    Parameters
    ----------
    inquiry : Inquiry
        The simulation as read and all trials, which leave more than noise whatever is named.

    Returns
    -------
    Measured
        The trials as they were where none stands apart, or there are too few or too many to say.
    """
    measured = inquiry.measured
    count = len(measured.trials)
    if not FEWEST_TRIALS <= count <= MOST_TRIALS:
        return measured
    left = np.array([_left_without(inquiry, trial) for trial in range(count)])
    least, *others = np.sort(left)
    if others[0] < max(APART * least, MODEL_ERROR):
        return measured
    trial = int(np.argmin(left))
    what = (
        f"trial {measured.trials[trial]!r} goes with no explanation of the others: without it the best one leaves "
        f"{least:.2g} standard deviations, without any other trial {others[0]:.2g} or more"
    )
    source = measured.source or inquiry.search.base.title
    spoils = "this trial, which was left out: look at its gain, its offset and whether a channel stood still"
    kept = measured.selected([other for other in range(count) if other != trial])
    return replace(kept, findings=(*kept.findings, Finding("warning", KIND, source, what, spoils)))


def _left_without(inquiry: Inquiry, trial: int) -> float:
    """Root mean square that the best single explanation of all other trials leaves [standard deviations]."""
    others = tuple(other for other in range(len(inquiry.measured.trials)) if other != trial)
    part = replace(inquiry, learned=others)
    as_read, spread = part.as_read(), np.nanstd(inquiry.measured.observed, axis=(0, 1))
    return float(np.sqrt(min(leaves(one, spread) for one in (as_read, *part.search.extended(as_read)))))
