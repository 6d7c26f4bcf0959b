"""Who names what is hidden: a case of which the answer is known, and what each way of asking answers."""

from __future__ import annotations

import time as clock
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path

import numpy as np
import pandas as pd
from threadpoolctl import threadpool_limits

from gaitdisc.discovery.discover import discover
from gaitdisc.discovery.result import Discovery, Estimate
from gaitdisc.errors import GaitdiscError, ShapeError
from gaitdisc.model import Model
from gaitdisc.simulation.compiled_simulation import Drive
from gaitdisc.simulation.evaluating import Points, evaluate
from gaitdisc.simulation.measured import Measured
from gaitdisc.simulation.running import compile_simulation
from gaitdisc.simulation.simulation import Simulation

from .cell import ORACLE, learned_model, part, terms_of
from .methods import Method, MethodSettings
from .record import Approach, KnownRates, Record, System, error_samples, recorded
from .sindy import Sindy

ANSWERS = ("named", "tied", "among others", "wrong name", "curve", "nothing", "refused")
TOOLS = ("discover", "sindy", "dmd", "gp", "nn")
NAN = float("nan")
NOTHING = 1e-6  # of the known model's own rates or states: an error signal below it is rounding


@dataclass(frozen=True)
class Naming:
    """An answer about what a model lacks."""

    case: str  # what was recorded; what the known model lacks, empty where nothing is hidden
    hidden: str  # what was recorded; what the known model lacks, empty where nothing is hidden
    tool: str
    noise: float
    seed: int
    # one of `ANSWERS`: the hidden effect and nothing else, it and another that the data cannot distinguish (whichever
    # stands first), more than it, something else, a curve without a name, that nothing is missing, or a refusal
    answer: str
    said: str
    amount: float = NAN  # the effect's number over its true one; NaN where the hidden effect was not named
    # median over channels of how much less RMSE the forecast has than that of the known model, both from the noise-free
    # true state, an oracle [%]; NaN where it diverged or was not run
    accuracy: float = NAN
    diverged_s: float | None = None  # when the forecast left every bound [s since its start]
    seconds: float = NAN

    def __post_init__(self) -> None:
        """Refuse an answer that the table does not know."""
        if self.answer not in ANSWERS or self.tool not in TOOLS:
            raise ValueError(f"{self.answer!r} of {self.tool!r} is none of {ANSWERS} of {TOOLS}")

    @property
    def right(self) -> bool:
        """Whether it says what is hidden, or rightly that nothing is."""
        return self.answer == ("named" if self.hidden else "nothing")


def namings_table(namings: Sequence[Naming]) -> pd.DataFrame:
    """Return all answers, one row each."""
    return pd.DataFrame([asdict(naming) | {"right": naming.right} for naming in namings])


def read_namings(path: Path) -> pd.DataFrame:
    """Answers that were written as CSV."""
    numbers = {name: [""] for name in ("amount", "accuracy", "diverged_s", "seconds")}
    return pd.read_csv(path, keep_default_na=False, na_values=numbers).replace({"hidden": r"^'+"}, "", regex=True)


@dataclass(frozen=True, eq=False)
class HiddenEffect:
    """A system and what is hidden in it."""

    case: str
    words: str  # what is hidden, in words; empty for nothing
    system: System
    effect: tuple[str, ...] = ()  # place and name by which `gaitdisc discover` would name it; empty for nothing
    amount: float = NAN  # its number, in the convention of `gaitdisc discover`
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
    begun, made = clock.process_time(), record.conditions
    head = (hidden.case, hidden.words, method, made.noise, made.seed)
    try:
        with threadpool_limits(1):
            learned = learned_model(record, method, hidden.approach, settings or MethodSettings())
    except GaitdiscError as error:
        return Naming(*head, "refused", str(error), seconds=clock.process_time() - begun)
    seconds, forecast = clock.process_time() - begun, part(record, learned, hidden.approach, ORACLE)
    answer, amount = _named(hidden, learned) if isinstance(learned, Sindy) else ("curve", NAN)
    said = terms_of(learned) or curve_words(hidden, record, learned)
    accuracy = float(np.median(forecast.accuracy()))
    return Naming(*head, answer, said, amount, accuracy, forecast.diverged_s, seconds)


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
        return "nothing", NAN
    if not sought or not sought <= there:
        return "wrong name", NAN
    output, term = next(iter(sorted(sought)))
    return "named" if there == sought else "among others", found[output][term] / hidden.terms[output][term]


def discover_answer(hidden: HiddenEffect, record: Record) -> Naming:
    """What `gaitdisc discover` finds that the known model lacks."""
    begun, made, system = clock.process_time(), record.conditions, record.system
    if not isinstance(system.known, KnownRates):
        known = f"{system.name!r} is known as {type(system.known).__name__}"
        raise ShapeError("discover needs a simulation file", known, "Write its equations as a simulation file.")
    simulation = system.known.simulation.observing(system.channels)
    shown = record.measured[: record.split]
    drive = Drive.of([np.empty((len(shown), 0))], 1.0 / made.dt_s)
    found, augmented = discover(simulation, Measured(drive, shown[None], ("1",), system.channels))
    seconds = clock.process_time() - begun
    answer, amount = answer_of(hidden, found)
    head = (hidden.case, hidden.words, "discover", made.noise, made.seed)
    return Naming(*head, answer, found.sentence, amount, forecast_accuracy(record, augmented), None, seconds)


def answer_of(hidden: HiddenEffect, found: Discovery) -> tuple[str, float]:
    """Answer of a discovery in the words of `Naming`, and its number over the true one.

    A parameter that clearly moved within its bounds is among what it names.
    """
    named: dict[tuple[str, ...], Estimate | None]
    named = {(one.place, one.name): next(iter(one.estimates.values()), None) for one in found.effects}
    for one in found.corrections:
        if not one.found.low <= one.given <= one.found.high:
            named[one.parameter, "wrong_parameter"] = one.found
    if not named:
        return "nothing", NAN
    tied = {(one.place, one.name) for one in found.rivals if one.tied}
    if effect := named.get(hidden.effect):
        alone = len(named) == 1 or found.verdict == "wrong_initial_condition"
        return ("among others" if not alone else "tied" if tied else "named"), effect.value / hidden.amount
    if hidden.effect in tied:
        return "tied", NAN
    return ("curve" if found.verdict == "unnamed" else "wrong name"), NAN


def forecast_accuracy(record: Record, augmented: Simulation) -> float:
    """How much less error a forecast from the true state, an oracle, has, median of channels [%]; NaN with a delay."""
    system, start, truth = record.system, record.start(forecast=True), record.target(forecast=True)
    if compile_simulation(augmented).right_hand_side.delays:
        return NAN
    begun = dict(zip(system.states, start, strict=True))  # a state that the effect adds begins at its initial value
    first = np.array([begun.get(state.name, float(state.initial or 0.0)) for state in augmented.states])
    known, states = (
        rates.run(each[None], record.conditions.dt_s, len(truth) - 1)[0]
        for rates, each in ((system.known, start), (KnownRates(augmented), first))
    )
    points = Points(np.zeros(len(states)), states, np.empty((len(states), 0)))
    seen = np.column_stack([evaluate(augmented, expression, points) for _, expression in augmented.observations])
    known, seen = (np.sqrt(np.mean((each - truth) ** 2, axis=0)) for each in (known[:, : truth.shape[1]], seen))
    return float(np.median(100 * (1 - seen / np.where(known > 0, known, np.nan))))
