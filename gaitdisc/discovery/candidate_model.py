"""A candidate model: the simulation with some explanations in it, fitted."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from gaitdisc.discovery.candidate import Candidate, Identity
from gaitdisc.discovery.first_states import with_own_states
from gaitdisc.discovery.fitted import Fitted, read_prior
from gaitdisc.discovery.shooting import ENOUGH, TURNS, Shooting
from gaitdisc.recording.arrays import Values
from gaitdisc.simulation.compiled_simulation import Compiled
from gaitdisc.simulation.running import compile_simulation
from gaitdisc.simulation.simulation import Simulation

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
class CandidateModel:
    """The simulation with some explanations in it, fitted to segments."""

    base: Simulation  # as read
    simulation: Simulation  # with the explanations, their numbers as parameters
    machine: Compiled
    parts: tuple[Part, ...]  # the explanations, with the numbers that were found
    fit: Fitted

    @property
    def names(self) -> tuple[dict[str, str], ...]:
        """For each explanation, slot -> the parameter that it is in the simulation."""
        return tuple(part.candidate.named(_tag(number)) for number, part in enumerate(self.parts))

    @property
    def explanations(self) -> Explanations:
        """Which explanations are in, whatever their order and numbers."""
        return frozenset(part.candidate.identity for part in self.parts)

    @property
    def penalty(self) -> float:
        """What its explanations have to close [of the gap of the simulation as read]."""
        return sum(part.candidate.penalty(part.values) for part in self.parts)

    @property
    def size(self) -> int:
        """How many numbers the explanations have; those with bounds are fitted in every model alike."""
        return sum(len(part.candidate.slots) for part in self.parts)

    @property
    def bic(self) -> float:
        """Information criterion (BIC): misfit plus log(N) for each number fitted; the smaller the better."""
        return self.fit.misfit + self.size * float(np.log(self.fit.white.size))

    def refitted(
        self,
        shooting: Shooting,
        parts: tuple[Part, ...] | None = None,
        starts: Values | None = None,
        turns: int = TURNS,
        enough: float = ENOUGH,
    ) -> CandidateModel:
        """Return the simulation with the same explanations or others, fitted from where this model came to lie.

        starts (segment, state): start states to begin from; this model's where absent
        """
        parts, starts = self.parts if parts is None else parts, self.fit.starts if starts is None else starts
        return fit_model(shooting, self.base, parts, starts, turns, enough, like=self)

    def with_estimates(self, values: Values, covariance: Values) -> CandidateModel:
        """Return the model with other numbers, and their covariance; its runs stay as they are.

        values (parameter,): all parameters
        """
        fit = replace(self.fit, values=values, stated=covariance)
        found = dict(zip(self.machine.parameters, values.tolist(), strict=True))
        pairs = zip(self.parts, self.names, strict=True)
        parts = tuple(Part(one.candidate, {slot: found[name] for slot, name in own.items()}) for one, own in pairs)
        return replace(self, parts=parts, fit=fit)


def with_parts(base: Simulation, parts: tuple[Part, ...]) -> tuple[Simulation, tuple[dict[str, str], ...]]:
    """Return a simulation with explanations in it, their numbers as parameters, and for each its slots' parameters."""
    simulation, names = base, []
    for number, part in enumerate(parts):
        simulation, slots = part.candidate.in_fit(simulation, _tag(number), part.values)
        names.append(slots)
    return simulation, tuple(names)


def _tag(number: int) -> str:
    """Return what the names of an explanation's parameters begin with."""
    return f"part{number}"


def fit_model(
    shooting: Shooting,
    base: Simulation,
    parts: tuple[Part, ...],
    starts: Values,
    turns: int = TURNS,
    enough: float = ENOUGH,
    like: CandidateModel | None = None,
) -> CandidateModel:
    """Fit a simulation with explanations in it, and with them the numbers that have bounds, within these.

    A number that an explanation calls wrong may leave its bounds.

    starts (segment, state): start states to begin from
    enough: a step that takes less off the misfit is the last
    like: whose numbers with bounds the fit begins with; the file's where absent
    """
    simulation, names = with_parts(base, parts)
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
    fit = replace(shooting, prior=prior).fitted(machine, free, values, starts, turns, enough)
    found = tuple(
        Part(part.candidate, {slot: float(fit.values[machine.parameters.index(name)]) for slot, name in slots.items()})
        for part, slots in zip(parts, names, strict=True)
    )
    return CandidateModel(base, simulation, machine, found, fit)
