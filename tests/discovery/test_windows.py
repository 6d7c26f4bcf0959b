import numpy as np
from hidden_in_a_mass import Experiment, mass, record, with_load

from gaitdisc.discovery.by_share import scale_of
from gaitdisc.discovery.inquiry import begin_inquiry
from gaitdisc.discovery.windows import NEAR, as_read_on, near_runs, on_longer_runs


def begun(hidden):
    inquiry = begin_inquiry(mass(), record(hidden, 3, Experiment(noise=0.002)))
    return inquiry, scale_of(inquiry)


def test_a_simulation_that_agrees_is_fitted_to_whole_trials():
    inquiry, scale = begun(mass())
    found = near_runs(inquiry, scale)
    assert found.shooting.segments.length == inquiry.longest
    assert on_longer_runs(inquiry, scale, found) is None


def test_runs_are_halved_where_the_simulation_leaves_the_data():
    inquiry, scale = begun(with_load("-60*x**3"))
    found = near_runs(inquiry, scale)
    assert found.shooting.segments.length < inquiry.longest
    whole = near_runs_of_one_length(inquiry, scale)
    assert scale.relative(found.account.fit) < scale.relative(whole)


def near_runs_of_one_length(inquiry, scale):
    from gaitdisc.discovery.account import account_for
    from gaitdisc.discovery.noise import white_noise

    shooting = inquiry.learned_runs(inquiry.longest).with_noise(white_noise(scale.spread))
    return account_for(shooting, inquiry.search.base, (), inquiry.guess.starts(shooting.segments)).fit


def test_on_longer_runs_the_simulation_as_read_errs_by_the_spread_at_most():
    inquiry, scale = begun(with_load("-60*x**3"))
    short = near_runs(inquiry, scale)
    again = as_read_on(inquiry, scale, short, short)
    assert np.ptp(again.errors) == 0.0
    assert 0 < again.gap <= np.sqrt(2.0) * (scale.spread / scale.size).max()
    assert NEAR == 0.25
