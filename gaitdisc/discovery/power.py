"""How large an effect must be to be found: records of a simulation with more and more of it, searched by the rule.

Source: Finney 1947, Probit Analysis (the share of records in which it is found, a normal distribution of log size).
"""

import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import pandas as pd
from scipy.optimize import minimize
from scipy.stats import norm

from gaitdisc.discovery.case import Case, set_up_case
from gaitdisc.discovery.catalogue import Request
from gaitdisc.discovery.discover import fit_given, refuse_unknown
from gaitdisc.discovery.effect_words import amount, spoken
from gaitdisc.discovery.estimates import name_estimates
from gaitdisc.discovery.scored_model import Part, ScoredModel
from gaitdisc.discovery.spiked_samples import without_spikes
from gaitdisc.discovery.twins import TwinSource, search_records
from gaitdisc.errors import SchemaError
from gaitdisc.recording.arrays import Values
from gaitdisc.simulation.measured import Measured
from gaitdisc.simulation.simulation import Simulation
from gaitdisc.words import with_unit

SIZES = np.geomspace(2.0, 128.0, 13)  # standard errors of an estimate, until two sizes in a row are found
POWER = 0.95


@dataclass(frozen=True)
class Power:
    """In how many simulated records of each size an effect was found."""

    effect: str  # effect@place
    number: str  # its number that is meant
    unit: str
    sizes: tuple[float, ...]  # of that number
    found: tuple[int, ...]  # records in which exactly this effect was named
    records: int  # of each size
    instead: str = ""  # the answer to most records of the largest size, where it is another

    @property
    def least(self) -> float:
        """Size that is found in 19 of 20 records; infinite beyond the largest size, NaN below the smallest.

        >>> Power("a@b", "damping", "1/s", (1.0, 2.0, 4.0, 8.0), (0, 5, 10, 10), 10).least < 4.0
        True
        """
        log, share = np.log(self.sizes), np.divide(self.found, self.records)
        if share.max() < POWER:
            return math.inf
        if share.min() >= POWER:
            return math.nan

        def misfit(at: Values) -> float:
            chance = np.clip(norm.cdf((log - at[0]) / np.exp(at[1])), 1e-6, 1 - 1e-6)
            return -float(np.sum(share * np.log(chance) + (1 - share) * np.log(1 - chance)))

        middle = log[np.argmax(share >= 0.5 * share.max())]
        best = minimize(misfit, [middle, np.log(0.3)], method="Nelder-Mead", options={"maxiter": 2000}).x
        return float(np.exp(best[0] + norm.ppf(POWER) * np.exp(best[1])))

    @property
    def sentence(self) -> str:
        """From which size on the effect is found."""
        effect, _, place = self.effect.partition("@")
        number, least = self.number.replace("_", " "), self.least
        size = least if math.isfinite(least) else self.sizes[0 if math.isnan(least) else -1]
        what, said = f"{spoken(effect)} at {place}".capitalize(), with_unit(amount(size, size / 10), self.unit)
        if math.isnan(least):
            return f"{what} is found in 19 of 20 records like these even with a {number} of {said}."
        if math.isinf(least):
            instead = f"; in most records with {said} the answer is {self.instead}" if self.instead else ""
            return f"{what} is found in fewer than 19 of 20 records like these, up to a {number} of {said}{instead}."
        return f"{what} is found in 19 of 20 records like these if the {number} is at least {said}."


def find_power(model: Simulation, data: Measured, request: Request) -> list[Power]:
    """Find how large each effect of a request must be to be found in records like these."""
    if not request.effects:
        raise SchemaError(
            "a plan must name the effects to be found",
            "no effect is given",
            'Name the effects: --effects "viscous_damping@port, input_delay@input".',
        )
    case = set_up_case(model, without_spikes(data), request)
    refuse_unknown(case.search, request.effects)
    request.progress("fitting the initial simulation")
    as_read = case.as_read()
    return [find_power_for(effect, case, as_read, model, request) for effect in request.effects]


def find_power_for(effect: str, case: Case, as_read: ScoredModel, model: Simulation, request: Request) -> Power:
    """Search records with more and more of one effect."""
    request.progress(f"fitting {effect}")
    scored = fit_given(case, as_read, (effect,)).found
    (part,), fit = scored.parts, scored.fit
    if not part.candidate.idle:
        raise SchemaError(
            "each effect of a plan must have a number for its size", f"{effect} has none", "Give another effect."
        )
    slot, none = next(iter(part.candidate.idle.items()))
    name = scored.names[0][slot]
    row, place = fit.free.index(name), scored.machine.parameters.index(name)
    one_more = Part(part.candidate, part.values | {slot: none + 1.0})
    exactly = np.zeros((len(part.candidate.slots), len(part.candidate.slots)))
    number, estimate = next(iter(name_estimates(one_more, exactly, case.search.base).items()))
    sizes, counts, most = (math.sqrt(fit.covariance[row, row]) * SIZES).tolist(), [], ""
    for size in sizes:
        values = fit.values.copy()
        values[place] = none + (size if estimate.value >= 0 else -size)
        grown = replace(scored, fit=replace(fit, values=values))
        source = TwinSource(case, grown, as_read.noise, None if part.candidate.states else as_read)
        answers = Counter(search_records([source], model, request))
        counts.append(answers[effect])
        most = answers.most_common(1)[0][0]
        if min(counts[-2:]) >= POWER * request.twins and len(counts) > 1:
            break
    instead = "" if most == effect else most
    sized = tuple(sizes[: len(counts)])
    return Power(effect, number, estimate.unit, sized, (*counts,), records=request.twins, instead=instead)


def tabulate_power(powers: Sequence[Power]) -> pd.DataFrame:
    """A row for each effect and size."""
    columns = ("effect", "number", "size", "unit", "found", "records")
    rows = (
        (power.effect, power.number, size, power.unit, count, power.records)
        for power in powers
        for size, count in zip(power.sizes, power.found, strict=True)
    )
    return pd.DataFrame([*rows], columns=pd.Index(columns))
