"""Composite units."""

import math

import pytest

from gaitdisc.units import dimension_of, unit_factor


@pytest.mark.parametrize(
    ("unit", "to", "factor"),
    [
        ("deg", "rad", math.pi / 180),
        ("rad", "deg", 180 / math.pi),
        ("deg/s2", "rad/s^2", math.pi / 180),
        ("N mm", "N m", 1e-3),
        ("N m s/rad", "kg m^2/s/rad", 1.0),
        ("kg m^2", "N m s^2", 1.0),
        ("1/s^2", "Hz^2", 1.0),
        ("%", "1", 0.01),
        ("N/kg", "m/s^2", 1.0),
        ("kN", "N", 1000.0),
        ("mV", "V", 1e-3),
    ],
)
def test_factors(unit, to, factor):
    assert unit_factor(unit, to) == pytest.approx(factor, rel=1e-12)


def test_what_measures_something_else_has_no_factor():
    assert math.isnan(unit_factor("N", "N m"))
    assert math.isnan(unit_factor("deg", "1"))


@pytest.mark.parametrize("unit", ["furlong", "N m rad-", "", "m^^2", "x" * 10_000])
def test_unknown_units_are_not_guessed(unit):
    assert unit_factor(unit, "m") is None


def test_an_angle_has_no_dimension():
    assert dimension_of("rad/s") == dimension_of("1/s")
    assert dimension_of("furlong") is None
