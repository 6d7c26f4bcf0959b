from dataclasses import replace

import numpy as np
import pytest
from chapter3.burgers import burgers
from chapter3.naming import HiddenEffect, answer_of, discover_answer
from chapter3.record import Conditions, recorded, system_of

from gaitdisc.discovery.result import Discovery, Estimate, FoundEffect, GapSize, Runs
from gaitdisc.errors import ShapeError
from gaitdisc.simulation.parts import Term
from gaitdisc.simulation.simulation_file import bundled


@pytest.fixture(scope="module")
def hidden():
    system = system_of(bundled("van_der_pol"), Term("y", "equation", "cubic_stiffness", "-0.01*x**3"))
    return HiddenEffect("van der Pol", "−0.01 x³", system, ("y", "cubic_stiffness"), 0.01, duration_s=20.0)


def test_the_name_the_number_and_the_forecast(hidden):
    record = recorded(hidden.system, Conditions(0.01, duration_s=20.0))
    found = discover_answer(hidden, record)
    assert (found.tool, found.answer) == ("discover", "named")
    assert found.amount == pytest.approx(1.0, abs=0.02)
    assert found.accuracy > 95
    assert "cube of displacement" in found.said
    assert discover_answer(replace(hidden, effect=("x", "offset")), record).answer == "wrong name"


def test_nothing_hidden_is_reported(hidden):
    alike = HiddenEffect("van der Pol", "", system_of(bundled("van_der_pol")), duration_s=20.0)
    assert discover_answer(alike, recorded(alike.system, Conditions(0.01, duration_s=20.0))).right


def test_a_field_without_a_simulation_file_is_refused(hidden):
    field = replace(hidden, system=burgers(0.1))
    record = recorded(field.system, Conditions(duration_s=2.0))
    with pytest.raises(ShapeError, match="is known as BurgersRates"):
        discover_answer(field, record)


def effect(name, place="y", tied=False):
    kind = "observation" if name == "sensor_gain" else "equation"
    return FoundEffect(kind, place, name, "", {"factor": Estimate(0.02, 0.01, 0.03)}, tied=tied)


@pytest.mark.parametrize(
    ("verdict", "effects", "rivals", "answer"),
    [
        ("missing_physics", ["cubic_stiffness"], [], "named"),
        ("missing_physics", ["cubic_stiffness", "linear_damping"], [], "among others"),
        ("missing_physics", ["cubic_stiffness"], [effect("dead_zone_spring", tied=True)], "tied"),
        ("missing_physics", ["dead_zone_spring"], [effect("cubic_stiffness", tied=True)], "tied"),
        ("unnamed", ["unnamed"], [effect("cubic_stiffness", tied=True)], "tied"),
        ("unnamed", ["unnamed"], [effect("cubic_stiffness")], "curve"),
        ("missing_physics", ["dead_zone_spring"], [effect("cubic_stiffness")], "wrong name"),
        ("no_gap", [], [effect("cubic_stiffness")], "nothing"),
    ],
)
def test_a_verdict_is_an_answer(hidden, verdict, effects, rivals, answer):
    size, none = GapSize(2.0, 1.0, 1.0), np.empty((0, 0, 1))
    runs = Runs(np.empty(0, int), np.empty((0, 0)), np.empty(0), none, none, none)
    named = tuple(effect(name) for name in effects)
    found = Discovery(verdict, "", (), named, tuple(rivals), size, size, ("x",), ("1",), runs)
    said, amount = answer_of(hidden, found)
    assert said == answer
    assert (amount == pytest.approx(2.0)) == ("cubic_stiffness" in effects)
