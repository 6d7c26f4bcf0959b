"""Units that do not fit are told; of a measured column they are refused."""

from dataclasses import replace

import pytest
from texts import says

from gaitdisc.errors import SchemaError, SimulationError
from gaitdisc.simulation.parts import Parameter, Sensor, State, Term
from gaitdisc.simulation.simulation import Simulation
from gaitdisc.simulation.simulation_file import bundled, list_bundled, parse_simulation
from gaitdisc.simulation.unit_check import refuse_units, unit_findings

TEXT = """title = "mass"
[states.x]
unit = "m"
[states.v]
unit = "m/s"
[inputs.u]
unit = "N"
[parameters.m]
value = 2.0
unit = "kg"
[parameters.k]
value = 30.0
unit = "{k}"
[ports.force]
unit = "{port}"
[equations]
x = "v"
v = "(u + force - k*x)/m{more}"
"""


def _told(k="N/m", port="N", more="", effect=None):
    simulation = parse_simulation(TEXT.format(k=k, port=port, more=more))
    simulation = simulation.with_parameter(Parameter("c", 1.0, "N s/m"))
    return [each.what for each in unit_findings(simulation.with_effect(effect) if effect else simulation)]


def test_units_that_fit_are_not_told():
    assert _told() == []
    assert _told(k="kg/s^2") == []
    assert _told(k="1") == []  # a parameter to which nobody gave a unit
    for term in ("-c*v", "-286.0*max(0, x - 0.035)"):
        assert _told(effect=Term("force", "port", "a", term)) == []


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"port": "N m"}, "[equations] v: 'u' and 'force' are added but differ in unit"),
        ({"k": "N"}, "'u + force' and 'k*x' are added but differ in unit"),
        ({"k": "furlong"}, "'furlong' is not a known unit"),
        ({"k": "K"}, "'K' is not a known unit; temperatures must be in degC: units are converted by a factor only"),
        ({"more": " + x*t"}, "are added but differ in unit"),
        ({"more": "*m/m*t"}, "must have the unit m/s/s"),
        ({"more": " + sin(x)"}, "'sin(x)' must be a pure number or an angle"),
        ({"effect": Term("force", "port", "a", "-c*x")}, "[effects] 1: '-c*x' must have the unit N"),
        ({"effect": Term("v", "equation", "a", "-c*v/m*x/x*t")}, "[effects] 1"),
        ({"effect": Term("force", "port", "a", "max(c*v, m)")}, "'c*v' and 'm' are compared"),
    ],
)
def test_units_that_do_not_fit_are_told(changed, words):
    assert any(words in what for what in _told(**changed))


@pytest.mark.parametrize("name", list_bundled())
def test_what_comes_along_fits(name):
    assert unit_findings(bundled(name)) == ()


def test_where_nobody_gave_a_unit_there_is_nothing_to_say():
    oscillator = Simulation("oscillator", (State("x"), State("v")), equations=(("x", "v"), ("v", "-x")))
    assert unit_findings(oscillator) == ()
    metres = replace(oscillator, states=(State("x", "m"), State("v")))
    x, v = (each.what for each in unit_findings(metres))
    assert says(x, "[equations] x: 'v'", "m/s") and says(v, "[equations] v: '-x'", "1/s")


def test_a_choice_has_the_unit_of_what_is_chosen():
    held = Simulation("held", (State("x", "m"),), equations=(("x", "where(x, x)"),))
    (said,) = (each.what for each in unit_findings(held))
    assert says(said, "[equations] x: 'where(x, x)'", "m/s")


@pytest.mark.parametrize(
    ("expression", "unit"),
    [
        ("57.2958*theta", "deg"),
        ("-57.3*theta", "deg"),
        ("theta*57.29577951", "deg"),
        ("theta", "rad"),
        ("1.02*theta", "rad"),
        ("57.2958*omega", "deg/s"),
        ("tau", "N m"),
        ("1000*tau", "N mm"),
        ("tau*omega", "W"),
        ("3*theta", "ticks"),
        ("sin(theta)", "1"),
        ("57.2958*(theta + 0.1)", "deg"),
    ],
)
def test_units_that_fit(ankle, expression, unit):
    refuse_units(ankle.with_observation("seen", expression).with_sensor(Sensor("seen", unit)))


@pytest.mark.parametrize(
    ("expression", "unit", "words"),
    [
        ("theta", "deg", r"its column, 'deg'; 'theta' is in rad. Write 57.2958\*theta."),
        ("-theta", "deg", r"'theta' is in rad. Write -57.2958\*theta."),
        ("57.2958*theta", "rad", r"its column, 'rad'; 'theta' is in rad. Write 1\*theta."),
        ("theta", "m", r"its column, 'm'; 'theta' has a unit of another dimension. Correct the unit or the."),
        ("tau*omega", "N m", r"'tau\*omega' has a unit of another dimension"),
    ],
)
def test_units_that_do_not_fit_are_refused_with_the_mend(ankle, expression, unit, words):
    with pytest.raises(SimulationError, match=words):
        refuse_units(ankle.with_observation("seen", expression).with_sensor(Sensor("seen", unit)))


def test_a_file_is_refused_at_the_line_of_the_observation(ankle_text):
    text = f'{ankle_text}[observations.ankle]\nexpression = "theta"\nunit = "deg"\n'
    line = text.split("\n").index("[observations.ankle]") + 1
    with pytest.raises(SchemaError, match=rf"ankle.toml, line {line}, \[observations\]"):
        parse_simulation(text, "ankle.toml")
