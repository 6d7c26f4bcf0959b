"""A plain Python function as a simulation: its arguments say what its states, inputs, parameters and ports are."""

import inspect
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from gaitdisc.errors import SimulationError
from gaitdisc.recording.arrays import Values
from gaitdisc.recording.recording import several
from gaitdisc.simulation.expression import LONGEST, written
from gaitdisc.simulation.parts import Input, Parameter, Port, State, Term
from gaitdisc.simulation.python_simulation import PythonSimulation, python_simulation
from gaitdisc.simulation.running import compile_simulation
from gaitdisc.simulation.simulation import Simulation
from gaitdisc.simulation.traced import NotTraced, flat, trace_equations

TIME = "t"
TRIED = 48  # points at which the equations have to give what the function gives
FEWEST = 3  # of them with a number
NEAR = 1e-9  # relative: rounding
PUSH = 0.3  # at the ports there


def simulation_from_function(
    function: Callable[..., Any],
    units: Mapping[str, str] | None = None,
    observations: Mapping[str, str] | None = None,
    states: Sequence[str] | str = (),
    inputs: Sequence[str] | str = (),
    parameters: Mapping[str, float] | None = None,
) -> Simulation | PythonSimulation:
    """Make a simulation from a Python function that returns the time derivative of each state.

    The first arguments are the states, one for each derivative that the function returns. Further arguments without a
    default are inputs, which are columns of the data. Arguments with a default are parameters; the default is the value
    (or a dict of several values). Arguments after a `*` are ports: places where a missing effect may act, zero in the
    initial model. An argument called `t` is the time [s]. With `states`, the function has the form that solvers use,
    `rates(t, x, u, p)`: time, vector of states, vector of inputs (if any) and dict of parameters (if any).

    The function is called once with symbols, which derives its equations from arithmetic, NumPy, `math`, `if`, loops
    and other functions. The simulation then runs as fast as one from a file. If the function does something else (such
    as calling a program), the simulation calls the function itself, with arrays of points if possible, otherwise point
    by point. This is ten to a thousand times slower.

    Parameters
    ----------
    function : callable
        Returns a derivative for each state, in their order: a tuple, a list or an array.
    units : mapping of str to str, optional
        Unit of each argument, `{"angle": "rad", "torque": "N m"}`; other arguments have the unit 1. Give all units or
        none: with units, a discovery reports terms whose units do not match.
    observations : mapping of str to str, optional
        Measured column and its expression of states, inputs and parameters: `{"height": "level + offset"}`. By default
        each state is measured under its own name, if the data have such a column.
    states, inputs : sequence of str, or str, optional
        Names of the elements of the vectors of states and of inputs, if the function takes vectors.
    parameters : mapping of str to float, optional
        Names and values of the parameters, if the function takes them as a dict.

    Returns
    -------
    Simulation or PythonSimulation
        A simulation for `gaitdisc.simulate` and `gaitdisc.discover`.

    Raises
    ------
    SimulationError
        If the function has too few arguments or a default that is not a number, if it always raises an error, or if
        it returns different derivatives when it is called again.

    Examples
    --------
    >>> import gaitdisc as gd
    >>> def tank(level, pump, area=0.8, drain=1.1, *, leak=0.0):
    ...     return (pump + leak - drain * level) / area
    >>> gd.simulation_from_function(tank, units={"level": "m", "pump": "m^3/s"}).equations
    (('level', '(pump + leak - drain*level)/area'),)
    >>> def swing(t, x, u, p):
    ...     return [x[1], u[0] - p["k"] * x[0]]
    >>> gd.simulation_from_function(swing, states=["angle", "rate"], inputs=["moment"], parameters={"k": 2.0}).equations
    (('angle', 'rate'), ('rate', 'moment - k*angle'))
    """
    states, inputs = several(states), several(inputs)
    taken = _by_name(function) if not states else _as_vectors(function, states, inputs, dict(parameters or {}))
    count = taken.derivatives
    if count > len(taken.signals) or (states and count != len(states)):
        stated = f"states: {len(states)}" if states else f"arguments without a default: {len(taken.signals)}"
        raise SimulationError(
            "the first arguments of a simulation's function must be its states, one for each derivative",
            f"derivatives that {taken.title} returns: {count}; {stated}",
            "Give every state its own argument, before the inputs.",
        )
    unit, known = dict(units or {}), (*taken.signals, *taken.numbers, *taken.ports)
    unknown = next((name for name in unit if name not in known), None)
    if unknown is not None:
        raise SimulationError(
            "a unit must belong to an argument of the function",
            f"{taken.title} has no argument {unknown!r}",
            f"Known: {', '.join(known)}.",
        )
    parts = (
        tuple(State(name, unit.get(name, "1")) for name in taken.signals[:count]),
        tuple(Input(name, unit.get(name, "1")) for name in taken.signals[count:]),
        tuple(Parameter(name, value, unit.get(name, "1")) for name, value in taken.numbers.items()),
        tuple(Port(name, unit.get(name, "1")) for name in taken.ports),
    )
    seen = tuple((observations or {}).items())
    try:
        texts = [written(tree) for tree in trace_equations(taken.function, taken.arguments)]
        if len(texts) != count or max(map(len, texts)) > LONGEST:
            raise NotTraced("its expressions are too long")
        equations = tuple(zip(taken.signals[:count], texts, strict=True))
        simulation = Simulation(taken.title, *parts, equations=equations, observations=seen)
        return _refuse_other_numbers(simulation, taken)
    except NotTraced as reason:
        rates = _Called(taken, by_points=False)
        rates = rates if rates.agrees else _Called(taken, by_points=True)
        model = python_simulation(taken.title, rates, *parts, observations)
        return replace(model, manner=f"{rates.manner}, because its equations could not be derived: {reason}")


