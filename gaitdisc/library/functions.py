"""A plain Python function as a simulation: its arguments say what its states, inputs, parameters and ports are."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gaitdisc.simulation.parts import Input, Parameter, Port, State
from gaitdisc.simulation.python_simulation import PythonSimulation, python_simulation
from gaitdisc.simulation.refusal import SimulationError

TIME = "t"


def simulation_from_function(
    function: Callable[..., Any],
    units: Mapping[str, str] | None = None,
    observations: Mapping[str, str] | None = None,
) -> PythonSimulation:
    """Simulation of a Python function that gives the time derivative of each state.

    The arguments say what is what. The first ones are the states, as many as the function returns derivatives.
    Arguments after them without a default are inputs, columns of the data; those with a default are parameters, and
    the default is their value. Arguments after a `*` are ports: places where a missing effect may enter, zero in the
    model as it is. An argument called `t` is the time [s].

    Parameters
    ----------
    function : callable
        Returns a derivative for each state, in their order: one array, or a tuple of arrays. It is called with arrays
        of many points at once, so it computes with NumPy (`np.sin`, `np.where`) and not with `if`.
    units : mapping of str to str, optional
        Unit of each argument, `{"angle": "rad", "torque": "N m"}`; what is not named has the unit 1.
    observations : mapping of str to str, optional
        Measured column and what it measures, in states, inputs and parameters: `{"height": "level + offset"}`. By
        default each state is measured under its own name, as far as the data have such a column.

    Returns
    -------
    PythonSimulation
        Goes wherever a simulation goes: `gaitdisc.simulate`, `gaitdisc.discover`.

    Raises
    ------
    SimulationError
        If the function has too few arguments, a default that is no number, or does not compute with arrays.

    Examples
    --------
    >>> import gaitdisc as gd
    >>> def tank(level, pump, area=0.8, drain=1.1, *, leak=0.0):
    ...     return (pump + leak - drain * level) / area
    >>> model = gd.simulation_from_function(tank, units={"level": "m", "pump": "m^3/s"})
    >>> [part.name for part in (*model.states, *model.inputs, *model.parameters, *model.ports)]
    ['level', 'pump', 'area', 'drain', 'leak']
    """
    named = inspect.signature(function).parameters.values()
    _refuse_unnamed(function, named)
    plain = [one.name for one in named if one.kind is one.POSITIONAL_OR_KEYWORD and one.default is one.empty]
    numbers = {one.name: _number(function, one) for one in named if one.default is not one.empty and not _port(one)}
    ports = [one.name for one in named if _port(one)]
    signals = [name for name in plain if name != TIME]
    count = _states_of(function, plain, numbers, ports)
    if count > len(signals):
        raise SimulationError(
            "the first arguments of a simulation's function are its states, one for each derivative",
            f"{_title(function)} returns {count} derivatives and has {len(signals)} arguments without a default",
            "Give every state an argument of its own, before the inputs.",
        )
    unit = dict(units or {})
    _refuse_unknown_units(function, unit, [*signals, *numbers, *ports])
    return python_simulation(
        _title(function),
        _rates(function, plain, list(numbers), ports, count),
        [State(name, unit.get(name, "1")) for name in signals[:count]],
        [Input(name, unit.get(name, "1")) for name in signals[count:]],
        [Parameter(name, value, unit.get(name, "1")) for name, value in numbers.items()],
        [Port(name, unit.get(name, "1")) for name in ports],
        tuple((observations or {}).items()),
    )


def _title(function: Callable[..., Any]) -> str:
    return getattr(function, "__name__", type(function).__name__)


def _port(one: inspect.Parameter) -> bool:
    return one.kind is one.KEYWORD_ONLY


def _refuse_unnamed(function: Callable[..., Any], named: Any) -> None:
    for one in named:
        if one.kind in (one.VAR_POSITIONAL, one.VAR_KEYWORD, one.POSITIONAL_ONLY):
            raise SimulationError(
                "a simulation's function names each of its states, inputs and parameters as an argument",
                f"{_title(function)} has {str(one)!r}",
                "Write one argument for each.",
            )


def _number(function: Callable[..., Any], one: inspect.Parameter) -> float:
    if isinstance(one.default, bool) or not isinstance(one.default, int | float | np.number):
        raise SimulationError(
            "an argument with a default is a parameter of the simulation, a number",
            f"{_title(function)} has {one.name}={one.default!r}",
            "Give it a number, or take the default away.",
        )
    return float(one.default)


def _refuse_unknown_units(function: Callable[..., Any], units: Mapping[str, str], known: list[str]) -> None:
    unknown = next((name for name in units if name not in known), None)
    if unknown is not None:
        raise SimulationError(
            "a unit belongs to an argument of the function",
            f"{_title(function)} has none called {unknown!r}",
            f"Known: {', '.join(known)}.",
        )


def _states_of(function: Callable[..., Any], plain: list[str], numbers: Mapping[str, float], ports: list[str]) -> int:
    """How many derivatives the function returns for two points."""
    given = {name: np.full(2, 0.5) for name in plain} | {name: np.full(2, value) for name, value in numbers.items()}
    given |= {name: np.zeros(2) for name in ports}
    try:
        with np.errstate(all="ignore"):
            found = function(**given)
        return len(found) if isinstance(found, tuple | list) else len(np.atleast_2d(np.asarray(found, float)))
    except Exception as error:  # whatever a user's function raises
        raise SimulationError(
            "a simulation's function takes arrays, one number a point, and returns a derivative for each state",
            f"{_title(function)} raised {type(error).__name__}: {str(error)[:200]}",
            "Compute with NumPy (np.sin, np.where in place of if), and return a tuple of arrays.",
        ) from error


def _rates(
    function: Callable[..., Any], plain: list[str], numbers: list[str], ports: list[str], states: int
) -> Callable[..., NDArray[np.float64]]:
    signals = [name for name in plain if name != TIME]

    def rates(t: Any, x: Any, u: Any, values: Any, pushes: Any) -> NDArray[np.float64]:
        given = dict(zip(signals, (*x.T, *u.T), strict=True))
        given |= dict(zip(numbers, values.T, strict=False))  # parameters of effects come after the function's own
        given |= dict(zip(ports, pushes.T, strict=True))
        if TIME in plain:
            given[TIME] = t
        found = function(**given)
        columns = found if states > 1 or isinstance(found, tuple | list) else (found,)
        return np.column_stack([np.broadcast_to(np.asarray(one, float), len(x)) for one in columns])

    return rates
