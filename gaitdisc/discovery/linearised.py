"""First-order response: what a small effect would change in every segment, without running it.

Along a fitted run the map from one sample to the next is linearised once, x[k+1] = F x[k] + G push[k]; the response to
any candidate is then a recursion over samples, for hundreds of candidates at once.
"""

from dataclasses import dataclass

import numpy as np

from gaitdisc.discovery.places import Place
from gaitdisc.discovery.scored_model import ScoredModel
from gaitdisc.discovery.shooting import Shooting
from gaitdisc.recording.arrays import Values
from gaitdisc.simulation.compiled_simulation import Compiled
from gaitdisc.simulation.parts import Parameter, Term
from gaitdisc.simulation.running import compile_simulation
from gaitdisc.simulation.simulation import Simulation

ROUNDING = 1e-9  # of a state's size, below which it stands still
NUDGE = 1e-5
PUSH = 1e-4
MOST_RUNS = 0.8  # of the segments, in which growth must stay below


@dataclass(frozen=True)
class Linearised:
    """The one-sample maps of a fitted run, linearised."""

    onward: Values  # (segment, step, state, state), f: what a change of state becomes one sample later
    # (segment, step, state, place), g: what a unit push at a place, held over the sample, adds
    pushed: Values
    landed: Values  # (segment, step, state), where each step of the run lands

    def first_growth(self, factor: float, states: Values) -> int | None:
        """Return the first sample at which a small change of the start has grown so much in a fifth of the segments.

        states (segment, sample, state): the run, for that spread; of a state that stands still (a guess that says
            nothing of a hidden one) no change is small or large
        """
        spread = states.std(axis=(0, 1))
        still = spread <= ROUNDING * np.abs(states).max(axis=(0, 1))
        scale = np.where(still, 1.0, spread)
        moving = np.outer(~still, ~still)
        change = np.repeat(np.eye(len(scale))[None], len(states), axis=0)
        for step in range(states.shape[1] - 1):
            change = self.onward[:, step] @ change
            finite = np.asarray(np.isfinite(change).all(axis=(1, 2)))
            scaled = np.where(finite[:, None, None] & moving, change * scale / scale[:, None], 0.0)
            growth = np.where(finite, np.linalg.norm(scaled, 2, axis=(1, 2)), np.inf)
            if np.quantile(growth, MOST_RUNS, method="lower") > factor:
                return step + 1
        return None

    def of_push(self, place: int, push: Values) -> Values:
        """Return the change of state (segment, sample, state, candidate) by pushes (segment, sample, candidate)."""
        held = 0.5 * (push[:, :-1] + push[:, 1:])
        return self.of_change(self.pushed[:, :, :, place, None] * held[:, :, None, :])

    def of_change(self, change: Values) -> Values:
        """Return the change of state by changes of where each step lands (segment, step, state, candidate)."""
        segments, steps, states, candidates = change.shape
        out = np.zeros((segments, steps + 1, states, candidates))
        for step in range(steps):
            out[:, step + 1] = self.onward[:, step] @ out[:, step] + change[:, step]
        return out


def linearise(model: ScoredModel, places: tuple[Place, ...]) -> Linearised:
    """Linearise every step of a fitted run."""
    return linearise_along(model.shooting, model.simulation, places, model.fit.states, model.fit.values)


def linearise_along(
    shooting: Shooting, simulation: Simulation, places: tuple[Place, ...], run: Values, values: Values
) -> Linearised:
    """Linearise every step along given states (segment, sample, state), by given values of the parameters."""
    machine = pushable(simulation, places)
    n, count = run.shape[2], len(values)
    spans = NUDGE * np.maximum(np.abs(run).max(axis=(0, 1)), 1e-3)
    versions = 1 + n + len(places)
    states = np.repeat(run[None, :, :-1], versions, axis=0)
    many = np.repeat(np.concatenate([values, np.zeros(len(places))])[None], versions, axis=0)
    for state in range(n):
        states[1 + state, ..., state] += spans[state]
    for place in range(len(places)):
        many[1 + n + place, count + place] = PUSH
    landed = shooting.landed(machine, states, many)
    change = landed[1:] - landed[0]
    onward = np.moveaxis(change[:n] / spans[:, None, None, None], 0, -1)
    pushed = np.moveaxis(change[n:] / PUSH, 0, -1)
    return Linearised(onward, pushed, landed[0])


def pushable(simulation: Simulation, places: tuple[Place, ...]) -> Compiled:
    """Compile a simulation with a push, zero at first, at every place."""
    for number, place in enumerate(places):
        simulation = simulation.with_parameter(Parameter(f"push_{number}", 0.0))
        if place.kind == "input":
            simulation = simulation.with_input(place.name, f"{place.name} + push_{number}")
        else:
            simulation = simulation.with_effect(Term(place.name, place.kind, "push", f"push_{number}"))
    return compile_simulation(simulation)


def carry_change(model: ScoredModel, change: Values) -> Values:
    """Return what changes of state (segment, sample, state, candidate) change in the channels, to first order."""
    machine, fit, shooting = model.machine, model.fit, model.shooting
    if machine.observation.delays:  # what is measured depends on states some time ago: each candidate by itself
        spans = np.maximum(np.abs(fit.states).max(axis=(0, 1)), 1e-3)
        size = (np.abs(change).max(axis=(0, 1)) / spans[:, None]).max(axis=0)
        nudge = NUDGE / np.maximum(size, 1e-300)
        versions = np.concatenate([fit.states[None], np.moveaxis(change * nudge, -1, 0) + fit.states])
        seen = shooting.observed(machine, versions, np.repeat(fit.values[None], len(versions), axis=0))
        return np.moveaxis(seen[1:] - seen[0], 0, -1) / nudge
    n = fit.starts.shape[1]
    spans = NUDGE * np.maximum(np.abs(fit.states).max(axis=(0, 1)), 1e-3)
    versions = np.repeat(fit.states[None], n + 1, axis=0)
    for state in range(n):
        versions[1 + state, ..., state] += spans[state]
    seen = shooting.unfiltered(machine, versions, np.repeat(fit.values[None], n + 1, axis=0))
    slopes = np.moveaxis((seen[1:] - seen[0]) / spans[:, None, None, None], 0, -1)
    return shooting.filtered(slopes @ change, 1)


def propagate_push(model: ScoredModel, places: tuple[Place, ...]) -> Values:
    """Return what a unit push changes at once in what the sensors see (segment, sample, channel, place).

    Before any filter, states as they are: an input may stand in what is measured.
    """
    pushed = np.concatenate([np.zeros((1, len(places))), PUSH * np.eye(len(places))])
    values, states = (np.repeat(each[None], len(pushed), axis=0) for each in (model.fit.values, model.fit.states))
    machine = pushable(model.simulation, places)
    seen = model.shooting.unfiltered(machine, states, np.concatenate([values, pushed], axis=1))
    return np.moveaxis(seen[1:] - seen[0], 0, -1) / PUSH