class _NoNumbersError(TypeError):
    """What a function returned is no sequence of numbers."""


@dataclass(frozen=True, eq=False)
class _Taken:
    """A function, and what its arguments mean."""

    function: Callable[..., Any]
    signals: tuple[str, ...]
    numbers: dict[str, float]
    ports: tuple[str, ...]
    arguments: Callable[[Callable[[str], Any]], tuple[tuple, dict]]  # from what gives the value of a name
    remedy: str = "Call the function yourself with numbers, and correct it."  # where it raises whatever it is given
    raised: list[Exception] = field(default_factory=list)  # at the points where it did

    @property
    def title(self) -> str:
        """What it is called."""
        return _title(self.function)

    @cached_property
    def derivatives(self) -> int:
        """How many it returns."""
        tries = [(point, rates) for point, rates in zip(self.points, self.returned, strict=True) if rates]
        if not tries:
            raised = self.raised[0]
            what = f"{self.title} raised {type(raised).__name__}: {raised!s:.200}"
            raise SimulationError(
                "a simulation's function must accept a number for each argument and return a derivative for each state",
                str(raised) if isinstance(raised, _NoNumbersError) else what,
                self.remedy,
            ) from raised
        point, before = tries[-1]
        again = self._try(point)
        if not np.array_equal(again, before, equal_nan=True):
            raise SimulationError(
                "a simulation's function must return the same derivatives whenever it is called with the same numbers",
                f"{self.title} returned {before}, then {again}",
                "Remove random numbers and internal memory. Noise belongs to the measurement.",
            )
        return len(tries[0][1])

    @cached_property
    def points(self) -> list[dict[str, float]]:
        """Where it is tried, value by name: near, far, at rest; parameters near their own values."""
        rng = np.random.default_rng(0)
        points = []
        for number in range(TRIED):
            low, high = ((-0.5, 0.5), (-2.0, 2.0), (0.1, 1.0), (0.0, 0.0))[number % 4]
            signals = {name: float(rng.uniform(low, high)) for name in self.signals}
            numbers = {name: value * float(rng.uniform(0.8, 1.2)) for name, value in self.numbers.items()}
            points.append({TIME: float(rng.uniform(0, 5)), **signals, **numbers, **dict.fromkeys(self.ports, PUSH)})
        return points

    def tabulate(self, *groups: Iterable[str]) -> list[Values]:
        """Values of groups of names at the points, (point, name) each."""
        tables = ([[point[name] for name in names] for point in self.points] for names in groups)
        return [np.array(table).reshape(TRIED, -1) for table in tables]

    @cached_property
    def returned(self) -> list[list[float]]:
        """Derivatives at each point; none where it raises."""
        return [self._try(point) for point in self.points]

    def _try(self, point: Mapping[str, float]) -> list[float]:
        try:
            return self.at(point)
        except Exception as error:  # whatever a user's function raises
            self.raised.append(error)
            return []

    def at(self, point: Mapping[str, Any]) -> list[float]:
        """Derivatives at one point."""
        plain, named = self.arguments(point.__getitem__)
        value = self.function(*plain, **named)
        if isinstance(value, tuple | list) and value and all(type(number) is float for number in value):
            return [*value]
        numbers = [] if value is None or isinstance(value, str | Mapping) else [float(each) for each in flat(value)]
        if not numbers:
            raise _NoNumbersError(f"{self.title} returns {value!r:.60}")
        return numbers

    def gives(self, rates: Values) -> bool:
        """Whether derivatives (point, state) are what it returns, wherever that is a number."""
        there = [number for number, output in enumerate(self.returned) if output and np.all(np.isfinite(output))]
        known = np.array([self.returned[number] for number in there]).reshape(len(there), -1)
        return len(there) >= FEWEST and bool(np.all(np.abs(rates[there] - known) <= NEAR * np.abs(known).max(axis=0)))


