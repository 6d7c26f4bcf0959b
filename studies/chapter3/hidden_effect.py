"""A case of which the answer is known, and what the methods of chapter 3 answer."""

from __future__ import annotations

import time as clock
from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from threadpoolctl import threadpool_limits

from gaitdisc.errors import GaitdiscError
from gaitdisc.model import Model

from .cell import learned_model, part, terms_of
from .discrepancy_cell import ORACLE
from .error_signal import Approach, error_samples
from .methods import Method, MethodSettings
from .naming import Naming
from .record import Record, recorded
from .sindy import Sindy
from .system import System

NOTHING = 1e-6  # of the known model's own rates or states: an error signal below it is rounding


@dataclass(frozen=True, eq=False)
class HiddenEffect:
    """A system and what is hidden in it."""

    case: str
    words: str  # what is hidden, in words; empty for nothing
    system: System
    effect: tuple[str, ...] = ()  # place and name by which `gaitdisc discover` would name it; empty for nothing
    amount: float = float("nan")  # its number, in the convention of `gaitdisc discover`
    # output to terms with their coefficients, by which SINDy would name it; empty where it has no such name
    terms: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    approach: Approach = "dynamics"
    duration_s: float = 50.0  # of the record [s]


def method_answer(
    hidden: HiddenEffect, record: Record, method: Method, settings: MethodSettings | None = None
) -> Naming:
    """What one method finds that the known model lacks.

    SINDy answers with terms, the others with a curve: of time (DMD) or of the states (Gaussian process, network).
    """
    begun, settings = clock.process_time(), settings or MethodSettings()
    made = record.conditions
    refused = Naming(hidden.case, hidden.words, method, made.noise, made.seed, "refused", "")
    try:
        with threadpool_limits(1):
            learned = learned_model(record, method, hidden.approach, settings)
    except GaitdiscError as error:
        return replace(refused, said=str(error), seconds=clock.process_time() - begun)
    seconds = clock.process_time() - begun
    forecast = part(record, learned, hidden.approach, ORACLE)
    accuracy = float(np.median(forecast.accuracy()))
    answer, amount = _named(hidden, learned) if isinstance(learned, Sindy) else ("curve", float("nan"))
    said = terms_of(learned) or curve_words(hidden, record, learned)
    answered = replace(refused, answer=answer, said=said, amount=amount)
    return replace(answered, accuracy=accuracy, diverged_s=forecast.diverged_s, seconds=seconds)


def curve_words(hidden: HiddenEffect, record: Record, learned: Model) -> str:
    """Say how far a learned curve is off what it stands for, along the record without its noise."""
    clean = recorded(record.system, replace(record.conditions, noise=0.0))
    signal = error_samples(clean, hidden.approach, learned.inputs == ("t",))
    own = record.system.known(clean.truth) if hidden.approach == "dynamics" else clean.truth
    size, missing, whole = (float(np.sqrt(np.mean(each**2))) for each in (learned(signal.x), signal.y, own))
    of = "time" if learned.inputs == ("t",) else "the states"
    if missing < NOTHING * whole:
        return f"a curve of {of}, {size / whole:.1e} of what the known model has itself, where nothing is missing"
    off = float(np.sqrt(np.mean((learned(signal.x) - signal.y) ** 2)))
    return f"a curve of {of}, {100 * off / missing:.0f} % off what is missing"


def _named(hidden: HiddenEffect, learned: Sindy) -> tuple[str, float]:
    """Answer of terms, and the coefficient found over the true one."""
    found = {output: terms for output in learned.outputs if (terms := learned.terms(output))}
    sought = {(output, term) for output, terms in hidden.terms.items() for term in terms}
    there = {(output, term) for output, terms in found.items() for term in terms}
    if not there:
        return "nothing", float("nan")
    if not sought or not sought <= there:
        return "wrong name", float("nan")
    output, term = next(iter(sorted(sought)))
    return "named" if there == sought else "among others", found[output][term] / hidden.terms[output][term]
