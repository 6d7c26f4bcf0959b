"""Whether measured trials are trials of a simulation: its channels, its inputs, values to compare, delays within."""

from __future__ import annotations

import numpy as np

from gaitdisc.channel import hint_nearest
from gaitdisc.discovery.catalogue import SIGNALS, Shape
from gaitdisc.errors import ChannelError, SamplingError, ShapeError, SimulationError
from gaitdisc.simulation.evaluating import refuse_delays, refuse_own_delays
from gaitdisc.simulation.expression import parse
from gaitdisc.simulation.measured import Measured
from gaitdisc.simulation.simulation import Simulation

FEWEST = 16  # samples of a trial


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
