"""Models: the simulation with some explanations in it, fitted, scored by the information criterion, and ranked.

The noise is autocorrelated, as estimated from residuals.
Source: Schwarz 1978, Ann. Stat. 6, 461 (the criterion, BIC); Cochrane and Orcutt 1949, J. Am. Stat. Assoc. 44, 32
(fit, estimate the autocorrelation of the residuals, whiten, fit again); Foster and George 1994, Ann. Stat. 22, 1947
(2 log p for each of p that was selected, the risk inflation criterion).
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, replace

import numpy as np

from gaitdisc.discovery.candidate import UNNAMED, Candidate, Identity
from gaitdisc.discovery.catalogue import read_shapes
from gaitdisc.discovery.criteria import CRITERIA
from gaitdisc.discovery.first_states import with_own_states
from gaitdisc.discovery.fitted import Fitted, read_prior
from gaitdisc.discovery.noise import MOST_LAGS, Noise, find_noise
from gaitdisc.discovery.shooting import ENOUGH, TURNS, Shooting
from gaitdisc.recording.arrays import Values
from gaitdisc.simulation.compiled_simulation import Compiled
from gaitdisc.simulation.running import compile_simulation
from gaitdisc.simulation.simulation import Simulation

TURNS_AGAIN = 4  # under another noise
ROUNDS = 2  # of estimating the noise and fitting under it
INTEGRATED = 1e-4  # of a channel's spread: how far two integrators of one model may be apart
# Where two explanations fit equally well, the simpler statement first.
PREFERENCE = ("wrong_parameter", "input_error", "sensor_error", "missing_physics")

Explanations = frozenset[Identity]


@dataclass(frozen=True)
class Part:
    """One explanation with its numbers."""

    candidate: Candidate
    values: dict[str, float]

    @property
    def written(self) -> dict[str, str]:
        """Slot -> its number as it is written into a file."""
        return {slot: f"{value:.6g}" for slot, value in self.values.items()}

    @property
    def term(self) -> str:
        """The missing term as it is written into a file; empty for what is none."""
        return self.candidate.term(self.written) if self.candidate.verdict == "missing_physics" else ""


@dataclass(frozen=True)
class ScoredModel:
    """The simulation with some explanations in it, fitted to runs under one noise: its own or a better model's."""

    base: Simulation  # as read
    simulation: Simulation  # with the explanations, their numbers as parameters
    machine: Compiled
    parts: tuple[Part, ...]  # the explanations, with the numbers that were found
    fit: Fitted
    shooting: Shooting  # the runs, and the noise that they were fitted under
    gained: float = 0.0  # fall of the criterion against the same without its last explanation, under one noise

    @property
    def names(self) -> tuple[dict[str, str], ...]:
        """For each explanation, slot -> the parameter that it is in the simulation."""
        return name_parts(self.parts)

    @property
    def explanations(self) -> Explanations:
        """Which explanations are in, whatever their order and numbers."""
        return frozenset(part.candidate.identity for part in self.parts)

    @property
    def labels(self) -> tuple[str, ...]:
        """Name and place of each explanation."""
        return tuple(part.candidate.label for part in self.parts)

    @property
    def verdicts(self) -> tuple[str, ...]:
        """What kind of explanation each is."""
        return tuple(part.candidate.verdict for part in self.parts)

    @property
    def word(self) -> str:
        """The verdict that it is: of what is missing without a name, that; else what kind its first explanation is."""
        return UNNAMED if any(part.candidate.name == UNNAMED for part in self.parts) else self.verdicts[0]

    @property
    def penalty(self) -> float:
        """What its explanations have to close [of the gap of the simulation as read]."""
        return sum(part.candidate.penalty(part.values) for part in self.parts)

    @property
    def size(self) -> int:
        """How many numbers the explanations have; those with bounds are fitted in every model alike."""
        return sum(len(part.candidate.slots) for part in self.parts)

    @property
    def noise(self) -> Noise:
        """The noise that the model was fitted under."""
        return self.shooting.noise

    @property
    def bic(self) -> float:
        """Information criterion (BIC): misfit plus log(N) for each number fitted; the smaller the better.

        Comparable between models of the same runs under the same noise, and only between these.
        """
        return self.fit.misfit + self.size * float(np.log(self.fit.white.size))

    def refitted(
        self,
        shooting: Shooting,
        parts: tuple[Part, ...] | None = None,
        starts: Values | None = None,
        turns: int = TURNS,
        enough: float = ENOUGH,
    ) -> ScoredModel:
        """Return the simulation with the same explanations or others, fitted from where this model came to lie."""
        parts, starts = self.parts if parts is None else parts, self.fit.starts if starts is None else starts
        return fit_model(shooting, self.base, parts, starts, turns, enough, like=self)

    def under(self, other: ScoredModel) -> ScoredModel:
        """Return the model fitted again under another's noise, so that the two can be compared."""
        if other.shooting is self.shooting:
            return self
        return replace(self.refitted(other.shooting, turns=TURNS_AGAIN), gained=self.gained)

    def with_own_past(self) -> ScoredModel:
        """Return the model with its own run as the past of what comes late."""
        return replace(self, shooting=self.shooting.with_past(self.fit.states))

    def with_estimates(self, values: Values, covariance: Values) -> ScoredModel:
        """Return the model with other numbers, and their covariance; its runs stay as they are."""
        fit = replace(self.fit, values=values, stated=covariance)
        return replace(self, parts=_read_parts(self.parts, self.machine, values), fit=fit)


