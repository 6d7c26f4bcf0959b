import numpy as np
from hidden_in_a_mass import Experiment, mass, record, with_load

from gaitdisc.discovery.beam import as_read_on, near_runs, on_longer_runs
from gaitdisc.discovery.case import set_up_case
from gaitdisc.discovery.criteria import CRITERIA


def begun(hidden):
    case = set_up_case(mass(), record(hidden, 3, Experiment(noise=0.002)))
    return case, case.scale


def test_a_simulation_that_agrees_is_fitted_to_whole_trials():
    case, scale = begun(mass())
    found = near_runs(case, scale)
    assert found.shooting.segments.length == case.longest
    assert on_longer_runs(case, scale, found) is None


def test_runs_are_halved_where_the_simulation_leaves_the_data():
    case, scale = begun(with_load("-60*x**3"))
    found = near_runs(case, scale)
    assert found.shooting.segments.length < case.longest
    whole = near_runs_of_one_length(case, scale)
    assert scale.relative(found.model.fit) < scale.relative(whole)


def near_runs_of_one_length(case, scale):
    from gaitdisc.discovery.candidate_model import fit_model
    from gaitdisc.discovery.noise import white_noise

    shooting = case.learned_runs(case.longest).with_noise(white_noise(scale.spread))
    return fit_model(shooting, case.search.base, (), case.guess.starts(shooting.segments)).fit


def test_on_longer_runs_the_simulation_as_read_errs_by_the_spread_at_most():
    case, scale = begun(with_load("-60*x**3"))
    short = near_runs(case, scale)
    again = as_read_on(case, scale, short, short)
    assert np.ptp(again.errors) == 0.0
    assert 0 < again.gap <= np.sqrt(2.0) * (scale.spread / scale.size).max()
    assert CRITERIA.near == 0.25
