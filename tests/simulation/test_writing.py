"""What is written is read back the same, and what a person wrote around it stays."""

from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st
from made_simulation import effect_text
from texts import says

from gaitdisc.errors import ReadError, SchemaError, SimulationError, WriteError
from gaitdisc.simulation.parts import Input, Parameter, Port, Sensor, State, Term
from gaitdisc.simulation.python_simulation import python_simulation
from gaitdisc.simulation.simulation import Simulation
from gaitdisc.simulation.simulation_file import parse_simulation, read_simulation
from gaitdisc.simulation.writing import read_into, simulation_text, write_simulation
from gaitdisc.units import find_dimension

SPRING = Term("ankle_moment", "port", "one_sided_spring", "-286.0*max(0, theta - 0.035)")


def test_an_effect_is_appended_and_nothing_else_changes(ankle, ankle_text):
    assert simulation_text(ankle.with_effect(SPRING)) == ankle_text + effect_text(SPRING)


def test_only_what_changed_changes(ankle, ankle_text):
    changed = ankle.with_values({"k": 31.5}).with_input("tau", "1.2*tau").with_observation("theta", "theta + 0.01")
    text = simulation_text(changed)
    assert parse_simulation(text) == changed
    before, after = ankle_text.split("\n"), text.split("\n")
    value, omega = [line for line in before if line not in after]
    assert value == "value = 25.0   # passive" and omega.startswith("omega = ")
    assert "value = 31.5   # passive" in after


def test_parameters_are_added_and_tables_replaced(ankle):
    changed = ankle.with_parameter(Parameter("x0", 0.03, "rad", 0.0, 0.1, "engagement"))
    changed = changed.with_parameter(Parameter("b", 1.3, "N m s/rad", 1.0, 2.0))
    text = simulation_text(changed)
    assert parse_simulation(text) == changed
    assert "# passive" in text and "# a joint" in text


@pytest.mark.parametrize("names", [["omega"], ["omega", "theta"], ["theta", "omega", "power"]])
def test_observations(ankle_text, names):
    given_ones = parse_simulation(
        ankle_text.replace(
            "[definitions]", '[observations]\ntheta = "theta"  # goniometer\nomega = "omega"\n\n[definitions]'
        )
    )
    changed = given_ones.with_observation("power", "tau*omega").observing(names)
    text = simulation_text(changed)
    assert parse_simulation(text) == changed
    assert ("# goniometer" in text) == (names[0] == "theta")


def test_a_state_that_an_effect_brings_along_is_written_beside_the_others(ankle, ankle_text):
    more = ankle.with_state(State("bent", "rad", initial=0.0), "omega - abs(omega)*bent/0.1")
    text = simulation_text(more)
    kept = [line for line in text.splitlines() if line in ankle_text.splitlines()]
    assert len(kept) >= len(ankle_text.splitlines())
    assert parse_simulation(text) == more
    assert more.observations == ankle.observations


def test_effects_that_were_there_are_taken_away(ankle, ankle_text):
    augmented = parse_simulation(simulation_text(ankle.with_effect(SPRING)))
    assert simulation_text(augmented) == augmented.layout
    assert simulation_text(augmented.without_effects()) == ankle_text
    other = augmented.without_effects().with_effect(Term("omega", "equation", "constant_load", "1.0"))
    assert parse_simulation(simulation_text(other)) == other


def test_windows_line_ends_stay(ankle_text):
    windows = parse_simulation(ankle_text.replace("\n", "\r\n"))
    text = simulation_text(windows.with_values({"k": 30.0}).with_effect(SPRING))
    assert text.count("\r\n") == text.count("\n")


def test_inline_tables_are_changed_where_they_stand():
    inline = parse_simulation(
        '[states]\nx = {unit = "m"}  # metres\n[parameters]\nk = {value = 2}\n[equations]\nx = "-k*x"\n'
    )
    changed = inline.with_values({"k": 3.0})
    assert simulation_text(changed) == inline.layout.replace("value = 2", "value = 3.0")
    assert parse_simulation(simulation_text(changed)) == changed


def test_a_layout_that_does_not_fit_is_written_anew():
    listed = parse_simulation('effects = [{equation = "x", term = "1"}]  # one\n[states.x]\n[equations]\nx = "-x"\n')
    changed = listed.with_effect(Term("x", "equation", "constant_load", "0.5"))
    assert parse_simulation(simulation_text(changed)) == changed


def test_a_sensor_is_written_into_the_line_of_its_observation(ankle_text):
    read = parse_simulation(ankle_text + '[observations]\ntheta = "theta"  # goniometer\nomega = "omega"\n')
    changed = read.with_sensor(Sensor("theta", sd=0.01))
    text = simulation_text(changed)
    assert text == read.layout.replace('theta = "theta"  #', 'theta = {expression = "theta", sd = 0.01}  #')
    assert parse_simulation(text) == changed


def test_a_number_as_an_expression_is_replaced():
    falling = parse_simulation("[states.v]\n[inputs.u]\n[equations]\nv = -9.81 # gravity\n")
    changed = parse_simulation(falling.layout.replace("-9.81", '"u"')).with_input("u", "2*u")
    assert '"2*u" # gravity' in simulation_text(changed)


