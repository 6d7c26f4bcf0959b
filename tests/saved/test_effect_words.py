import pytest
from texts import says

from gaitdisc.discovery.effect_words import (
    amount,
    at_place,
    brief_text,
    display_unit,
    estimate_text,
    spoken,
    with_unit,
    would_distinguish,
)
from gaitdisc.discovery.result import Estimate

NAN = float("nan")


@pytest.mark.parametrize(
    ("value", "step", "text"),
    [
        (286.04, 7.0, "286"),
        (4.0, 0.00002, "4"),
        (4.00021, 0.00002, "4.00021"),
        (-5.74e-6, 2e-7, "−5.7e−06"),
        (0.0, NAN, "0"),
        (NAN, 1.0, "not computed"),
        (123456.0, 20000.0, "123456"),
    ],
)
def test_digits_are_those_that_the_step_leaves(value, step, text):
    assert amount(value, step) == text


def test_only_angles_and_their_rates_are_turned_to_degrees():
    assert display_unit("rad/s^2")[0] == "deg/s^2"
    assert display_unit("N m s/rad") == ("N m s/rad", 1.0)
    assert display_unit("radish") == ("radish", 1.0)


def test_an_interval_that_is_not_known_is_not_said_and_a_negative_one_with_a_word():
    assert estimate_text(Estimate(3.0, NAN, NAN, "N")) == "3.00 N"
    assert says(estimate_text(Estimate(-2.0, -2.5, -1.5, "N")), "−2.0 N", "−2.5 to −1.5")


def test_a_pure_number_has_no_unit():
    assert with_unit(brief_text(Estimate(1.2, 1.1, 1.3, "1")), "") == "1.2"


def test_places_and_names_as_they_are_said():
    assert at_place("observation", "x") == "in the observation x"
    assert spoken("viscous_damping") == "viscous damping"


@pytest.mark.parametrize(
    ("name", "other", "recording"),
    [
        ("one_sided_spring", "cubic_stiffness", "wider range"),
        ("coulomb_friction", "viscous_damping", "different speeds"),
        ("input_delay", "sensor_lag", "sharp push"),
        ("periodic_forcing", "one_sided_spring", "another cadence"),
        ("wrong_parameter", "input_gain", "drive switched off"),
        ("wrong_parameter", "viscous_damping", "separate measurement of the parameter"),
        ("my_own", "cubic_stiffness", "longer trials"),
        ("one_sided_spring", "one_sided_spring", "two places"),
    ],
)
def test_a_recording_is_named_whichever_comes_first(name, other, recording):
    assert recording in would_distinguish(name, other)
    assert would_distinguish(name, other) == would_distinguish(other, name)
