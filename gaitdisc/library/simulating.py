"""Run a simulation over time; a model as a script names it."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

import numpy as np
from numpy.typing import ArrayLike

from gaitdisc.channel import Channel, find_side
from gaitdisc.engines.engine import Engine
from gaitdisc.engines.mapping import replace_inputs
from gaitdisc.engines.written import whole_model
from gaitdisc.errors import ShapeError, SimulationError, UnitError
from gaitdisc.ingest.table import has_times
from gaitdisc.library.walks import make_recording
from gaitdisc.recording import Recording, Source
from gaitdisc.recording.arrays import Values, mean_rate
from gaitdisc.recording.strides import interpolate
from gaitdisc.simulation.compiled_simulation import Drive, Rows
from gaitdisc.simulation.evaluating import Points, evaluate_many
from gaitdisc.simulation.functions import simulation_from_function
from gaitdisc.simulation.python_simulation import PythonSimulation
from gaitdisc.simulation.running import compile_simulation, refuse_divergence
from gaitdisc.simulation.simulation import Simulation
from gaitdisc.simulation.simulation_file import names_engine, read_simulation

if TYPE_CHECKING:
    import pandas as pd

ModelLike = Path | str | Simulation | PythonSimulation | Callable[..., Any]


def as_model(model: ModelLike) -> Simulation:
    """Simulation of what a script names.

    model: a simulation file, an object, or a Python function as `simulation_from_function` takes it
    raises SimulationError if it is none of these, or the file or function does not hold together
    """
    if isinstance(model, Path | str):
        return read_simulation(model)
    if isinstance(model, Simulation):
        return model
    if isinstance(model, PythonSimulation):
        return cast("Simulation", model)  # it goes wherever a `Simulation` goes
    if callable(model):
        return cast("Simulation", simulation_from_function(model))
    raise SimulationError(
        "a model must be a simulation file, a Simulation or a Python function",
        f"found {type(model).__name__}",
        "Give the path of a .toml file, or a function that returns the derivative of each state.",
    )


def simulate(
    model: ModelLike,
    time: ArrayLike,
    inputs: Recording | pd.DataFrame | Mapping[str, ArrayLike] | None = None,
    start: Mapping[str, float] | Sequence[float] | None = None,
) -> Recording:
    """Run a simulation (Runge-Kutta of order 4; an engine's model with its own integrator) and return its observations.

    Parameters
    ----------
    model : path, Simulation or callable
        A simulation file, the result of `read_simulation`, a Python function (see `simulation_from_function`), or a
        MuJoCo or OpenSim model or its mapping file (docs/engines.md), which the engine runs.
    time : array_like (time,) [s]
        Times, evenly spaced and increasing.
    inputs : Recording, DataFrame or mapping of str to array_like (time,), optional
        Inputs of the simulation by name [the input's unit]. A Recording, or a DataFrame with times, is interpolated
        linearly at `time`; a mapping may also contain a number or a function of time.
    start : mapping of str to float, or sequence of float (state,), optional
        State at the first time [the state's unit]; other states start at their `initial`.

    Returns
    -------
    Recording
        The observed channels, then the other states, then the inputs. A channel whose unit is not in the list
        (`gaitdisc.units`) has the unit 1.

    Raises
    ------
    SimulationError
        If an input or an initial value is missing or unknown, or the simulation diverges; the message gives state, time
        and parameter.
    SamplingError, ShapeError
        If time is not evenly spaced, or an input does not have one value per time.

    Examples
    --------
    >>> import gaitdisc as gd
    >>> def falling(height, speed, gravity=9.81):
    ...     return speed, -gravity
    >>> ball = gd.simulate(falling, np.linspace(0.0, 1.0, 101), start={"height": 10.0, "speed": 0.0})
    >>> round(float(ball["height"][-1]), 3)
    5.095
    """
    engine = None
    if isinstance(model, Path | str) and names_engine(model):
        simulation, engine = whole_model(model)
    else:
        simulation = as_model(model)
    time = np.asarray(time, float)
    if time.ndim != 1 or len(time) < 3:
        raise ShapeError(
            "a simulation must have at least three increasing times [s]",
            f"found {time.tolist() if time.size < 3 else time.shape}",
            "Give every time, for example np.linspace(start, end, number).",
        )
    base = Recording(time, np.empty((len(time), 0)), ())  # refuses a time that is not even
    driven, begun = _driven(simulation, time, inputs), _start(simulation, start)
    states, seen = (_run if engine is None else partial(_run_by, engine))(simulation, time, driven, begun)
    for parts, values in ((simulation.states, states), (simulation.inputs, driven)):
        seen |= {part.name: column for part, column in zip(parts, values.T, strict=True) if part.name not in seen}
    channels = tuple(_channel(name, simulation) for name in seen)
    return Recording(base.time, np.column_stack([*seen.values()]), channels, source=Source(reader="simulation"))


def _run(simulation: Simulation, time: Values, driven: Values, start: Values) -> tuple[Values, dict[str, Values]]:
    """States (time, state) and observed channels (time,)."""
    machine = compile_simulation(simulation)
    drive = Drive.of([driven], mean_rate(time), float(time[0]))
    rows = Rows(np.zeros(1, np.int64), np.zeros(1, np.int64), start[None])
    states, ok = machine.run(drive, rows, len(time) - 1)
    if not ok.all():
        refuse_divergence(machine, drive, rows, states, ok)
    return states[0], dict(zip(machine.observed, machine.observe(drive, rows, states)[0].T, strict=True))


def _run_by(
    engine: Engine, simulation: Simulation, time: Values, driven: Values, start: Values
) -> tuple[Values, dict[str, Values]]:
    """States (time, state) by an engine's own integrator, and observed channels (time,)."""
    count, rate = len(engine.coordinates), mean_rate(time)
    q, v = start[None, :count], start[None, count:]
    driven = replace_inputs(simulation, time, driven, rate)
    held = engine.along(np.repeat(q, 2, axis=0), np.zeros((2, count)), driven[:2], rate).at(np.zeros(1, np.intp))
    states = engine.run(replace(engine.near(held, q, v), t=time[:1]), driven[None], rate)[0]
    lost = np.flatnonzero(~np.isfinite(states).all(axis=1))
    if lost.size:
        raise SimulationError(
            f"{engine.called} must run {engine.path.name} to the end",
            f"the states are not finite from t = {time[lost[0]]:.6g} s on",
            "Use another initial state, or check the inputs at that time.",
        )
    channels, expressions = zip(*simulation.observations, strict=True)
    seen = evaluate_many(replace(simulation, model=""), expressions, Points(time, states, driven, rate=rate))
    return states, dict(zip(channels, seen, strict=True))


def _driven(simulation: Simulation, time: Values, inputs: Any) -> Values:
    """Inputs (time, input)."""
    names = [signal.name for signal in simulation.inputs]
    if not names:
        return np.empty((len(time), 0))
    source: Any = {} if inputs is None else inputs
    if not isinstance(source, Recording | Mapping) and not hasattr(source, "columns"):
        raise SimulationError(
            f"{simulation.title or 'the simulation'!r} must have the inputs {', '.join(names)}",
            f"the inputs were given as {type(source).__name__} without names",
            f"Name the inputs: inputs={{{names[0]!r}: values}}, or use a DataFrame or Recording with these columns.",
        )
    table: Any = source
    if hasattr(table, "columns") and has_times(table):  # it is read at the simulation's times
        source = make_recording(table.select_dtypes("number"))
    known = source.names if isinstance(source, Recording) else [str(name) for name in source]
    columns = []
    for name in names:
        if name not in known:
            raise SimulationError(
                f"{simulation.title or 'the simulation'!r} must have the inputs {', '.join(names)}",
                f"{name!r} is not among the given inputs ({', '.join(known) or 'none'})",
                f"Add this input: inputs={{{name!r}: values}}.",
            )
        if isinstance(source, Recording):
            values = interpolate(source.time, source.selected([name]).values, time)[:, 0]
        else:
            values = np.asarray(source[name](time) if callable(source[name]) else source[name], float)
            values = np.full(len(time), values) if values.ndim == 0 else values
        if values.shape != time.shape:
            raise ShapeError(
                f"the input {name!r} must have one value per time point",
                f"its shape is {values.shape}, but there are {len(time)} time points",
                "Give one value per time point.",
            )
        columns.append(values)
    driven = np.column_stack(columns)
    bad = np.argwhere(~np.isfinite(driven))
    if bad.size:
        row, column = bad[0]
        raise SimulationError(
            "every input must have a value at each time",
            f"{names[column]!r} is missing at t = {time[row]:.6g} s",
            "Fill the gap, or simulate a shorter period.",
        )
    return driven


def _start(simulation: Simulation, start: Mapping[str, float] | Sequence[float] | None) -> Values:
    names = [state.name for state in simulation.states]
    if start is not None and not isinstance(start, Mapping):
        if np.shape(start) != (len(names),):
            raise ShapeError(
                f"the start must have a number for each state: {', '.join(names)}",
                f"found an array of shape {np.shape(start)}",
                "Give one number per state, or name them: start={'state': value}.",
            )
        start = dict(zip(names, start, strict=True))
    moved = simulation.with_starts(start or {})
    for state in moved.states:
        if state.initial is None:
            raise SimulationError(
                "every state of a simulation must have an initial value",
                f"the state {state.name!r} has none",
                f"Add this value: start={{{state.name!r}: value}}.",
            )
    return np.array([state.initial for state in moved.states], float)


def _channel(name: str, simulation: Simulation) -> Channel:
    units = {part.name: part.unit for part in (*simulation.states, *simulation.inputs)}
    observed = dict(simulation.observations).get(name, name)
    unit = simulation.sensor(name).unit or units.get(name) or units.get(observed.strip(), "1")
    side = find_side(name)
    try:
        return Channel(name, "signal", unit, side)
    except UnitError:
        return Channel(name, "signal", "1", side)