@dataclass(frozen=True)
class _Called:
    """The right-hand side of a `PythonSimulation`: rows in, derivatives out, by calls of the function."""

    taken: _Taken
    by_points: bool

    @property
    def manner(self) -> str:
        """How it is called, for a person."""
        how = "one point at a time, which takes minutes" if self.by_points else "with arrays of points"
        return f"{self.taken.title} is called {how}"

    @property
    def agrees(self) -> bool:
        """Whether many points at once give what each gives by itself."""
        taken, count = self.taken, self.taken.derivatives
        groups = taken.signals[:count], taken.signals[count:], taken.numbers, taken.ports
        t, *columns = taken.tabulate((TIME,), *groups)
        try:
            with np.errstate(all="ignore"):
                return taken.gives(self(t[:, 0], *columns))
        except Exception:  # whatever a user's function raises of arrays
            return False

    def __call__(self, t: Any, x: Any, u: Any, values: Any, pushes: Any) -> Values:
        names = (TIME, *self.taken.signals, *self.taken.numbers, *self.taken.ports)
        numbers = values[:, : len(self.taken.numbers)]  # parameters of effects come after the function's own
        columns = [t, *x.T, *u.T, *numbers.T, *pushes.T]
        if self.by_points:
            rows = zip(*(column.tolist() for column in columns), strict=True)
            return np.array([self._one(dict(zip(names, row, strict=True))) for row in rows]).reshape(x.shape)
        plain, named = self.taken.arguments(dict(zip(names, columns, strict=True)).__getitem__)
        result = self.taken.function(*plain, **named)
        if not isinstance(result, tuple | list):
            result = np.reshape(np.asarray(result, float), (self.taken.derivatives, -1))
        rates = np.empty(x.shape)
        for state, rate in enumerate(result):
            rates[:, state] = rate
        return rates

    def _one(self, point: Mapping[str, float]) -> list[float]:
        try:
            return self.taken.at(point)
        except (ValueError, ArithmeticError):  # `math` raises where NumPy gives what is no number
            return [np.nan] * self.taken.derivatives


def _refuse_other_numbers(simulation: Simulation, taken: _Taken) -> Simulation:
    """The simulation itself, where it gives what the function gives."""
    pushed = simulation
    for name in taken.ports:
        pushed = pushed.with_effect(Term(name, "port", "push", repr(PUSH)))
    machine = compile_simulation(pushed)
    t, x, u, values = taken.tabulate((TIME,), machine.states, machine.inputs, machine.parameters)
    if not taken.gives(machine.rates(t[:, 0], x, u, values)):
        raise NotTraced("the derived equations give numbers that differ from those of the function")
    return simulation


