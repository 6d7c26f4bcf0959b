"""A beam search on a mass that loses energy by a law that is not in the catalogue."""

import numpy as np
import pytest
from hidden_in_a_mass import Experiment, mass, record, with_load

from gaitdisc.discovery.beam import Beam, near_runs
from gaitdisc.discovery.case import set_up_case
from gaitdisc.discovery.gap_share import CrossValidated, errs_more
from gaitdisc.discovery.score import Score


@pytest.fixture(scope="module")
def beam():
    """Return a beam over what explains a stiffening spring and a loss between viscous and quadratic."""
    hidden = with_load("-16*x**3 - 0.6*v*abs(v)**0.5")
    case = set_up_case(mass(), record(hidden, 5, Experiment(noise=0.001)))
    scale = case.scale
    return Beam(case.search, scale, near_runs(case, scale))


@pytest.fixture(scope="module")
def best(beam):
    return beam.select_forward(beam.as_read)


def test_a_spring_and_a_loss_are_found_though_none_is_exact(beam, best):
    now, _ = beam.material(best)
    names = {label.split("@")[0] for label, _ in now.model.explanations}
    assert "cubic_stiffness" in names
    assert names - {"cubic_stiffness"} <= {"viscous_damping", "quadratic_drag", "wrong_parameter"}
    assert now.gap < 0.1 * beam.as_read.gap


def test_what_is_dear_is_not_named_where_plain_words_close_as_much(beam, best):
    assert beam.plainest(best).model.penalty <= best.model.penalty
    assert beam.cost(best) == min(map(beam.cost, beam.known.values()))
    assert beam.cost(beam.as_read) == pytest.approx(1.0)


def test_an_explanation_that_closes_next_to_nothing_is_small(beam, best):
    load = next(one for one in beam.search.candidates if one.label == "constant_load@load")
    more = beam._with(best, Score(load, {"factor": 0.001}, 0.0))
    kept, small = beam.material(more)
    assert kept.model.explanations == beam.material(best)[0].model.explanations
    assert "constant_load" in {part.candidate.name for part in small}


def test_the_test_of_two_sets_goes_by_the_pieces(beam, best):
    other = CrossValidated(best.model, best.shooting, best.errors * 1.5, best.gap)
    assert errs_more(other, best) < 0.01
    assert errs_more(best, other) > 0.9
    assert errs_more(CrossValidated(best.model, best.shooting, np.full(1, np.inf), np.inf), best) == 0.0
