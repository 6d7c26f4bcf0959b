import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from statsmodels.stats.multitest import multipletests

from gaitdisc.errors import ComparisonError
from gaitdisc.statistics.holm_sidak import check_level, holm_sidak, step_levels

PROBABILITIES = st.lists(st.floats(0, 1), min_size=1, max_size=24)


def plainly(p):
    """Independent small implementation: the definition, one test after the other."""
    order = sorted(range(len(p)), key=lambda i: p[i])
    adjusted, largest = [0.0] * len(p), 0.0
    for step, i in enumerate(order):
        largest = max(largest, 1 - (1 - p[i]) ** (len(p) - step))
        adjusted[i] = largest
    return adjusted


def test_the_printed_level_of_the_dissertation():
    rejected = [0.00098, 0.00195, 0.00293, 0.00684]
    found = holm_sidak([*rejected, 0.0186, 0.1, 0.4, 0.9])
    assert found.rejected.tolist() == [True] * 4 + [False] * 4
    assert f"{found.critical:.3f}" == "0.013"
    last = holm_sidak([0.000977] * 7 + [0.0420])  # "p < 0.042": W = 10 tested last, at alpha itself
    assert last.rejected.all() and last.critical == pytest.approx(0.05)
    assert last.adjusted[-1] == pytest.approx(0.0420)


def test_a_thousand_random_families_as_statsmodels_and_the_definition_have_them():
    rng = np.random.default_rng(0)
    for _ in range(1000):
        p = rng.random(rng.integers(1, 30)) ** rng.choice([1, 4, 12])
        found = holm_sidak(p)
        rejected, adjusted, _, _ = multipletests(p, 0.05, "holm-sidak")
        np.testing.assert_allclose(found.adjusted, adjusted, rtol=0, atol=1e-12)
        np.testing.assert_allclose(found.adjusted, plainly(p), rtol=0, atol=1e-12)
        np.testing.assert_array_equal(found.rejected, rejected)


def test_known_family():
    found = holm_sidak([0.01, 0.02, 0.03, 0.04, 0.2])
    assert found.adjusted.round(4).tolist() == [0.0490, 0.0776, 0.0873, 0.0873, 0.2]
    assert found.rejected.tolist() == [True, False, False, False, False]
    assert found.critical == pytest.approx(step_levels(5)[1])


@given(PROBABILITIES)
def test_adjusted_p_are_no_smaller_and_keep_the_order(p):
    found = holm_sidak(p)
    assert np.all(found.adjusted >= np.array(p) - 1e-15)
    assert np.all(found.adjusted <= 1)
    assert np.all(np.diff(found.adjusted[np.argsort(p, kind="stable")]) >= 0)


@given(PROBABILITIES, st.randoms())
def test_the_order_of_the_tests_does_not_matter(p, random):
    order = list(range(len(p)))
    random.shuffle(order)
    np.testing.assert_array_equal(holm_sidak([p[i] for i in order]).adjusted, holm_sidak(p).adjusted[order])


def test_nothing_is_rejected_after_a_step_that_failed():
    found = holm_sidak([0.030, 0.031, 0.032, 0.0499])
    assert not found.rejected.any()
    assert found.critical == pytest.approx(step_levels(4)[0])


def test_a_p_of_zero_and_of_one():
    assert holm_sidak([0.0, 1.0]).adjusted.tolist() == [0.0, 1.0]


@pytest.mark.parametrize(("p", "words"), [([], "there is no test"), ([0.1, np.nan], "found nan"), ([1.2], "found 1.2")])
def test_what_is_no_p_is_refused(p, words):
    with pytest.raises(ComparisonError, match=rf"lie between 0 and 1; {words}"):
        holm_sidak(p)


@pytest.mark.parametrize("level", [0.0, 1.0, 5.0, float("nan")])
def test_a_level_is_between_0_and_1(level):
    with pytest.raises(ComparisonError, match=f"alpha .*{level:g}"):
        check_level(level, "alpha")
