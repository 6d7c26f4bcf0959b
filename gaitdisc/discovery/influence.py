"""Influence: which places, parameters and states change nothing of what is measured: no data could show them."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import compress

import numpy as np

from gaitdisc.discovery.linearised import pushable
from gaitdisc.discovery.places import Place
from gaitdisc.discovery.result import FoundEffect
from gaitdisc.discovery.shooting import Shooting
from gaitdisc.errors import SimulationError
from gaitdisc.recording import Finding
from gaitdisc.recording.arrays import Values
from gaitdisc.simulation.simulation import Simulation

NUDGE = 0.1  # of a state's or a parameter's size
ROUNDING = 1e-13  # of a channel's size
NEARLY_OFF = 0.3  # a gain by which little of an input is left


@dataclass(frozen=True)
class Idle:
    """What changes nothing in any measured channel."""

    places: tuple[str, ...] = ()
    parameters: tuple[str, ...] = ()
    states: tuple[str, ...] = ()
    constant: tuple[str, ...] = ()  # measured channels that no state, place, parameter or input changes

    def findings(self, source: str, kind: str) -> tuple[Finding, ...]:
        """One for each kind."""
        idle = (
            ("warning", kind, self.places, "the search, which cannot identify an effect there"),
            ("note", "parameter", self.parameters, "nothing; these data cannot determine such a parameter"),
            ("note", "state", self.states, "nothing; these data cannot determine such an initial value"),
        )
        findings = []
        for severity, part, names, spoils in idle:
            words = " and ".join(repr(name) for name in names)
            subject = f"{part} {words} has" if len(names) == 1 else f"{part}s {words} have"
            if names:
                what = f"{subject} no effect on the measured channels"
                findings.append(Finding(severity, "no influence", source, what, spoils))
        return tuple(findings)


def idle_parts(shooting: Shooting, simulation: Simulation, places: tuple[Place, ...], starts: Values) -> Idle:
    """Find what changes nothing in any measured channel along runs that begin at the data."""
    machine = pushable(simulation, places)  # its parameters: those of the simulation, then a push at each place
    states, parameters = starts.shape[1], len(simulation.parameters)
    nudges = np.arange(1, 1 + states + len(machine.defaults))  # version 0 is as it is, each other has one nudge
    of_states, of_numbers = np.split(nudges, [states])
    many_starts, values = (np.repeat(numbers[None], 1 + len(nudges), axis=0) for numbers in (starts, machine.defaults))
    many_starts[of_states, :, np.arange(states)] += NUDGE * np.maximum(np.abs(starts).max(axis=0), 1.0)[:, None]
    sizes = np.abs(machine.defaults)
    values[of_numbers, np.arange(len(of_numbers))] += NUDGE * np.where(sizes, sizes, 1.0)
    with np.errstate(all="ignore"):  # a run that leaves every bound has been changed
        _, seen = shooting.run(machine, many_starts, values)
        change = np.abs(seen[1:] - seen[0]).max(axis=(1, 2))
        size = np.abs(seen[0]).max(axis=(0, 1))
    changed = ~(change <= ROUNDING * size)
    over_time = ~(np.ptp(seen[0].reshape(-1, seen.shape[3]), axis=0) <= ROUNDING * size)
    idle_states, idle_parameters, idle_places = np.split(~changed.any(axis=1), [states, states + parameters])
    return Idle(
        tuple(compress((place.name for place in places), idle_places)),
        tuple(compress((part.name for part in simulation.parameters), idle_parameters)),
        tuple(compress((state.name for state in simulation.states), idle_states)),
        tuple(compress(machine.observed, ~(over_time | changed[:states].any(axis=0)))),
    )


def refuse_idle(idle: Idle, simulation: Simulation, places: tuple[Place, ...]) -> None:
    """Refuse a simulation of which a measured channel never changes, or in which nothing missing would show."""
    for name in idle.constant:
        raise SimulationError(
            "a measured channel must depend on a state or an input",
            f"{name!r} is {dict(simulation.observations)[name]!r}, which is constant in {simulation.title!r}",
            "Correct its expression, or remove the channel.",
            ("observations", name),
        )
    if places and len(idle.places) == len(places):
        kinds = "ports" if simulation.ports else "equations"
        raise SimulationError(
            "an effect can be identified only where it changes a measured channel",
            f"{' and '.join(map(repr, idle.places))}: no effect on {', '.join(dict(simulation.observations))}",
            "Check the factors of this place, or measure a channel that it affects.",
            (kinds, idle.places[0]),
        )


def nearly_off(effects: tuple[FoundEffect, ...], source: str) -> tuple[Finding, ...]:
    """Warn where an answer takes several inputs nearly away: what nothing acts on follows its record by itself."""
    gains = {
        effect.place: effect.estimates["gain"].value
        for effect in effects
        if effect.name == "input_gain" and abs(effect.estimates["gain"].value) < NEARLY_OFF
    }
    if len(gains) < 2:
        return ()
    what = " and ".join(f"{name!r} (gain {gain:.2g})" for name, gain in gains.items()) + " are nearly switched off"
    spoils = "the answer, if the simulation follows a recorded motion; combine signals of one recording into one input"
    return (Finding("warning", "inputs switched off", source, what, spoils),)
