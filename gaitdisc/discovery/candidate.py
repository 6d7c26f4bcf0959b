"""A candidate: one explanation of a gap, at one place, with numbers still to be found."""

import math
import re
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, field
from itertools import product
from typing import NamedTuple

from gaitdisc.discovery.catalogue import Shape, name_factors, with_names
from gaitdisc.discovery.criteria import CRITERIA
from gaitdisc.discovery.fitted import find_bounds
from gaitdisc.discovery.places import Place, kinematic_rates
from gaitdisc.simulation.expression import Tree, parse, substitute, written
from gaitdisc.simulation.parts import Parameter, State, Term
from gaitdisc.simulation.simulation import Simulation
from gaitdisc.simulation.unit_check import unit_of_state


class SignalFault(NamedTuple):
    """An error of an input or a sensor, {s} being the signal."""

    slot: str  # its number
    none: float  # value of that when nothing is wrong
    form: str  # how the signal reads
    above: str  # how a number above `none` is said, {} being its size
    below: str = ""  # and one below, where it is said otherwise


SIGNAL_ERRORS = {
    "input_gain": SignalFault("gain", 1.0, "{gain}*{s}", "acts {} times as strongly as recorded"),
    "input_delay": SignalFault(
        "seconds", 0.0, "delay({s}, {seconds})", "acts {} later than recorded", "acts {} earlier than recorded"
    ),
    "input_lag": SignalFault("seconds", 0.0, "", "acts through a first-order lag of {}"),
    "sensor_gain": SignalFault("gain", 1.0, "{gain}*({s})", "reads {} times the true value"),
    "sensor_offset": SignalFault("offset", 0.0, "({s}) + {offset}", "reads {} too high", "reads {} too low"),
    "sensor_drift": SignalFault("rate", 0.0, "({s}) + {rate}*t", "drifts upwards by {}", "drifts downwards by {}"),
    "sensor_lag": SignalFault("seconds", 0.0, "{s}", "lags by {}"),
}

# Explanations that can imitate some others, and many others, and so have to close more of a gap than a plain one
BENT = (
    *SIGNAL_ERRORS,
    "quadratic_stiffness",
    "linear_coupling",
    "one_sided_spring",
    "dead_zone_spring",
    "one_sided_damper",
)
FLEXIBLE = (
    "contact_damper",
    "hysteresis",
    "series_elasticity",
    "phase_locked_moment",
    "unnamed",
    "input_saturation",
    "force_saturation",
    "input_product",
    "periodic_forcing",
    "delayed_feedback",
    "product_coupling",
)
# What only takes energy from a motion: with the sign that drives, it is another thing
PASSIVE = ("coulomb_friction", "quadratic_drag", "contact_damper", "hysteresis", "series_elasticity")

UNNAMED = "unnamed"

Identity = tuple[str, tuple[str, ...]]