def name_parts(parts: tuple[Part, ...]) -> tuple[dict[str, str], ...]:
    """For each explanation, slot -> the parameter that it is in a simulation with all of them."""
    return tuple(part.candidate.named(f"part{number}") for number, part in enumerate(parts))


def _read_parts(parts: tuple[Part, ...], machine: Compiled, values: Values) -> tuple[Part, ...]:
    """Return explanations with their numbers among all parameters (parameter,)."""
    by_name = dict(zip(machine.parameters, values.tolist(), strict=True))
    return tuple(
        Part(part.candidate, {slot: by_name[name] for slot, name in slots.items()})
        for part, slots in zip(parts, name_parts(parts), strict=True)
    )


def fit_model(
    shooting: Shooting,
    base: Simulation,
    parts: tuple[Part, ...],
    starts: Values,
    turns: int = TURNS,
    enough: float = ENOUGH,
    like: ScoredModel | None = None,
) -> ScoredModel:
    """Fit a simulation with explanations in it, and with them the numbers that have bounds, within these.

    A number that an explanation calls wrong may leave its bounds.

    like: whose numbers with bounds the fit begins with; the file's where absent
    """
    simulation, names = base, name_parts(parts)
    for part, slots in zip(parts, names, strict=True):
        simulation = part.candidate.in_fit(simulation, slots, part.values)
    prior = read_prior(base, frozenset(part.candidate.place for part in parts if part.candidate.kind == "parameter"))
    machine = compile_simulation(simulation)
    values = machine.defaults.copy()
    if like:
        values[prior.places] = like.fit.values[prior.places]
        values = prior.within(values)
    for part, slots in zip(parts, names, strict=True):
        for slot, name in slots.items():
            values[machine.parameters.index(name)] = part.values[slot]
    free = (*(name for slots in names for name in slots.values()), *prior.names)
    if like is None or like.machine.states != machine.states or starts.shape[1] != len(machine.states):
        starts = with_own_states(shooting, machine, values, starts)
    quicker = compile_simulation(simulation, frozenset(machine.parameters).difference(free))
    fit = replace(shooting, prior=prior).fitted(quicker, free, values, starts, turns, enough)
    return ScoredModel(base, simulation, machine, _read_parts(parts, machine, fit.values), fit, shooting)


def score(model: ScoredModel) -> ScoredModel:
    """Estimate a model's own noise, and its own past for what comes late, and fit it again under them."""
    least = max(INTEGRATED, model.base.inexact) * np.nanstd(model.shooting.measured.observed, axis=(0, 1))
    passed = model.shooting.record_filter
    known = passed.autocorrelation(MOST_LAGS) if passed and passed.margin else None
    for _ in range(ROUNDS):
        residual = model.fit.residual
        noise = find_noise(residual, model.fit.starts.shape[1] / residual.shape[2], least=least, autocorrelation=known)
        model = model.refitted(model.with_own_past().shooting.with_noise(noise), turns=TURNS_AGAIN)
    return model


def leaves(model: ScoredModel, noise: Values) -> float:
    """Return the mean square of what a model leaves, over the variance of the sensors' noise (channel,)."""
    return float(np.nanmean((model.fit.residual / noise) ** 2))


def compared(models: list[ScoredModel]) -> list[ScoredModel]:
    """Put models of the same segments under one noise: what the best of them leaves."""
    models = [model.under(models[0]) for model in models]
    for _ in range(len(models)):
        best = min(range(len(models)), key=lambda number: models[number].bic)
        likeliest = replace(score(models[best]), gained=models[best].gained)
        models = [likeliest if number == best else model.under(likeliest) for number, model in enumerate(models)]
        if min(range(len(models)), key=lambda number: models[number].bic) == best:
            break
    return models


def ranked(models: list[ScoredModel], candidates: tuple[Candidate, ...]) -> list[ScoredModel]:
    """Return models, the best first.

    A kind of explanation with many members (a missing term: any shape at any place) is more likely to have one that
    fits by chance than a kind with few (a wrong parameter): each kind is penalised for the number of its
    members. Of what the criterion does not distinguish the simplest statement stands first.
    """
    models = [model for model in models if np.isfinite(model.bic)]
    if not models:
        return models
    members = Counter(verdict for verdict, _ in {(candidate.verdict, candidate.label) for candidate in candidates})

    def penalised(model: ScoredModel) -> float:
        return model.bic + sum(2 * float(np.log(max(members[verdict], 1))) for verdict in model.verdicts)

    models.sort(key=penalised)
    least = min(models, key=lambda model: model.bic)
    simple = (model for model in models if model.size < least.size and model.bic < least.bic + CRITERIA.margin)
    first = next(simple, models[0])
    order = {shape.name: number for number, shape in reversed(list(enumerate(read_shapes())))}

    def complexity(model: ScoredModel) -> tuple[list[int], float, list[int]]:
        names = [order.get(part.candidate.name, len(order)) for part in model.parts]
        return [PREFERENCE.index(verdict) for verdict in model.verdicts], round(model.penalty, 6), names

    tied = [model for model in models if model.size == first.size]
    first = min((model for model in tied if penalised(model) <= penalised(first) + CRITERIA.tie), key=complexity)
    return [first, *(model for model in models if model is not first)]
