import pytest
from hypothesis import given
from hypothesis import strategies as st

from gaitdisc.simulation.parts import Sensor
from gaitdisc.simulation.simulation_file import bundled
from gaitdisc.simulation.unit_check import channel_unit, divide, find_unit, places_unit, unit_of_channel
from gaitdisc.units import unit_factor

UNITS = ("N m", "N", "rad", "rad/s", "m/s", "kg m^2", "1", "N m s/rad", "1/s")


@pytest.mark.parametrize(
    ("expression", "unit"),
    [
        ("x", "rad"),
        ("x**3", "rad^3"),
        ("v*abs(v)", "rad^2/s^2"),
        ("sign(v)", "1"),
        ("sin(x)", "1"),
        ("delay(v, 0.1)", "rad/s"),
        ("max(0, x - 0.03)", "rad"),
        ("v/x", "1/s"),
        ("-x", "rad"),
        ("sqrt(x)", "rad^0.5"),
        ("3", "1"),
    ],
)
def test_units_follow_the_expression(expression, unit):
    assert find_unit(expression, {"x": "rad", "v": "rad/s"}) == unit


def test_a_unit_that_nobody_knows_is_kept_as_a_word():
    assert divide("furlong", "s") == "furlong/s"


@given(st.sampled_from(UNITS), st.sampled_from(UNITS))
def test_dividing_agrees_with_the_units_of_the_simulation_file(unit, by):
    said = divide(divide(unit, by), divide("1", by))
    assert unit_factor(said, unit) == pytest.approx(1.0)


def test_what_is_added_to_an_equation_is_a_rate():
    pendulum = bundled("pendulum")
    assert places_unit(pendulum, "equation", "omega") == "rad/s^2"


@pytest.mark.parametrize(
    ("text", "unit"),
    [
        ("57.3*theta", "deg"),
        ("180*theta/3.14159", "deg"),
        ("-57.2958*omega", "deg/s"),
        ("2*theta", "1"),
        ("theta", "rad"),
    ],
)
def test_a_channel_in_other_units_is_never_told_in_those_of_its_state(text, unit):
    assert channel_unit(text, {"theta": "rad", "omega": "rad/s"}) == unit


def test_the_unit_of_a_channel_is_the_one_that_the_file_says():
    said = bundled("ankle").with_observation("ankle_angle_r", "1000*theta")
    assert unit_of_channel(said, "ankle_angle_r") == "1"
    assert unit_of_channel(said.with_sensor(Sensor("ankle_angle_r", "mrad")), "ankle_angle_r") == "mrad"
