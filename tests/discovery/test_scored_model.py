from dataclasses import replace

import numpy as np
import pytest
from hidden_in_a_mass import DAMPER, ONE_SIDED

from gaitdisc.discovery.candidate import Candidate
from gaitdisc.discovery.criteria import CRITERIA
from gaitdisc.discovery.scored_model import Part, compared, ranked, score


@pytest.fixture(scope="module")
def with_cubic(case, as_read, cubic):
    part = Part(cubic, {"factor": -14.0})
    return as_read.refitted(as_read.shooting, (part,))


def test_under_its_own_noise_an_account_leaves_numbers_of_unit_variance(case, as_read, with_cubic):
    own = score(with_cubic)
    fit = own.fit
    used = fit.starts.size + 1
    assert fit.misfit / (fit.white.size - used) == pytest.approx(1.0, abs=0.1)


def test_the_noise_of_the_true_account_is_that_of_the_sensor(case, as_read, with_cubic):
    own = score(with_cubic)
    hidden = 0.02 * case.measured.observed.std()
    assert own.noise.size[0] == pytest.approx(hidden, rel=0.1)


def test_what_comes_late_sees_the_past_of_the_account_and_not_of_the_simulation_as_read(case, as_read, with_cubic):
    own = score(with_cubic)
    past, states = own.shooting.segments.of(own.shooting.past), own.fit.states
    apart = np.abs(states - as_read.fit.states).max()
    assert np.abs(past - states).max() < 0.01 * apart


def test_where_the_simulation_errs_by_a_share_of_the_spread_the_noise_is_no_less_and_evidence_falls(
    case, as_read, with_cubic
):
    base = replace(case.search.base, inexact=0.1)
    models = with_cubic, replace(with_cubic, base=base)
    exact, inexact = (score(one) for one in models)
    spread = case.measured.observed.std()
    assert inexact.noise.size[0] ** 2 == pytest.approx(exact.noise.size[0] ** 2 + (0.1 * spread) ** 2, rel=0.05)
    gains = [plain.bic - true.bic for plain, true in (compared([as_read, one]) for one in (exact, inexact))]
    assert 0 < gains[1] < gains[0]


def test_accounts_are_compared_under_the_noise_that_the_best_leaves(case, as_read, with_cubic):
    plain, true = compared([as_read, with_cubic])
    assert plain.noise is true.noise
    assert true.noise.size[0] < as_read.noise.size[0]
    assert plain.bic - true.bic > 100


def test_the_order_in_which_accounts_stand_does_not_decide(case, as_read, with_cubic):
    plain, true = compared([as_read, with_cubic])
    true_first, plain_last = compared([with_cubic, as_read])
    assert true_first.bic == pytest.approx(true.bic, rel=1e-3)
    assert plain_last.bic == pytest.approx(plain.bic, rel=0.02)


def test_an_account_under_its_own_noise_stays_as_it_is(case, as_read):
    assert as_read.under(as_read) is as_read


def test_labels_name_what_is_in(as_read, with_cubic):
    assert as_read.labels == ()
    assert with_cubic.labels == ("cubic_stiffness@load",)
    assert np.isfinite(with_cubic.bic)


def test_under_anothers_noise_what_was_gained_stays(case, as_read, with_cubic):
    own = score(with_cubic)
    moved = replace(as_read, gained=7.0).under(own)
    assert (moved.gained, moved.noise) == (7.0, own.noise)


NUMBER = Candidate("wrong_parameter", "parameter", "c", "wrong_parameter")
SENSOR = Candidate("sensor_error", "observation", "x", "sensor_gain")
OPEN = (ONE_SIDED, DAMPER, NUMBER, SENSOR)


def _judged(as_read, candidate, bic, size):
    """A model of a given evidence, by a residual that has it."""
    fit = replace(as_read.fit, free=tuple("abcdef"[:size]))
    one = replace(as_read, fit=fit, parts=(Part(candidate, {}),))
    scale = ((bic - (one.bic - fit.misfit)) / fit.misfit) ** 0.5
    return replace(one, fit=replace(fit, white=fit.white * scale))


def test_the_better_explanation_stands_first(as_read):
    better, worse = _judged(as_read, DAMPER, 5e3, 1), _judged(as_read, ONE_SIDED, 6e3, 1)
    assert ranked([worse, better], OPEN) == [better, worse]


def test_a_simpler_statement_stands_before_one_that_is_hardly_better(as_read):
    simple, wordy = _judged(as_read, DAMPER, 5e3 + CRITERIA.margin / 2, 1), _judged(as_read, ONE_SIDED, 5e3, 2)
    assert ranked([wordy, simple], OPEN)[0] is simple
    far = _judged(as_read, DAMPER, 5e3 + 2 * CRITERIA.margin, 1)
    assert ranked([wordy, far], OPEN)[0] is wordy


def test_of_equals_a_wrong_number_stands_first_and_a_missing_term_whose_kind_has_most_members_last(as_read):
    three = [_judged(as_read, one, 5e3 + i / 10, 1) for i, one in enumerate((DAMPER, SENSOR, NUMBER))]
    assert ranked(three, OPEN) == three[::-1]


def test_accounts_that_failed_are_not_ranked(as_read):
    failed = replace(as_read.fit, white=as_read.fit.white * float("inf"))
    assert ranked([replace(as_read, fit=failed)], OPEN) == []


def test_accounts_that_are_all_hopeless_are_ranked_as_well(as_read):
    hopeless = [_judged(as_read, one, 1e20, 1) for one in (DAMPER, ONE_SIDED)]
    assert len(ranked(hopeless, OPEN)) == 2
