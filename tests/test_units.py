"""Units of channels and composite units."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gaitdisc.errors import UnitError
from gaitdisc.units import convert, find_dimension, inner_unit, list_units, parse_unit, unit_factor


@pytest.mark.parametrize(
    ("value", "unit", "to", "expected"),
    [(180.0, "deg", "rad", np.pi), (1500.0, "N mm", "N m", 1.5), (2.0, "mV", "uV", 2000.0), (25.4, "mm", "m", 0.0254)],
)
def test_known_conversions(value, unit, to, expected):
    assert convert(np.array(value), unit, to) == pytest.approx(expected, rel=1e-15)


@given(st.sampled_from(list_units()), st.floats(-1e6, 1e6))
def test_there_and_back(unit, value):
    there = convert(np.array(value), unit, inner_unit(unit))
    assert convert(there, inner_unit(unit), unit) == pytest.approx(value, rel=1e-12, abs=1e-12)


@given(st.sampled_from(list_units()))
def test_the_inner_unit_is_its_own(unit):
    assert inner_unit(inner_unit(unit)) == inner_unit(unit)
    assert parse_unit(unit) == unit


@pytest.mark.parametrize(
    ("text", "unit"), [("Nmm", "N mm"), ("Degrees", "deg"), ("µV", "uV"), (" mm ", "mm"), ("", None), ("ell", None)]
)
def test_spellings(text, unit):
    assert parse_unit(text) == unit


def test_a_length_is_no_angle():
    with pytest.raises(UnitError, match=r"'mm'.*'m', 'deg'.*'deg'"):
        convert(np.zeros(1), "mm", "deg")


def test_unknown_unit_lists_the_known():
    with pytest.raises(UnitError, match=r"'ell'.*not.*deg, rad, m"):
        inner_unit("ell")


def test_every_unit_of_a_recording_is_in_the_one_table():
    for unit in list_units():
        factor = unit_factor(unit, inner_unit(unit))
        assert factor is not None and np.isfinite(factor), unit


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
        ("1/min", "Hz", 1 / 60),
        ("km/h", "m/s", 1 / 3.6),
        ("1/(min s)", "1/s^2", 1 / 60),
        ("h/(km min)", "1/m", 0.06),
        ("degC/min", "degC/s", 1 / 60),
        ("J/degC", "N m/degC", 1.0),
    ],
)
def test_factors(unit, to, factor):
    assert unit_factor(unit, to) == pytest.approx(factor, rel=1e-12)


def test_what_measures_something_else_has_no_factor():
    assert math.isnan(unit_factor("N", "N m"))
    assert math.isnan(unit_factor("deg", "1"))
    assert math.isnan(unit_factor("degC", "m"))


@pytest.mark.parametrize("other", ["K", "degF"])
def test_a_temperature_of_another_zero_has_no_factor(other):
    assert math.isnan(unit_factor("degC", other)) and math.isnan(unit_factor(other, "degC"))
    assert unit_factor("degC", "degC") == 1.0
    assert parse_unit(other) is None


@pytest.mark.parametrize("unit", ["furlong", "N m rad-", "", "m^^2", "x" * 10_000])
def test_unknown_units_are_not_guessed(unit):
    assert unit_factor(unit, "m") is None


def test_an_angle_has_no_dimension():
    assert find_dimension("rad/s") == find_dimension("1/s")
    assert find_dimension("furlong") is None
