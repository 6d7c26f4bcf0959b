"""A simulation: states, inputs, parameters, ports, equations, and the effects that were added to it."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from gaitdisc.errors import SimulationError
from gaitdisc.simulation.checking import check
from gaitdisc.simulation.expression import parse, substitute, written
from gaitdisc.simulation.parts import SECTIONS, Input, Lines, Parameter, Port, Sensor, State, Term
from gaitdisc.words import as_html


@dataclass(frozen=True)
class Simulation:
    """A dynamical system, as a simulation file describes it. It is immutable, and checked when it is created.

    Parameters
    ----------
    title : str
        Title in one line.
    states : tuple of State
        States in the order of the state vector.
    inputs : tuple of Input
        Measured signals that drive the simulation.
    parameters : tuple of Parameter
        Parameters of the model.
    ports : tuple of Port
        Places where a missing effect may act; zero in the initial model.
    definitions : tuple of (str, str)
        Name and expression; an expression may use earlier definitions.
    equations : tuple of (str, str)
        State and expression of its time derivative, in the order of the states.
    observations : tuple of (str, str)
        Measured column and expression; by default, each state is measured under its own name.
    effects : tuple of Term
        The added effects and their places.
    sensors : tuple of Sensor
        Sensors of the observed channels, if the file states them.
    source : Path, optional
        File of the simulation.
    layout : str
        Text of the file, whose comments and order are kept when it is written back.
    model : str
        Model file of an engine (OpenSim, MuJoCo) that contains the equations.
    inexact : float
        Error of the runs that does not indicate a missing effect, as a fraction of each observed channel's standard
        deviation; treated as white noise.

    Raises
    ------
    SimulationError
        If a name is unknown or occurs twice, an expression cannot be parsed, a port is not used, or an equation is
        missing.

    Examples
    --------
    >>> falling = Simulation("falling", (State("v", "m/s"),), equations=(("v", "-9.81"),))
    >>> falling.with_effect(Term("v", "equation", "viscous_damping", "-0.4*v")).effects[0].term
    '-0.4*v'
    """

    title: str
    states: tuple[State, ...]
    inputs: tuple[Input, ...] = ()
    parameters: tuple[Parameter, ...] = ()
    ports: tuple[Port, ...] = ()
    definitions: Lines = ()
    equations: Lines = ()
    observations: Lines = ()
    effects: tuple[Term, ...] = ()
    sensors: tuple[Sensor, ...] = ()
    source: Path | None = field(default=None, compare=False)
    layout: str = field(default="", compare=False, repr=False)
    model: str = ""
    inexact: float = field(default=0.0, repr=False)

    def __post_init__(self) -> None:
        """Make every part a tuple, and refuse what does not hold together."""
        for part in ("states", "inputs", "parameters", "ports", "effects", "sensors"):
            object.__setattr__(self, part, tuple(getattr(self, part)))
        for section in SECTIONS:
            lines = getattr(self, section)
            pairs = lines.items() if isinstance(lines, Mapping) else lines
            object.__setattr__(self, section, tuple((str(name), str(text)) for name, text in pairs))
        if not self.observations:
            object.__setattr__(self, "observations", tuple((state.name, state.name) for state in self.states))
        order = {name: number for number, (name, _) in enumerate(self.observations)}
        known = [sensor for sensor in self.sensors if sensor.known]
        known.sort(key=lambda sensor: order.get(sensor.channel, len(order)))  # what belongs to none of them stands last
        object.__setattr__(self, "sensors", tuple(known))
        check(self)

    def __repr__(self) -> str:
        effects = "".join(f", {effect.name} at {effect.place}" for effect in self.effects)
        return f"Simulation({self.title!r}: states {', '.join(state.name for state in self.states)}{effects})"

    def _repr_html_(self) -> str:
        rows = [(f"d{state}/dt", term) for state, term in self.equations]
        rows += [(p.name, f"{p.value:g} {p.unit}") for p in self.parameters]
        rows += [(f"at {effect.place}", effect.term) for effect in self.effects]
        return as_html(self.title, [*rows, *((f"observed {name}", term) for name, term in self.observations)])

    @property
    def signals(self) -> tuple[str, ...]:
        """Names of the states and inputs, which vary in time and can be delayed."""
        return (*(state.name for state in self.states), *(signal.name for signal in self.inputs))

    @property
    def driving(self) -> tuple[Input, ...]:
        """Measured inputs, without computed ones."""
        return tuple(signal for signal in self.inputs if not signal.computed)

    def expressions(self) -> Iterator[tuple[tuple[str, str], str]]:
        """Every expression with its section and key in the simulation file; the key of an effect is its number."""
        for section in SECTIONS:
            for name, text in getattr(self, section):
                yield (section, name), text
        for number, effect in enumerate(self.effects):
            yield ("effects", str(number)), effect.term

    def values(self) -> dict[str, float]:
        """Parameters by name."""
        return {parameter.name: parameter.value for parameter in self.parameters}

    def sensor(self, channel: str) -> Sensor:
        """Sensor of an observed channel; without details if the file states none.

        Parameters
        ----------
        channel : str
            Name of the observation.
        """
        return next((sensor for sensor in self.sensors if sensor.channel == channel), Sensor(channel))

    def with_sensor(self, sensor: Sensor) -> Simulation:
        """Simulation with another sensor of an observed channel.

        Parameters
        ----------
        sensor : Sensor
            New sensor; it replaces the sensor of the same channel.
        """
        return replace(self, sensors=(*(s for s in self.sensors if s.channel != sensor.channel), sensor))

    def with_effect(self, term: Term) -> Simulation:
        """Simulation with one additional effect.

        Parameters
        ----------
        term : Term
            The effect and its port or equation.
        """
        return replace(self, effects=(*self.effects, term))

    def without_effects(self) -> Simulation:
        """Simulation without added effects."""
        return replace(self, effects=())

    def with_values(self, values: Mapping[str, float]) -> Simulation:
        """Simulation with other values of some parameters.

        Parameters
        ----------
        values : mapping of str to float
            New values by the name of the parameter [the parameter's unit].

        Raises
        ------
        SimulationError
            If there is no parameter of that name, or a value is not finite.
        """
        _refuse_unknown(values, "a parameter", [p.name for p in self.parameters])
        changed = (replace(p, value=float(values.get(p.name, p.value))) for p in self.parameters)
        return replace(self, parameters=tuple(changed))

    def with_starts(self, starts: Mapping[str, float]) -> Simulation:
        """Simulation with other initial values of some states.

        Parameters
        ----------
        starts : mapping of str to float
            Initial values by the name of the state [the state's unit].

        Raises
        ------
        SimulationError
            If there is no state of that name, or a value is not finite.
        """
        _refuse_unknown(starts, "a state", [state.name for state in self.states])
        changed = (
            replace(state, initial=float(starts[state.name])) if state.name in starts else state
            for state in self.states
        )
        return replace(self, states=tuple(changed))

    def with_state(self, state: State, equation: str) -> Simulation:
        """Simulation with one additional state after the others, which is not observed.

        Parameters
        ----------
        state : State
            State with its name, unit and initial value.
        equation : str
            Expression of its time derivative; it may use the names of the simulation and of the new state.
        """
        return replace(self, states=(*self.states, state), equations=(*self.equations, (state.name, equation)))

    def with_equation(self, state: str, equation: str) -> Simulation:
        """Simulation with another time derivative of one state.

        Parameters
        ----------
        state : str
            Name of the state.
        equation : str
            Expression; it may use the names of the simulation.
        """
        equations = ((name, equation if name == state else text) for name, text in self.equations)
        return replace(self, equations=tuple(equations))

    def with_parameter(self, parameter: Parameter) -> Simulation:
        """Simulation with a new parameter, in place of an existing parameter of the same name.

        Parameters
        ----------
        parameter : Parameter
            Parameter with its name, value and unit.
        """
        parameters = {p.name: p for p in self.parameters} | {parameter.name: parameter}
        return replace(self, parameters=tuple(parameters.values()))

    def with_observation(self, name: str, expression: str) -> Simulation:
        """Simulation with an additional observed channel, or another expression for an existing channel.

        Parameters
        ----------
        name : str
            Name of the measured column.
        expression : str
            Expression; it may use the names of the simulation.
        """
        return replace(self, observations=tuple((dict(self.observations) | {name: expression}).items()))

    def observing(self, names: Sequence[str]) -> Simulation:
        """Simulation with only some of its observations, in the order requested.

        Parameters
        ----------
        names : sequence of str
            Names of the measured columns.

        Raises
        ------
        SimulationError
            If a name belongs to no observation.
        """
        has = dict(self.observations)
        _refuse_unknown(names, "an observation", has)
        sensors = tuple(sensor for sensor in self.sensors if sensor.channel in names)
        return replace(self, observations=tuple((name, has[name]) for name in names), sensors=sensors)

    def with_input(self, name: str, expression: str) -> Simulation:
        """Simulation in which an input is replaced by an expression everywhere.

        Parameters
        ----------
        name : str
            Name of the input.
        expression : str
            Expression of states, inputs, parameters and `t`: `1.2*tau`, `delay(tau, 0.05)`.

        Raises
        ------
        SimulationError
            If there is no such input, or the expression uses unknown names.
        """
        _refuse_unknown([name], "an input", [signal.name for signal in self.inputs])
        by = {name: parse(expression)}

        def changed(text: str) -> str:
            tree = parse(text)
            other = substitute(tree, by, self.signals)
            return text if other == tree else written(other)

        lines = {part: tuple((key, changed(text)) for key, text in getattr(self, part)) for part in SECTIONS}
        effects = tuple(replace(effect, term=changed(effect.term)) for effect in self.effects)
        return replace(self, **lines, effects=effects)


def _refuse_unknown(names: Iterable[str], kind: str, known: Collection[str]) -> None:
    for name in names:
        if name not in known:
            listed = ", ".join(known) or "none"
            raise SimulationError(f"the name must be {kind}", f"there is no {name!r}", f"Known: {listed}.")