@dataclass(frozen=True)
class Candidate:
    """One explanation of a gap, at one place."""

    verdict: str
    kind: str  # what `place` is: `port`, `equation`, `parameter`, `input`, `observation`
    place: str
    name: str  # name of the effect, of discovery.md's tables
    # for a missing term, its pieces over the simulation's names; its constants as words that begin with `_`
    pieces: tuple[str, ...] = ()
    # for a missing term, its constants and the grid on which each is searched
    constants: Mapping[str, str] | None = None
    role: str = ""  # for a missing term, what stands for x in it (for the grids)
    means: str = ""
    value: float = 0.0  # for a wrong parameter, the number in the file
    names: Mapping[str, str] | None = None  # for a missing term, what a person calls its numbers
    bounds: tuple[float, ...] = ()  # for a wrong parameter, `low` and `high` of the file; empty where it has not both
    # states that it brings along, and the time derivative of each; its constants in them as in `pieces`
    states: Mapping[str, str] = field(default_factory=dict)
    power: float = 1.0  # sign of what a positive factor gives the motion; 0 where this is another body's

    @property
    def slots(self) -> tuple[str, ...]:
        """The numbers to be found, by name: factors first."""
        return (*self.idle, *(self.constants or {})) if self.verdict == "missing_physics" else tuple(self.idle)

    @property
    def idle(self) -> dict[str, float]:
        """Values at which the candidate changes nothing (constants of a shape are not among them)."""
        if self.verdict == "missing_physics":
            return dict.fromkeys(name_factors(self.pieces), 0.0)
        if self.verdict == "wrong_parameter":
            return {"value": self.value}
        if self.constants:
            return dict.fromkeys(self.constants, math.inf)
        error = SIGNAL_ERRORS[self.name]
        return {error.slot: error.none}

    @property
    def label(self) -> str:
        """Name and place, as one word."""
        return f"{self.name}@{self.place}"

    @property
    def identity(self) -> Identity:
        """What distinguishes it from others, whatever its numbers: name, place and shape."""
        return self.label, self.pieces

    def written(self, simulation: Simulation, numbers: Mapping[str, str]) -> Simulation:
        """Return the simulation with this explanation in it, numbers or names of parameters in its slots."""
        if self.verdict == "missing_physics":
            for name, rate in self.states_at(numbers).items():
                simulation = simulation.with_state(State(name, unit_of_state(simulation, rate), initial=0.0), rate)
            return simulation.with_effect(Term(self.place, self.kind, self.name, self.term(numbers)))
        if self.verdict == "wrong_parameter":
            return simulation.with_values({self.place: float(numbers["value"])})
        form = self.form
        for name, rate in self.states_at(numbers).items():
            unit = next(signal.unit for signal in simulation.inputs if signal.name == self.place)
            late = simulation.with_state(State(name, unit, initial=0.0), "0").with_input(self.place, name)
            return late.with_equation(name, rate)
        if self.verdict == "input_error":
            return simulation.with_input(self.place, form.format(s=self.place, **numbers))
        seen = dict(simulation.observations)[self.place]
        if self.name == "sensor_lag":
            whole = {"seen": _write_out(simulation, seen, {})}
            late = parse(f"delay(seen, {numbers['seconds']})")
            seen = written(substitute(late, whole, simulation.signals))
        return simulation.with_observation(self.place, form.format(s=seen, **numbers))

    @property
    def form(self) -> str:
        """How an error of a signal reads, {s} being the signal."""
        return self.pieces[0] if self.pieces else SIGNAL_ERRORS[self.name].form

    @property
    def is_late(self) -> bool:
        """Whether the number to be found is a delay of a signal."""
        return self.name in ("input_delay", "input_lag", "sensor_lag")

    def beyond_bounds(self, value: float) -> float:
        """Return how far a number lies outside its bounds; negative inside, infinite where it has none."""
        if not self.bounds:
            return math.inf
        low, high = self.bounds
        return max(low - value, value - high)

    def penalty(self, values: Mapping[str, float]) -> float:
        """Return the share of the gap that it must close to be worth its statement.

        The more kinds of motion an explanation can imitate, the more of a gap it has to close.
        """
        drives = self.name in ("viscous_damping", *PASSIVE) and self.power * values.get("factor", 0.0) > 0
        flexible, bent = self.name in FLEXIBLE, self.name in BENT
        price = CRITERIA.bent if bent else CRITERIA.plain
        return price + CRITERIA.bent * flexible + CRITERIA.matters * drives

    def pieces_at(self, constants: Mapping[str, str]) -> tuple[str, ...]:
        """Return the pieces of a missing term with its constants written in."""
        marked = {f"_{slot}": text for slot, text in constants.items()}
        return Shape(self.name, self.pieces).written(marked)

    def states_at(self, numbers: Mapping[str, str]) -> dict[str, str]:
        """Return the states that it brings along, and the time derivative of each."""
        marked = {f"_{slot}": text for slot, text in numbers.items()}
        return {name: with_names(rate, marked) for name, rate in self.states.items()}

    def term(self, numbers: Mapping[str, str]) -> str:
        """Return the missing term as an expression."""
        pieces = self.pieces_at({slot: numbers[slot] for slot in self.constants or {}})
        return " + ".join(
            numbers[slot] if piece == "1" else f"{numbers[slot]}*({piece})"
            for slot, piece in zip(self.slots, pieces, strict=False)
        )

    def in_fit(self, simulation: Simulation, names: Mapping[str, str], values: Mapping[str, float]) -> Simulation:
        """Return the simulation with this explanation in it and its numbers free; names: parameters, as of `named`."""
        if self.verdict == "wrong_parameter":
            return simulation
        for slot, name in names.items():
            simulation = simulation.with_parameter(Parameter(name, float(values[slot])))
        return self.written(simulation, names)

    def named(self, tag: str) -> dict[str, str]:
        """Return the parameter that stands for each slot: an added one, by its tag, or the wrong one itself."""
        return {slot: self.place if self.verdict == "wrong_parameter" else f"{tag}_{slot}" for slot in self.slots}