def test_the_file_is_read_back(ankle, tmp_path):
    path = write_simulation(ankle.with_effect(SPRING), tmp_path / "new" / "augmented.toml")
    assert read_simulation(path) == ankle.with_effect(SPRING)
    with pytest.raises(WriteError, match="folder"):
        write_simulation(ankle, path / "below.toml")


def ball(*more: Port):
    return python_simulation(
        "ball", lambda *_: 0, [State("v", "m/s")], [Input("u")], [Parameter("g", 9.81)], [Port("drag"), *more]
    )


def test_a_python_object_is_given_all_that_was_written_of_it(tmp_path):
    changed = ball().with_effect(Term("drag", "port", "viscous_damping", "-0.4*v")).with_input("u", "delay(u, 0.1)")
    changed = changed.with_values({"g": 1.6}).with_starts({"v": 2.5}).with_observation("v", "1.1*(v)")
    path = write_simulation(changed, tmp_path / "ball.toml")
    read = read_into(ball(), path)
    assert (read.parts, read.replaced) == (changed.parts, changed.replaced)
    assert says(path.read_text(), "The right-hand side")


def test_what_is_written_of_a_python_object_cannot_be_run_without_it(tmp_path):
    path = write_simulation(ball(), tmp_path / "ball.toml")
    with pytest.raises(SchemaError, match="'v' must have one equation"):
        read_simulation(path)


def test_a_python_object_is_not_given_what_belongs_to_another(tmp_path):
    path = write_simulation(ball(), tmp_path / "ball.toml")
    with pytest.raises(SchemaError, match=r"'ball'.*lift; ball.toml"):
        read_into(ball(Port("lift")), path)
    with pytest.raises(ReadError, match=r"TOML.*absent.toml"):
        read_into(ball(), tmp_path / "absent.toml")


words = st.text(st.characters(codec="utf-8"), max_size=12)
numbers = st.floats(allow_nan=False, min_value=-1e299, max_value=1e299)
expressions = st.sampled_from(
    ["x", "-k*x + u", "max(0, x - k)**2", "delay(u, 0.1)*t", "force + 1e-3", "sin(v)/(1 + k)"]
)
units = words.filter(lambda text: find_dimension(text) is None)  # a known one would be compared with the sensor's


@st.composite
def simulations(draw):
    term = st.builds(
        Term, st.just("force"), st.just("port"), words, expressions.filter(lambda text: "force" not in text)
    )
    return Simulation(
        draw(words),
        (State("x", draw(units), draw(words), draw(st.none() | numbers)), State("v")),
        (Input("u", draw(units), draw(words)),),
        (Parameter("k", draw(numbers), draw(units), draw(st.none() | st.just(-1e300)), None, draw(words)),),
        (Port("force", draw(units), draw(words)),),
        tuple((f"d{i}", text) for i, text in enumerate(draw(st.lists(expressions, max_size=3)))),
        (("x", "v + force"), ("v", draw(expressions))),
        tuple({draw(words.filter(bool)): draw(expressions) for _ in range(draw(st.integers(0, 3)))}.items()),
        tuple(draw(st.lists(term, max_size=2))),
    )


sensors = st.builds(
    Sensor, st.just("x"), st.sampled_from(["", "mm"]), st.none() | st.just(0.3), st.none() | st.just(6.0)
)


@given(simulations(), sensors, numbers, expressions)
def test_what_is_written_is_read(simulation, sensor, value, expression):
    first = simulation.observations[0][0]
    simulation = simulation.with_sensor(replace(sensor, channel=first))
    text = simulation_text(simulation)
    read = parse_simulation(text)
    assert read == simulation
    changed = read.with_values({"k": value}).with_input("u", "2*delay(u, 0.1)").with_observation("seen", expression)
    changed = changed.with_effect(Term("v", "equation", "more", expression))
    assert parse_simulation(simulation_text(changed)) == changed


LONG = """
[observations.ankle_angle_r]   # cameras
expression = "57.2958*theta"   # seen
unit = "deg"
sd = 0.3
lowpass = 6.0
"""


def test_an_observation_in_the_long_form_is_written_back(ankle_text):
    read = parse_simulation(ankle_text + LONG)
    assert simulation_text(read) == read.layout
    changed = read.with_observation("ankle_angle_r", "1.1*57.2958*theta").with_observation("rate", "omega")
    text = simulation_text(changed)
    assert parse_simulation(text) == changed
    assert 'expression = "1.1*57.2958*theta"   # seen' in text and "# cameras" in text


def test_a_sensor_that_was_not_in_the_file_is_written_into_it(ankle):
    changed = ankle.with_sensor(Sensor("theta", "rad", 0.005)).with_sensor(Sensor("omega", lowpass=6.0))
    assert parse_simulation(simulation_text(changed)) == changed


def test_the_sensors_of_a_python_object_are_written_with_it(tmp_path):
    changed = ball().with_observation("fall", "-v").with_sensor(Sensor("fall", "m/s", 0.1, 8.0))
    path = write_simulation(changed, tmp_path / "ball.toml")
    assert read_into(ball(), path).parts == changed.parts


def test_a_function_is_no_simulation_yet(tmp_path):
    with pytest.raises(SimulationError, match=r"found function.*simulation_from_function"):
        write_simulation(lambda x: -x, tmp_path / "decay.toml")  # pyright: ignore[reportArgumentType]
