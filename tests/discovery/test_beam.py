"""A beam search on a mass that loses energy by a law that is not in the catalogue."""

from dataclasses import replace

import numpy as np
import pytest
from hidden_in_a_mass import MASS, Experiment, mass, record, with_load

from gaitdisc.discovery.beam import Beam, as_read_on, closing_most, near_runs, on_longer_runs
from gaitdisc.discovery.case import set_up_case
from gaitdisc.discovery.criteria import CRITERIA
from gaitdisc.discovery.discover import discover
from gaitdisc.discovery.gap_share import errs_more
from gaitdisc.discovery.score import Score
from gaitdisc.simulation.simulation_file import parse_simulation

CLEAN = Experiment(seconds=8.0, noise=0.001)


@pytest.fixture(scope="module")
def beam():
    """Return a beam over what explains a stiffening spring and a loss between viscous and quadratic."""
    hidden = with_load("-16*x**3 - 0.6*v*abs(v)**0.5")
    case = set_up_case(mass(), record(hidden, 5, replace(CLEAN, seconds=3.0)))
    return Beam(case.search, case.scale, near_runs(case))


@pytest.fixture(scope="module")
def best(beam):
    return beam.select_forward(beam.as_read)


@pytest.mark.slow
def test_a_spring_and_a_loss_are_found_though_none_is_exact(beam, best):
    now, _ = beam.material(best)
    names = {label.split("@")[0] for label, _ in now.explanations}
    assert "cubic_stiffness" in names
    assert names - {"cubic_stiffness"} <= {"viscous_damping", "quadratic_drag", "wrong_parameter"}
    assert now.gap < 0.1 * beam.as_read.gap


def test_what_is_dear_is_not_named_where_plain_words_close_as_much(beam, best):
    assert beam.plainest(best).penalty <= best.penalty
    assert beam.cost(best) == min(map(beam.cost, beam.known.values()))
    assert beam.cost(beam.as_read) == pytest.approx(1.0)


def test_an_explanation_that_closes_next_to_nothing_is_small(beam, best):
    load = next(one for one in beam.search.candidates if one.label == "constant_load@load")
    (more,) = beam.fit([(*best.parts, Score(load, {"factor": 0.001}, 0.0))], best)
    kept, small = beam.material(more)
    assert kept.explanations == beam.material(best)[0].explanations
    assert "constant_load" in {part.candidate.name for part in small}


def test_the_test_of_two_sets_goes_by_the_pieces(beam, best):
    other = replace(best, errors=best.errors * 1.5)
    assert errs_more(other, best) < 0.01
    assert errs_more(best, other) > 0.9
    assert errs_more(replace(best, errors=np.array([np.inf])), best) == 0.0


def begun(hidden):
    case = set_up_case(mass(), record(hidden, 3, Experiment(noise=0.002)))
    return case, case.scale


def test_a_simulation_that_agrees_is_fitted_to_whole_trials():
    case, _ = begun(mass())
    found = near_runs(case)
    assert found.shooting.segments.length == case.longest
    assert on_longer_runs(case, found) is None


def test_runs_are_halved_where_the_simulation_leaves_the_data():
    case, scale = begun(with_load("-60*x**3"))
    found = near_runs(case)
    assert found.shooting.segments.length < case.longest
    whole = near_runs_of_one_length(case, scale)
    assert scale.relative(found.fit) < scale.relative(whole)


def near_runs_of_one_length(case, scale):
    from gaitdisc.discovery.noise import white_noise
    from gaitdisc.discovery.scored_model import fit_model

    shooting = case.cut_learned_runs(case.longest).with_noise(white_noise(scale.spread))
    return fit_model(shooting, case.search.base, (), shooting.segments.starts(case.guess)).fit


def test_on_longer_runs_the_simulation_as_read_errs_by_the_spread_at_most():
    case, scale = begun(with_load("-60*x**3"))
    short = near_runs(case)
    again = as_read_on(scale, short, short)
    assert np.ptp(again.errors) == 0.0
    assert 0 < again.gap <= np.sqrt(2.0) * (scale.spread / scale.size).max()
    assert CRITERIA.near == 0.25


def test_what_leaves_the_sensors_noise_is_known_from_the_record_alone(case, as_read, named):
    scale = case.scale
    assert case.leaves_noise(named[0])
    assert not case.leaves_noise(as_read)
    assert not scale.agrees(as_read.fit)


def test_a_simulation_that_errs_leaves_noise_where_that_is_a_small_share_of_the_spread(case, as_read, monkeypatch):
    base = replace(case.search.base, inexact=0.02)
    errs = replace(case, search=replace(case.search, base=base))
    assert not errs.leaves_noise(as_read)
    loose = replace(CRITERIA, inexact=2 * errs.scale.relative(as_read.fit))
    monkeypatch.setattr("gaitdisc.discovery.case.CRITERIA", loose)
    assert errs.leaves_noise(as_read)
    assert not case.leaves_noise(as_read)


def test_where_nothing_is_missing_nothing_is_weighed():
    case = set_up_case(mass(), record(mass(), 3, CLEAN))
    scale = case.scale
    assert scale.agrees(case.as_read().fit)
    assert closing_most(case, ()) is None


@pytest.mark.slow
def test_a_loss_that_no_name_is_exact_for_is_named_by_the_nearest():
    found, augmented = discover(mass(), record(with_load("-1.2*v*abs(v)**0.5"), 5, CLEAN))
    assert found.verdict in ("missing_physics", "wrong_parameter")
    losses = {"viscous_damping", "quadratic_drag", "coulomb_friction", "wrong_parameter"}
    assert {one.name for one in found.effects} <= losses
    assert found.held_out.after < 0.3 * found.held_out.before
    assert found.held_out.p < 0.05
    assert found.held_out.noise_floor == pytest.approx(CLEAN.noise, rel=0.25)
    assert augmented != mass()


@pytest.mark.slow
def test_a_number_ten_times_too_large_is_found_where_no_slope_at_the_files_leads_to_it():
    stiff = parse_simulation(MASS.replace("value = 24.0", "value = 240.0"), "mass.toml")
    case = set_up_case(stiff, record(with_load("-0.6*v*abs(v)**0.5"), 5, CLEAN))
    found = closing_most(case, ())
    (k,) = (part for part in found.now.parts if part.candidate.label == "wrong_parameter@k")
    assert k.values["value"] == pytest.approx(24.0, rel=0.05)
