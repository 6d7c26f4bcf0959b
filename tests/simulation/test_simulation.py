"""A simulation gives new ones; it never changes."""

from dataclasses import FrozenInstanceError

import pytest
from texts import says

from gaitdisc.errors import SimulationError
from gaitdisc.simulation.parts import Input, Parameter, Sensor, State, Term
from gaitdisc.simulation.simulation import Simulation


def test_it_is_hashable_and_equal_by_its_parts(ankle):
    other = Simulation(**{name: getattr(ankle, name) for name in ankle.__dataclass_fields__})
    assert other == ankle
    assert hash(other) == hash(ankle)


def test_observations_are_the_states_by_default(ankle):
    assert ankle.observations == (("theta", "theta"), ("omega", "omega"))


def test_an_effect_is_added_and_taken_away(ankle):
    spring = Term("ankle_moment", "port", "one_sided_spring", "-286*max(0, theta - 0.035)")
    augmented = ankle.with_effect(spring)
    assert augmented.effects == (spring,)
    assert ankle.effects == ()
    assert augmented.without_effects() == ankle


def test_values_and_parameters(ankle):
    assert ankle.with_values({"k": 30}).values()["k"] == 30.0
    more = ankle.with_parameter(Parameter("x0", 0.03, "rad")).with_parameter(Parameter("k", 28.0))
    assert more.values() == {"inertia": 0.12, "b": 1.1, "k": 28.0, "x0": 0.03}
    with pytest.raises(SimulationError, match=r"'kk'.*inertia"):
        ankle.with_values({"kk": 1.0})


def test_an_observation_is_changed_or_added(ankle):
    seen = ankle.with_observation("theta", "1.1*theta").with_observation("power", "tau*omega")
    assert seen.observations == (("theta", "1.1*theta"), ("omega", "omega"), ("power", "tau*omega"))


def test_an_input_is_replaced_wherever_it_stands(ankle):
    late = ankle.with_effect(Term("omega", "equation", "feedback", "delay(tau, 0.1)")).with_input(
        "tau", "1.2*delay(tau, 0.05)"
    )
    assert dict(late.equations)["omega"] == dict(ankle.equations)["omega"].replace("tau", "1.2*delay(tau, 0.05)")
    assert late.effects[0].term == "1.2*delay(tau, 0.05 + 0.1)"
    assert late.definitions == ankle.definitions
    with pytest.raises(SimulationError, match="Known: tau, phase"):
        ankle.with_input("force", "2*force")


def test_equations_come_as_a_mapping_too():
    decay = Simulation("decay", (State("x"),), equations={"x": "-x"})  # type: ignore[arg-type]
    assert decay.equations == (("x", "-x"),)


def test_a_start_belongs_to_a_state(ankle):
    moved = ankle.with_starts({"omega": 0.5})
    assert [state.initial for state in moved.states] == [ankle.states[0].initial, 0.5]
    with pytest.raises(SimulationError, match=r"must be a state.*'k'"):
        ankle.with_starts({"k": 1.0})
    with pytest.raises(SimulationError, match=r"finite number; initial.*nan"):
        ankle.with_starts({"omega": float("nan")})


def test_sensors_stand_in_the_order_of_the_observations_and_go_with_them(ankle):
    told = ankle.with_sensor(Sensor("omega", lowpass=6.0)).with_sensor(Sensor("theta", sd=0.01))
    assert [one.channel for one in told.sensors] == ["theta", "omega"]
    assert told.observing(["omega"]).sensors == (Sensor("omega", lowpass=6.0),)
    assert told.with_sensor(Sensor("theta")).sensors == (Sensor("omega", lowpass=6.0),)
    assert told.with_observation("theta", "1.1*theta").sensor("theta").sd == 0.01


def test_only_phase_wraps():
    assert Input("phase", "1").wraps
    assert not Input("phase", "rad").wraps
    assert not Input("tau", "1").wraps


def test_parts_are_frozen():
    with pytest.raises(FrozenInstanceError):
        Parameter("k", 1.0).value = 2.0  # type: ignore[misc]


def test_a_sensor_of_which_nothing_is_said_is_not_known():
    assert not Sensor("x").known
    assert all(one.known for one in (Sensor("x", "deg"), Sensor("x", sd=0.3), Sensor("x", lowpass=6.0)))


def test_it_says_where_before_what():
    error = SimulationError("every name is known", "'omgea' is not", "Write 'omega'.").at("equations", "omega")
    assert says(str(error), "[equations] omega", "'omgea'", "'omega'")


def test_without_a_place_it_is_the_sentence_alone():
    assert str(SimulationError("a", "b", "C.")) == "a; b. C."