def _write_out(simulation: Simulation, expression: str, known: Mapping[str, Tree]) -> Tree:
    """An expression with the definitions that stand in it written out, and with what is known of other names."""
    by = {**known}
    for name, text in simulation.definitions:
        by[name] = substitute(parse(text), by, simulation.signals)
    return substitute(parse(expression), by, simulation.signals)


def list_candidates(
    simulation: Simulation, places: tuple[Place, ...], shapes: tuple[Shape, ...]
) -> tuple[Candidate, ...]:
    """List everything that could explain a gap, missing physics beside wrong numbers, inputs and sensors."""
    numbers = [
        Candidate("wrong_parameter", "parameter", one.name, "wrong_parameter", value=one.value, bounds=find_bounds(one))
        for one in simulation.parameters
    ]
    sensors = [
        Candidate("sensor_error", "observation", name, error)
        for name, _ in simulation.observations
        for error in ("sensor_gain", "sensor_offset", "sensor_lag", "sensor_drift")
    ]
    inputs = _list_input_errors(simulation)
    taken = {*simulation.signals, *(name for each in inputs for name in each.states)}
    return (*numbers, *inputs, *sensors, *_list_missing_terms(simulation, places, shapes, taken))


def _list_input_errors(simulation: Simulation) -> list[Candidate]:
    """List what may be wrong with each input that stands in the simulation: it is late, scaled, or lags."""
    used = "\n".join(text for _, text in (*simulation.definitions, *simulation.equations))
    driving = [signal for signal in simulation.driving if re.search(rf"\b{re.escape(signal.name)}\b", used)]
    errors = []
    for name in (signal.name for signal in driving):
        scaled = () if f"gain_of_{name}" in simulation.values() else ("input_gain",)  # a number of the file
        errors += [Candidate("input_error", "input", name, error) for error in ("input_delay", *scaled)]
    for each in driving if isinstance(simulation, Simulation) else ():
        if not each.wraps:  # it may act through a first-order lag
            state = free_name(f"{each.name}_lagged", {*simulation.signals})
            states, names = {state: f"({each.name} - {state})/_seconds"}, {"seconds": "time_constant"}
            errors.append(Candidate("input_error", "input", each.name, "input_lag", names=names, states=states))
    return errors


def _list_missing_terms(
    simulation: Simulation, places: tuple[Place, ...], shapes: tuple[Shape, ...], taken: set[str]
) -> Iterator[Candidate]:
    """Yield every shape at every place where it has a meaning; its states get names that are not taken."""
    driving = tuple(signal.name for signal in simulation.driving if not signal.wraps)
    has_phase = any(signal.name == "phase" for signal in simulation.inputs)
    for place, shape in product(places, shapes):
        if (shape.needs == "angle" and not place.angle) or (shape.uses_phase and not has_phase):
            continue
        if shape.states and not isinstance(simulation, Simulation):
            continue  # the states of a Python object are its own
        for role, names in _castings(shape, place, driving):
            written = names | {constant: f"_{constant}" for constant in shape.constants}
            written |= {state: free_name(f"{shape.name}_{place.name}", taken) for state in shape.states}
            taken |= {written[state] for state in shape.states}
            yield Candidate(
                "missing_physics",
                place.kind,
                place.name,
                shape.name,
                shape.written(written),
                shape.constants,
                role=role,
                means=shape.means,
                names=shape.names,
                states={written[state]: with_names(rate, written) for state, rate in shape.states.items()},
                power=place.power * (role.partition(" - ")[0] == place.motions[0][0]),
            )


