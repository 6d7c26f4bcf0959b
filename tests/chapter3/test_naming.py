"""Who names what is hidden: answers, and the page of them."""

from dataclasses import replace

import numpy as np
import pytest
from chapter3.burgers import burgers
from chapter3.naming import HiddenEffect, Naming, answer_of, discover_answer, namings_table
from chapter3.pages import naming_figure, naming_table
from chapter3.record import Conditions, recorded, system_of
from texts import says

from gaitdisc.discovery.result import Correction, Discovery, Estimate, FoundEffect, GapSize, Runs
from gaitdisc.errors import ShapeError
from gaitdisc.simulation.simulation_file import bundled


@pytest.mark.parametrize(
    ("hidden", "answer", "right"),
    [
        ("x³", "named", True),
        ("x³", "nothing", False),
        ("x³", "among others", False),
        ("", "nothing", True),
        ("", "named", False),
    ],
)
def test_right_is_the_name_alone_or_rightly_nothing(hidden, answer, right):
    assert Naming("c", hidden, "sindy", 0.01, 0, answer, "").right is right


def test_a_word_that_no_table_knows_is_a_defect():
    with pytest.raises(ValueError, match="'perhaps' of 'sindy'"):
        Naming("c", "x³", "sindy", 0.01, 0, "perhaps", "")


def test_the_table_has_a_row_an_answer():
    table = namings_table([Naming("c", "x³", "nn", 0.0, k, "curve", "s", accuracy=9.0) for k in range(3)])
    assert (len(table), table["accuracy"].tolist(), table["right"].any()) == (3, [9.0] * 3, False)


@pytest.fixture(scope="module")
def hidden(van_der_pol):
    return HiddenEffect("van der Pol", "−0.01 x³", van_der_pol, ("y", "cubic_stiffness"), 0.01, duration_s=20.0)


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
    moved = Correction("mu", 0.5, Estimate(0.55, 0.54, 0.56)), Correction("k", 1.0, Estimate(1.1, 0.9, 1.3))
    wrong = replace(hidden, effect=("mu", "wrong_parameter"), amount=0.55), replace(found, corrections=moved)
    assert answer_of(*wrong)[0] == ("among others" if effects else "named")


ANSWERS = [
    Naming("c", "x³", "sindy", 0.01, 0, "named", "y: x**3", 1.02, 90.0),
    Naming("c", "x³", "sindy", 0.01, 1, "wrong name", "y: x", accuracy=10.0),
    Naming("c", "x³", "gp", 0.01, 0, "curve", "a curve of the states, 7 % off what is missing", accuracy=80.0),
    Naming("d", "", "sindy", 0.01, 0, "nothing", "nothing"),
    Naming("d", "", "gp", 0.01, 0, "refused", "needs 2 states; 1 is measured. Measure both."),
]


def test_answers_are_counted_over_seeds_and_a_curve_says_how_far_it_is_off():
    table = naming_table(namings_table(ANSWERS))
    assert table.columns == ("case", "hidden", "noise", "n", "SINDy", "Gaussian process")
    assert says(table.rows[0][4], "named 1/2", "wrong name 1/2", "1.02")
    assert says(table.rows[0][5], "curve", "7 % off")
    assert table.rows[0][3] == "2"
    assert table.rows[1] == ("d", "nothing", "1.0%", "1", "nothing", "refused: needs 2 states")
    assert len(table.numbers) == len(ANSWERS)


def answer(tool, seed, answer, accuracy, diverged=None):
    return Naming("c", "x³", tool, 0.01, seed, answer, "", accuracy=accuracy, diverged_s=diverged)


def test_a_tile_says_the_answer_of_most_seeds_and_the_forecast():
    names = [answer("sindy", k, a, 90.0) for k, a in enumerate(("named", "named", "curve"))]
    names += [answer("gp", 0, "curve", -2e4), answer("nn", 0, "curve", 5.0, diverged=3.0)]
    figure = naming_figure(namings_table(names), "n")
    assert figure.numbers["kind"].tolist() == ["right", "curve", "curve"]
    assert figure.numbers["forecast"].tolist() == ["90", "<−999", "div."]
    texts = [text.get_text() for text in figure.drawn.axes[0].texts]
    assert texts == ["N 67", "90"]


def test_every_case_has_a_label_with_what_is_hidden():
    figure = naming_figure(namings_table([answer("sindy", 0, "named", 90.0)]), "n")
    assert [label.get_text() for label in figure.drawn.axes[0].get_yticklabels()] == ["c:\nx³"]
