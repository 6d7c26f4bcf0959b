from dataclasses import replace

import pytest
from hidden_in_a_mass import MASS, Experiment, mass, record, with_load

from gaitdisc.discovery.beam import closing_most
from gaitdisc.discovery.case import set_up_case
from gaitdisc.discovery.criteria import CRITERIA
from gaitdisc.discovery.discover import discover
from gaitdisc.simulation.simulation_file import simulation_of

CLEAN = Experiment(seconds=8.0, noise=0.001)


def test_what_leaves_the_sensors_noise_is_known_from_the_record_alone(case, as_read, named):
    scale = case.scale
    assert case.leaves_noise(named[0])
    assert not case.leaves_noise(as_read)
    assert not scale.agrees(as_read.model.fit)


def test_a_simulation_that_errs_leaves_noise_where_that_is_a_small_share_of_the_spread(case, as_read, monkeypatch):
    base = replace(case.search.base, inexact=0.02)
    errs = replace(case, search=replace(case.search, base=base))
    assert not errs.leaves_noise(as_read)
    loose = replace(CRITERIA, inexact=2 * errs.scale.relative(as_read.model.fit))
    monkeypatch.setattr("gaitdisc.discovery.case.CRITERIA", loose)
    assert errs.leaves_noise(as_read)
    assert not case.leaves_noise(as_read)


def test_where_nothing_is_missing_nothing_is_weighed():
    case = set_up_case(mass(), record(mass(), 3, CLEAN))
    scale = case.scale
    assert scale.agrees(case.as_read().model.fit)
    assert closing_most(case, scale, ()) is None


@pytest.fixture(scope="module")
def answered():
    """Return what is found of a loss between viscous and quadratic, which no name is exact for."""
    return discover(mass(), record(with_load("-1.2*v*abs(v)**0.5"), 5, CLEAN))


def test_a_loss_that_no_name_is_exact_for_is_named_by_the_nearest(answered):
    found, augmented = answered
    assert found.verdict in ("missing_physics", "wrong_parameter")
    losses = {"viscous_damping", "quadratic_drag", "coulomb_friction", "wrong_parameter"}
    assert {one.name for one in found.effects} <= losses
    assert found.held_out.after < 0.3 * found.held_out.before
    assert found.held_out.p < 0.05
    assert augmented != mass()


def test_the_noise_floor_is_the_sensors(answered):
    found, _ = answered
    assert found.held_out.noise_floor == pytest.approx(CLEAN.noise, rel=0.25)


def test_what_is_left_is_told_as_a_share(answered):
    found, _ = answered
    size = found.held_out
    left = (size.after**2 - size.noise_floor**2) / (size.before**2 - size.noise_floor**2)
    assert found.to_json()["gap"]["held_out"]["unexplained"] == pytest.approx(max(left, 0.0))


def test_a_number_ten_times_too_large_is_found_where_no_slope_at_the_files_leads_to_it():
    stiff = simulation_of(MASS.replace("value = 24.0", "value = 240.0"), "mass.toml")
    case = set_up_case(stiff, record(with_load("-0.6*v*abs(v)**0.5"), 5, CLEAN))
    found = closing_most(case, case.scale, ())
    (k,) = (part for part in found.now.model.parts if part.candidate.label == "wrong_parameter@k")
    assert k.values["value"] == pytest.approx(24.0, rel=0.05)