def _by_name(function: Callable[..., Any]) -> _Taken:
    """A function that has an argument for each state, input, parameter and port."""
    arguments = inspect.signature(function).parameters
    for arg in arguments.values():
        if arg.kind in (arg.VAR_POSITIONAL, arg.VAR_KEYWORD, arg.POSITIONAL_ONLY):
            raise SimulationError(
                "a simulation's function must name each of its states, inputs and parameters as an argument",
                f"{_title(function)} has {str(arg)!r}",
                "Write one argument for each. If the function takes vectors, name their elements: "
                "simulation_from_function(function, states=[...], inputs=[...], parameters={...}).",
            )
    plain = [arg.name for arg in arguments.values() if arg.default is arg.empty and arg.kind is not arg.KEYWORD_ONLY]
    ports = tuple(arg.name for arg in arguments.values() if arg.kind is arg.KEYWORD_ONLY)
    defaults = {name: arguments[name].default for name in arguments if name not in (*plain, *ports)}
    dicts = {name: [str(key) for key in default] for name, default in defaults.items() if isinstance(default, Mapping)}
    numbers: dict[str, float] = {}
    for name, default in defaults.items():
        named = default if name in dicts else {name: default}
        numbers |= {str(key): _number(function, name, value) for key, value in named.items()}
    single = [name for name in (*plain, *defaults, *ports) if name not in dicts]

    def from_values(value: Callable[[str], Any]) -> tuple[tuple, dict]:
        named = {name: value(name) for name in single}
        for name, keys in dicts.items():
            named[name] = {key: value(key) for key in keys}
        return (), named

    signals = tuple(name for name in plain if name != TIME)
    if len(plain) - len(signals) == 1 == len(signals):  # a solver's f(t, y), or that of odeint
        order = "" if plain[0] == TIME else " (with the time as the first argument)"
        remedy = (
            f"If {signals[0]!r} is the vector of the states, name them{order}: "
            f'gaitdisc.simulation_from_function({_title(function)}, states=["angle", "rate"]).'
        )
        return _Taken(function, signals, numbers, ports, from_values, remedy)
    return _Taken(function, signals, numbers, ports, from_values)


def _as_vectors(
    function: Callable[..., Any], states: Sequence[str], inputs: Sequence[str], parameters: Mapping[str, float]
) -> _Taken:
    """A function of the time, the vector of the states and, where there are any, of the inputs and the parameters."""
    numbers = {name: _number(function, name, value) for name, value in parameters.items()}
    taken = [arg for arg in inspect.signature(function).parameters.values() if arg.default is arg.empty]
    count = 1 + bool(inputs) + bool(numbers)
    if len(taken) not in (count, count + 1):
        named = ["t", "x", *(["u"] if inputs else []), *(["p"] if numbers else [])]
        raise SimulationError(
            f"with these states, inputs and parameters the function must take ({', '.join(named)})",
            f"{_title(function)} takes ({', '.join(arg.name for arg in taken)})",
            "Name the elements of each vector, or give the function these arguments.",
        )

    def from_values(value: Callable[[str], Any]) -> tuple[tuple, dict]:
        vectors = [np.array([value(name) for name in names]) for names in (states, inputs) if names]
        dicts = [{name: value(name) for name in numbers}] if numbers else []
        return (*([value(TIME)] if len(taken) > count else []), *vectors, *dicts), {}

    swapped = len(taken) > count and taken[0].name != TIME and any(arg.name == TIME for arg in taken)
    remedy = f"Put the time first: def {_title(function)}(t, {taken[0].name}): ..." if swapped else _Taken.remedy
    return _Taken(function, (*states, *inputs), numbers, (), from_values, remedy)


def _title(function: Callable[..., Any]) -> str:
    return getattr(function, "__name__", type(function).__name__)


def _number(function: Callable[..., Any], name: str, value: Any) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float | np.number):
        raise SimulationError(
            "an argument with a default must be a parameter of the simulation: a number or a dict of numbers",
            f"{_title(function)} has {name}={value!r}",
            "Use a number, or remove the default.",
        )
    return float(value)
