from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from hidden_in_a_mass import mass, record

from gaitdisc.discovery.candidate import Candidate, list_candidates
from gaitdisc.discovery.catalogue import Shape, read_shapes
from gaitdisc.discovery.discover import discover
from gaitdisc.discovery.estimates import NORMAL_95, name_estimates, slot_units, wrong_starts
from gaitdisc.discovery.places import list_places
from gaitdisc.discovery.scored_model import Part


@pytest.fixture(scope="module")
def candidates():
    base = mass()
    own = Shape("stick", ("x/(1 + x**2)",), names={"factor": "stiffness"})
    return list_candidates(base, list_places(base), (*read_shapes(), own))


def named(candidates, label, values, piece=""):
    found = next(one for one in candidates if one.label == label and piece in str(one.pieces))
    slots = dict(zip(found.slots, values, strict=True))
    return name_estimates(Part(found, slots), np.diag([0.01] * len(values)), mass())


def test_a_stiffness_is_positive_where_it_resists_above_and_below(candidates):
    above = named(candidates, "one_sided_spring@load", [-286.0, 0.1], "x - _x0")
    below = named(candidates, "one_sided_spring@load", [286.0, -0.1], "_x0 - x")
    assert above["stiffness"].value == below["stiffness"].value == 286.0
    assert (above["stiffness"].unit, above["engagement"].unit) == ("N/m", "m")
    assert above["engagement"].value == 0.1


def test_intervals_are_two_standard_errors_and_follow_the_sign(candidates):
    friction = named(candidates, "coulomb_friction@load", [-3.0])["friction"]
    assert (friction.low, friction.high) == pytest.approx((3 - NORMAL_95 / 10, 3 + NORMAL_95 / 10))
    assert friction.unit == "N"


@pytest.mark.parametrize(
    ("label", "values", "name", "unit", "value"),
    [
        ("viscous_damping@load", [-2.0], "damping", "N s/m", 2.0),
        ("quadratic_drag@load", [-2.0], "drag", "N s^2/m^2", 2.0),
        ("cubic_stiffness@load", [-2.0], "stiffness", "N/m^3", 2.0),
        ("constant_load@load", [-2.0], "load", "N", -2.0),
        ("wrong_parameter@c", [0.9], "value", "N s/m", 0.9),
        ("input_delay@push", [0.03], "delay", "s", 0.03),
        ("input_gain@push", [1.2], "gain", "1", 1.2),
        ("sensor_offset@x", [0.1], "offset", "m", 0.1),
        ("sensor_drift@x", [0.1], "drift", "m/s", 0.1),
        ("stick@load", [-2.0], "stiffness", "N m", 2.0),
    ],
)
def test_each_number_has_its_name_unit_and_sign(candidates, label, values, name, unit, value):
    (said,) = named(candidates, label, values).items()
    assert said[0] == name
    assert (said[1].unit, said[1].value) == (unit, value)


def test_a_sine_and_a_cosine_are_an_amplitude_and_a_phase(candidates):
    wave = named(candidates, "periodic_forcing@load", [3.0, 4.0, 2.5])
    assert list(wave) == ["amplitude", "phase", "frequency"]
    assert wave["amplitude"].value == 5.0
    assert wave["amplitude"].high - 5.0 == pytest.approx(NORMAL_95 * 0.1)
    assert wave["phase"].value == pytest.approx(np.arctan2(4, 3))
    assert wave["frequency"].unit == "rad/s"


def test_numbers_of_one_name_stay_apart():
    bumps = Candidate("missing_physics", "port", "load", "unnamed", ("exp(-x**2)", "exp(-(x - 1)**2)"))
    said = name_estimates(Part(bumps, {"factor": 1.0, "factor_1": 2.0}), np.eye(2), mass())
    assert [one.value for one in said.values()] == [1.0, 2.0]
    assert slot_units(bumps, mass()) == {"factor": "N", "factor_1": "N"}


def begun(x: float, v: float):
    states = tuple(replace(state, initial=at) for state, at in zip(mass().states, (x, v), strict=True))
    return replace(mass(), states=states)


def test_a_start_elsewhere_than_the_file_says_is_the_only_thing_named():
    found, augmented = discover(begun(3.0, 0.0), record(mass(), 7))
    assert found.verdict == "wrong_initial_condition"
    assert next((one.kind, one.name) for one in found.effects) == ("state", "wrong_initial_condition")
    assert "Only the initial condition is wrong" in found.sentence
    start = next(one.estimates["initial"] for one in found.effects if one.place == "x")
    assert start.low < start.value < start.high < 2.0
    assert augmented.states[0].initial == float(f"{start.value:.6g}")


def test_states_without_a_start_in_the_file_are_left_alone():
    found, augmented = discover(mass(), record(mass(), 7))
    assert found.verdict == "no_gap"
    assert augmented == mass()


def test_trials_that_begin_at_unlike_places_show_no_start_that_all_have():
    slopes = np.full((3, 8, 2), 10.0) * [1.0, 0.0] + np.eye(8, 2)
    for starts, wrong in (((0.4, 0.41, 0.4), True), ((0.9, -0.2, 0.5), False)):
        fit = SimpleNamespace(starts=np.column_stack([starts, np.zeros(3)]), slopes=slopes)
        runs = SimpleNamespace(segments=SimpleNamespace(begin=np.zeros(3, int)))
        as_read = SimpleNamespace(fit=fit, shooting=runs)
        assert ("x" in wrong_starts(begun(0.0, 0.0), as_read)) is wrong
