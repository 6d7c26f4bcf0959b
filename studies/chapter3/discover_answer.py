"""What `gaitdisc discover` answers about a case of which the answer is known."""

from __future__ import annotations

import time as clock

import numpy as np

from gaitdisc.discovery.discover import discover
from gaitdisc.errors import ShapeError
from gaitdisc.results.discovery import Discovery, FoundEffect
from gaitdisc.simulation.drive import Drive
from gaitdisc.simulation.evaluating import Points, evaluate
from gaitdisc.simulation.measured import Measured
from gaitdisc.simulation.simulation import Simulation

from .hidden_effect import HiddenEffect
from .known_rates import KnownRates
from .naming import Naming
from .record import Record


def discover_answer(hidden: HiddenEffect, record: Record) -> Naming:
    """What `gaitdisc discover` finds that the known model lacks."""
    begun, made, system = clock.process_time(), record.conditions, record.system
    if not isinstance(system.known, KnownRates):
        raise ShapeError(
            "discover needs a simulation file",
            f"{system.name!r} is known as {type(system.known).__name__}",
            "Write its equations as a simulation file.",
        )
    simulation = system.known.simulation.observing(system.channels)
    shown = record.measured[: record.split]
    drive = Drive.of([np.empty((len(shown), 0))], 1.0 / made.dt_s)
    found, augmented = discover(simulation, Measured(drive, shown[None], ("1",), system.channels))
    seconds = clock.process_time() - begun
    answer, amount = answer_of(hidden, found)
    accuracy = forecast_accuracy(record, augmented)
    case = (hidden.case, hidden.words, "discover", made.noise, made.seed, answer, found.sentence)
    return Naming(*case, amount, accuracy, None, seconds)


def answer_of(hidden: HiddenEffect, found: Discovery) -> tuple[str, float]:
    """Answer of a discovery in the words of `Naming`, and its number over the true one."""
    named: dict[tuple[str, ...], FoundEffect] = {(one.place, one.name): one for one in found.effects}
    if not named:
        return "nothing", float("nan")
    tied = {(one.place, one.name) for one in found.rivals if one.tied}
    if hidden.effect in named:
        number = next(iter(named[hidden.effect].estimates.values())).value
        alone = len(named) == 1 or found.verdict == "wrong_initial_condition"
        return ("among others" if not alone else "tied" if tied else "named"), number / hidden.amount
    if hidden.effect in tied:
        return "tied", float("nan")
    return ("curve" if found.verdict == "unnamed" else "wrong name"), float("nan")


def forecast_accuracy(record: Record, augmented: Simulation) -> float:
    """How much less error the forecast of an augmented simulation has, median of channels [%]."""
    system, start, truth = record.system, record.start(forecast=True), record.target(forecast=True)
    known, states = (
        rates.run(start[None], record.conditions.dt_s, len(truth) - 1)[0]
        for rates in (system.known, KnownRates(augmented))
    )
    points = Points(np.zeros(len(states)), states, np.empty((len(states), 0)))
    seen = np.column_stack([evaluate(augmented, expression, points) for _, expression in augmented.observations])
    known, seen = (np.sqrt(np.mean((each - truth) ** 2, axis=0)) for each in (known[:, : truth.shape[1]], seen))
    return float(np.median(100 * (1 - seen / np.where(known > 0, known, np.nan))))
