"""Whether measured trials are trials of a simulation, and which of its parts change nothing of what is measured.

Its channels, its inputs, values to compare, delays within; of an idle place, parameter or state no data could say more.
"""

from dataclasses import dataclass
from itertools import compress

import numpy as np

from gaitdisc.channel import hint_nearest
from gaitdisc.discovery.catalogue import SIGNALS, Shape
from gaitdisc.discovery.linearised import pushable
from gaitdisc.discovery.places import Place
from gaitdisc.discovery.shooting import Shooting
from gaitdisc.errors import ChannelError, SamplingError, ShapeError, SimulationError
from gaitdisc.recording import Finding
from gaitdisc.recording.arrays import Values
from gaitdisc.simulation.evaluating import refuse_delays, refuse_own_delays
from gaitdisc.simulation.expression import parse
from gaitdisc.simulation.measured import Measured
from gaitdisc.simulation.simulation import Simulation

FEWEST = 16  # samples of a trial
NUDGE = 0.1  # of a state's or a parameter's size
ROUNDING = 1e-13  # of a channel's size


def match_channels(simulation: Simulation, measured: Measured, shapes: tuple[Shape, ...] = ()) -> Simulation:
    """Return the simulation with the observations that were measured, in their order."""
    where = measured.source or "the measured trials"
    observations = tuple(name for name, _ in simulation.observations)
    for name in measured.channels:
        if name not in observations:
            raise ChannelError(
                f"every measured channel must be an observation of {simulation.title!r}: {', '.join(observations)}",
                f"{where} has {name!r}{hint_nearest(name, observations)}",
                f"Add {name!r} to the observations, or remove the channel.",
            )
        if measured.channels.count(name) > 1:
            raise ChannelError("each channel must have its own name", f"{where} has {name!r} twice", "Rename one.")
    _check_trials(measured, where)
    _check_inputs(simulation, measured, where)
    _check_observed(measured, where)
    _check_filters(simulation, measured, where)
    shortest = int(np.argmin(measured.samples))
    lasts = float(measured.samples[shortest] / measured.rate)
    refuse_delays(simulation, lasts, measured.trials[shortest])
    for shape in shapes:
        for piece in shape.pieces:
            try:
                refuse_own_delays(parse(piece), {}, SIGNALS, lasts, measured.trials[shortest])
            except SimulationError as error:
                raise error.at("shape", shape.name) from None
    return simulation if measured.channels == observations else simulation.observing(measured.channels)


def _check_trials(measured: Measured, where: str) -> None:
    names = measured.trials
    doubled = next((name for name in names if names.count(name) > 1), None)
    if doubled is not None:
        raise ChannelError("each trial must have its own name", f"{where} has {doubled!r} twice", "Rename one trial.")
    short = int(np.argmin(measured.samples))
    if measured.samples[short] < FEWEST:
        raise SamplingError(
            f"a trial must have at least {FEWEST} samples",
            f"{where}, trial {names[short]!r} has {measured.samples[short]} samples",
            "Remove this trial, or record a longer one.",
        )


def _check_inputs(simulation: Simulation, measured: Measured, where: str) -> None:
    names = [signal.name for signal in simulation.inputs]
    inputs = measured.drive.inputs
    if inputs.shape[2] != len(names):
        raise ShapeError(
            f"the trials must have the inputs of {simulation.title!r}: {', '.join(names) or 'none'}",
            f"the number of inputs in {where} is {inputs.shape[2]}",
            "Give one column for each input, in this order.",
        )
    for trial, (name, samples) in enumerate(zip(measured.trials, measured.samples, strict=True)):
        for sample, column in np.argwhere(~np.isfinite(inputs[trial, :samples])):
            raise ShapeError(
                "an input must have a value in every sample",
                f"{where}, trial {name!r}, {names[column]!r}: {inputs[trial, sample, column]} in sample {sample + 1}",
                "Fill the gap, or split the trial there.",
            )


def _check_observed(measured: Measured, where: str) -> None:
    known = np.isfinite(measured.observed)
    for trial, column in np.argwhere(~known.any(axis=1)):
        raise ShapeError(
            "an observed channel must have values in every trial",
            f"{where}, trial {measured.trials[trial]!r} has no value of {measured.channels[column]!r}",
            "Remove the trial or the channel.",
        )
    values = np.where(known, measured.observed, np.nan)
    low, high = np.nanmin(values, axis=(0, 1)), np.nanmax(values, axis=(0, 1))
    for name, least, most in zip(measured.channels, low, high, strict=True):
        if least == most:
            raise ShapeError(
                f"the observed channel {name!r} must vary",
                f"{where} has {least:g} in every sample",
                "Remove the channel from the observations, or correct it.",
            )


def _check_filters(simulation: Simulation, measured: Measured, where: str) -> None:
    file = simulation.source.name if simulation.source else simulation.title
    for name in measured.channels:
        cutoff = simulation.sensor(name).lowpass
        if cutoff is not None and cutoff >= measured.rate / 2:
            raise SamplingError(
                f"the low-pass of an observation must lie below half the sampling rate, {measured.rate / 2:g} Hz",
                f"{file}, [observations.{name}] has lowpass = {cutoff:g}, but {where} has {measured.rate:g} samples "
                "per second",
                "Correct lowpass [Hz], or remove it.",
            )


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
