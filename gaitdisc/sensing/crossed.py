"""Errors on people whom a model has not seen, from the people it is fitted to: leave some of them out, in turn."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from gaitdisc.recording import Samples
from gaitdisc.sensing.intervals import half_widths
from gaitdisc.sensing.reconstructor import WITHOUT_NETWORK, Sensing, fit_reconstructor
from gaitdisc.sensing.splits import Parts
from gaitdisc.sensing.windows import stacked

FOLDS = 5
FEWEST = 3  # people of whom one can be left out, one chosen by, one fitted
STANDARD = "delay ridge"  # stands in for the others in how far the checked people are from typical


def crossed_errors(kind: str, what: Sensing, parts: Parts, seed: int = 0) -> NDArray[np.float64]:
    """Errors (window, state) on everybody of the fitted and the checked part, each by a model of others.

    The people are dealt out to five groups; for each group a model is fitted to the others and chosen by one of them.
    """
    people = people_of((*parts.check, *parts.training))
    names = list(people)
    errors = []
    for group in range(min(FOLDS, len(names))):
        left_out = names[group::FOLDS]
        others = [name for name in names if name not in left_out]
        training = stacked([trial for name in others[1:] for trial in people[name]])
        done = fit_reconstructor(kind, what, training, stacked(people[others[0]]), seed)
        errors += [done(trial) - trial.y for name in left_out for trial in people[name]]
    return np.concatenate(errors)


def crossed_widths(
    kind: str, what: Sensing, parts: Parts, missed: NDArray[np.float64], seed: int = 0
) -> NDArray[np.float64]:
    """Half width of the 90 % interval for a person whom a model has not seen, (state,) [each state's unit].

    One checked person may be reconstructed better or worse than most (and is all there is where there are fewer than
    four people in all). Ridge regression is therefore crossed over people; a network, which would take five times as
    long, gets its interval on the checked person, times what crossing changes for ridge regression on delays.

    missed (window, state) [each state's unit]: errors of the model on the checked person
    Source: Barber, Candes, Ramdas and Tibshirani 2021, Predictive inference with the jackknife+ (CV+); here one
        interval for all, about what the model of everybody reconstructs.
    """
    if len(people_of((*parts.check, *parts.training))) < FEWEST:
        return half_widths(missed)
    if kind in WITHOUT_NETWORK:
        return half_widths(crossed_errors(kind, what, parts, seed))
    check = parts.checked()
    standard = fit_reconstructor(STANDARD, what, parts.fitted(), check, seed)
    one = half_widths(standard(check) - check.y)
    return half_widths(missed) * half_widths(crossed_errors(STANDARD, what, parts, seed)) / one


def people_of(trials: Sequence[Samples]) -> dict[str, list[Samples]]:
    """Trials of each person, by pseudonym."""
    found: dict[str, list[Samples]] = {}
    for trial in trials:
        if len(trial):
            found.setdefault(trial.subject, []).append(trial)
    return found
