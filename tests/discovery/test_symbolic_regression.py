from __future__ import annotations

import re

import pytest
from hidden_in_a_mass import Experiment, mass, record, with_load

from gaitdisc.discovery.candidate import Candidate
from gaitdisc.discovery.case import set_up_case
from gaitdisc.discovery.decision import Verdict, prove_held_out
from gaitdisc.discovery.discover import discover
from gaitdisc.discovery.fitted_shape import fit_shape
from gaitdisc.discovery.symbolic_regression import find_effect, read_instead, read_shape


def asked(term):
    case = set_up_case(mass(), record(with_load(term), 3, Experiment(seconds=8.0)))
    return case, case.as_read()


@pytest.fixture(scope="module")
def damped():
    """A damping that grows with the square of the displacement, which no effect of the catalogue is, and its shape."""
    case, as_read = asked("-8*x**2*v")
    shape = fit_shape(case, as_read)
    return case, as_read, Verdict(shape, (), proof=prove_held_out(case, as_read, shape))


@pytest.mark.slow
def test_a_shape_is_read_as_the_product_that_was_hidden(damped):
    verdict = read_shape(*damped)
    (part,) = verdict.found.parts
    assert verdict.reads_as == ""
    assert part.candidate.pieces == ("x**2*v",)
    assert part.values["factor"] == pytest.approx(-8, rel=0.03)
    assert verdict.proof.closed >= 0.95 * damped[2].proof.closed


def test_a_reading_that_is_an_effect_of_the_catalogue_is_said_to_be_one(damped):
    search = damped[0].search
    like = Candidate("missing_physics", "port", "load", "unnamed", ("x**3",), {}, "x", "")
    assert find_effect(search, like) == "cubic_stiffness"
    bump = Candidate("missing_physics", "port", "load", "unnamed", ("exp(-((x - _c)/_w)**2)",), {}, "x", "")
    assert find_effect(search, bump) == ""


def test_what_is_no_learned_shape_is_not_read(damped):
    case, as_read, verdict = damped
    nothing = Verdict(as_read, ())
    assert read_shape(case, as_read, nothing) is nothing
    unproven = Verdict(verdict.found, ())
    assert read_shape(case, as_read, unproven) is unproven


def test_names_stay_where_no_reading_has_fewer_numbers(damped):
    case, as_read, verdict = damped
    one = Verdict(verdict.found, ())
    assert read_instead(case, as_read, one) is one


@pytest.mark.slow
@pytest.mark.parametrize(
    ("term", "reading"),
    [
        ("-8*x**2*v", r"-8\.\d+\*\(x\*\*2\*v\)"),
        ("-6*exp(-((x - 0.3)/0.2)**2)", r"-6\.\d+\*\(exp\(-\(\((x|\(x\)) - 0\.30?\d*\)/0\.(2|19\d)\d*\)\*\*2\)\)"),
    ],
)
def test_pieces_of_the_catalogue_that_imitate_a_curve_do_not_stand_in_its_place(term, reading):
    found, augmented = discover(mass(), record(with_load(term), 3, Experiment(seconds=10.0)))
    assert found.verdict == "unnamed"
    (effect,) = found.effects
    assert re.fullmatch(reading, effect.reads_as)
    assert found.held_out.after < 1.2 * found.held_out.noise_floor
    assert found.to_json()["effects"][0]["reads_as"] == {"expression": effect.reads_as, "effect": None}
    assert effect.reads_as in found.sentence
    assert [one.name for one in augmented.effects] == ["unnamed"]
