import re

import numpy as np
import pytest
from hidden_in_a_mass import MASS, Experiment, mass, record, with_load

from gaitdisc.discovery.case import set_up_case
from gaitdisc.discovery.fitted_shape import FLAT_BUMPS, fit_shape, shapes_at
from gaitdisc.simulation.expression import parse
from gaitdisc.simulation.simulation_file import parse_simulation


@pytest.fixture(scope="module")
def bumpy():
    case = set_up_case(mass(), record(with_load("-6*exp(-((x - 0.3)/0.2)**2)"), 3, Experiment(trials=6)))
    return case, case.as_read()


def test_shapes_over_place_speed_and_both_are_tried(bumpy):
    case, now = bumpy
    shapes = shapes_at(case.search.places[0], now, case.search)
    assert {one.name for one in shapes} == {"unnamed"}
    assert len(shapes[0].pieces) == FLAT_BUMPS
    assert all(parse(piece) for one in shapes for piece in one.pieces)
    assert any("x" in one.pieces[0] and "v" in one.pieces[0] for one in shapes)


def test_bumps_lie_where_the_run_goes(bumpy):
    case, now = bumpy
    first = shapes_at(case.search.places[0], now, case.search)[0]
    x = now.fit.states[..., 0]
    centres = [float(piece.split(" - ")[1].split("/")[0].strip("()")) for piece in first.pieces]
    assert x.min() <= min(centres) < 0 < max(centres) <= x.max()


def test_powers_of_two_states_are_tried_up_to_the_third_together(bumpy):
    case, now = bumpy
    (powers,) = [one for one in shapes_at(case.search.places[0], now, case.search) if "1" in one.pieces]
    assert len(powers.pieces) == 10
    assert max(sum(map(int, re.findall(r"\*\*(\d)", piece))) for piece in powers.pieces) == 3
    x = now.fit.states[..., 0]
    centre, half = map(float, re.search(r"x - (?:\()?([-\d.]+)\)*/([\d.]+)", powers.pieces[-1]).groups())
    assert np.mean(np.abs((x - centre) / half) <= 1) == pytest.approx(0.96, abs=0.01)


def test_where_there_is_a_stride_a_shape_may_be_locked_to_it():
    strides = parse_simulation(
        MASS.replace("inputs.push", "inputs.phase").replace("(push +", "(phase +"), "stride.toml"
    )
    case = set_up_case(strides, record(mass(), 0, Experiment(2, 4.0)))
    shapes = shapes_at(case.search.places[0], case.as_read(), case.search)
    assert any("phase" in one.pieces[0] for one in shapes)


@pytest.mark.slow
def test_a_fitted_shape_closes_a_gap_that_has_no_name(bumpy):
    case, now = bumpy
    shape = fit_shape(case, now)
    assert shape is not None
    (part,) = shape.parts
    assert (part.candidate.name, part.candidate.place) == ("unnamed", "load")
    plain = now.under(shape)
    before, after, noise = plain.fit.misfit, shape.fit.misfit, shape.fit.white.size
    assert 1 - (after - noise) / (before - noise) > 0.7
