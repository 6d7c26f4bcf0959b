"""The unit of a measured column is what its expression makes of the states' units, or the file is refused."""

import pytest

from gaitdisc.errors import SchemaError
from gaitdisc.simulation.parts import Sensor
from gaitdisc.simulation.refusal import SimulationError
from gaitdisc.simulation.simulation_file import simulation_of
from gaitdisc.simulation.unit_check import refuse_units


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
        ("theta", "m", r"its column, 'm'; 'theta' has another kind of unit. Correct the unit or expression."),
        ("tau*omega", "N m", r"'tau\*omega' has another kind of unit"),
    ],
)
def test_units_that_do_not_fit_are_refused_with_the_mend(ankle, expression, unit, words):
    with pytest.raises(SimulationError, match=words):
        refuse_units(ankle.with_observation("seen", expression).with_sensor(Sensor("seen", unit)))


def test_a_file_is_refused_at_the_line_of_the_observation(ankle_text):
    text = f'{ankle_text}[observations.ankle]\nexpression = "theta"\nunit = "deg"\n'
    line = text.split("\n").index("[observations.ankle]") + 1
    with pytest.raises(SchemaError, match=rf"ankle.toml, line {line}, \[observations\]"):
        simulation_of(text, "ankle.toml")
