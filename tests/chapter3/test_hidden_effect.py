from dataclasses import replace

import numpy as np
import pytest
from chapter3.methods import MethodSettings
from chapter3.naming import HiddenEffect, method_answer
from chapter3.record import Conditions, recorded, system_of
from texts import says

from gaitdisc.simulation.simulation_file import bundled

CUBIC = {"y": {"x**3": -0.01}}


@pytest.fixture(scope="module")
def hidden(van_der_pol):
    return HiddenEffect("van der Pol", "−0.01 x³", van_der_pol, ("y", "cubic_stiffness"), 0.01, CUBIC)


def test_sindy_names_the_term_and_its_number(hidden, quiet):
    found = method_answer(hidden, quiet, "sindy")
    assert (found.answer, found.right, found.said) == ("named", True, "y: -0.01*x**3")
    assert found.amount == pytest.approx(1.0, abs=1e-3)
    assert found.accuracy > 99


def test_another_term_beside_it_and_another_one_alone_are_distinguished(hidden, quiet):
    sought = replace(hidden, terms={"y": {"x": 1.0}})
    assert method_answer(sought, quiet, "sindy").answer == "wrong name"
    many = method_answer(hidden, quiet, "sindy", MethodSettings(threshold=1e-9))
    assert many.answer == "among others"


def test_a_curve_is_described_by_how_far_it_is_off(hidden, quiet):
    found = method_answer(hidden, quiet, "dmd")
    assert found.answer == "curve"
    assert found.said.startswith("a curve of time, ")
    assert found.said.endswith("% off what is missing")


def test_where_nothing_is_hidden_sindy_says_so_and_a_curve_stays_a_curve():
    alike = HiddenEffect("van der Pol", "", system_of(bundled("van_der_pol")))
    record = recorded(alike.system, Conditions(0.001, duration_s=20.0))
    assert method_answer(alike, record, "sindy").right
    curve = method_answer(alike, record, "dmd")
    assert not curve.right
    assert curve.said.endswith("where nothing is missing")


def test_one_measured_state_is_refused_in_words(hidden, van_der_pol):
    only = replace(van_der_pol, observation=np.eye(2)[:1])
    found = method_answer(replace(hidden, system=only), recorded(only, Conditions(duration_s=20.0)), "gp")
    assert found.answer == "refused"
    assert says(found.said, "2 states", "1 are: x")