def saturations(simulation: Simulation, servos: Mapping[str, tuple[float, float, str]]) -> tuple[Candidate, ...]:
    """List inputs that act up to a limit alone: one above, one below, one of a size to either side, or two.

    servos: inputs whose force may be limited so: their gain, their force at 0 and that by motion
    """
    two_sizes = {"lower_limit": "low quantiles of x", "upper_limit": "high quantiles of x"}
    forms = {
        "min({s}, {upper_limit})": {"upper_limit": "quantiles of x"},
        "max({s}, {lower_limit})": {"lower_limit": "quantiles of x"},
        "min(max({s}, -{limit}), {limit})": {"limit": "half widths of x"},
        "min(max({s}, {lower_limit}), {upper_limit})": two_sizes,
    }
    limited = [
        Candidate("input_error", "input", signal.name, "input_saturation", (form,), limits, role=signal.name)
        for signal in simulation.inputs
        for form, limits in forms.items()
    ]
    for name, (gain, constant, moved) in servos.items():
        rest, limits = f"{constant!r} + {moved}", {"limit": "half widths of x"}
        form = f"(min(max({gain!r}*{{s}} + {rest}, -{{limit}}), {{limit}}) - ({rest}))/{gain!r}"
        force = f"{gain!r}*{name} + {rest}"
        limited.append(Candidate("input_error", "input", name, "force_saturation", (form,), limits, role=force))
    return tuple(limited)


def free_name(name: str, taken: Collection[str]) -> str:
    """Return a name, with a number behind it where it is taken.

    >>> free_name("hysteresis_knee", ["hysteresis_knee"])
    'hysteresis_knee_2'
    """
    numbered = (name, *(f"{name}_{number}" for number in range(2, len(taken) + 3)))
    return next(each for each in numbered if each not in taken)


def _castings(shape: Shape, place: Place, driving: tuple[str, ...]) -> list[tuple[str, dict[str, str]]]:
    """What may stand for the roles of a shape at a place, given the inputs: (what the grids go along, names)."""
    roles = set(shape.roles)
    if "u" in roles:
        (x, v), *_ = place.motions
        moving = ({"x": x} if x != v else {}) | ({"v": v} if v else {})
        return [(signal, moving | {"u": signal}) for signal in driving if roles <= {"u", *moving}]
    if roles <= {"x", "v"}:
        late, plain = any("delay(" in piece for piece in shape.pieces), shape.pieces in (("x",), ("v",))
        castings = [
            (x, {"x": x} | ({"v": v} if v else {}))
            for x, v in place.motions
            if (v or "v" not in roles)
            and not (late and " " in x)
            and not (x == v and "x" in roles)  # of a speed, what acts on a position is not known
            and not (plain and x in place.others)  # that is a coupling
        ]
        return castings[:1] if not roles or shape.needs == "angle" else castings
    if roles == {"y"}:
        return [(other, {"y": other}) for other in place.others]
    if roles == {"a", "b"}:
        return [(a, {"a": a, "b": b}) for a, b in place.products]
    return []


def no_shape(place: Place, pieces: tuple[str, ...], role: str) -> Candidate:
    """Return a term that no shape is; role: what stands for x in it."""
    return Candidate("missing_physics", place.kind, place.name, UNNAMED, pieces, role=role)


def list_unnamed_terms(simulation: Simulation, places: tuple[Place, ...]) -> tuple[Candidate, ...]:
    """List plain terms that no shape is: an input, a state times an input, the acceleration of another body."""
    rate_of = kinematic_rates(simulation)
    inputs = [signal.name for signal in simulation.driving if signal.name != "phase"]
    equations, nothing = dict(simulation.equations), {port.name: parse("0") for port in simulation.ports}
    shapes = []
    for place in places:
        state, rate = place.motions[0]
        terms = [term for name in inputs for term in (name, f"{state}*{name}")]
        if rate and isinstance(simulation, Simulation):
            speeds = [speed for other, speed in rate_of.items() if other != state]
            terms += [written(_write_out(simulation, equations[speed], nothing)) for speed in speeds]
        shapes += [no_shape(place, (term,), state) for term in terms]
    return tuple(shapes)
