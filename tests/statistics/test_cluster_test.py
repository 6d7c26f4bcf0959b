import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import stats
from scipy.ndimage import gaussian_filter1d

from gaitdisc.errors import ComparisonError, ShapeError
from gaitdisc.statistics.cluster_test import PermutationPlan, one_sample_test, sign_flips, two_sample_test
from gaitdisc.statistics.stride_residuals import block_length, block_means, block_worth, stride_correlation


def test_few_units_have_every_sign_once():
    signs, exact = sign_flips(7, PermutationPlan())
    assert exact
    assert len({tuple(row) for row in signs}) == len(signs) == 2**6 - 1
    assert (signs[:, 0] == 1).all()
    assert set(np.unique(signs)) == {-1.0, 1.0}


def test_many_units_have_as_many_as_are_asked_for_and_the_same_for_a_seed():
    signs, exact = sign_flips(40, PermutationPlan(permutations=300, seed=3))
    assert (signs.shape, exact) == ((299, 40), False)
    np.testing.assert_array_equal(signs, sign_flips(40, PermutationPlan(permutations=300, seed=3))[0])
    assert abs(signs[:, 1:].mean()) < 0.05


def test_permutations_that_could_show_nothing_are_refused():
    with pytest.raises(ComparisonError, match=r"0\.01.*100 permutations.*32"):
        sign_flips(6, PermutationPlan(alpha=0.01))


FEW = PermutationPlan(permutations=300)


def smooth(rng, units, channels=3, width=5.0):
    wide = rng.standard_normal((units, 141, channels))
    return gaussian_filter1d(wide, width, axis=1)[:, 20:121] if width else wide[:, 20:121]


def autoregressed(rng, strides, rho, channels=6):
    shocks = smooth(rng, strides, channels)
    curves = shocks.copy()
    for k in range(1, strides):
        curves[k] = rho * curves[k - 1] + np.sqrt(1 - rho**2) * shocks[k]
    return curves


def test_t_is_students_and_welchs():
    rng = np.random.default_rng(1)
    first, second = smooth(rng, 9), 2 * smooth(rng, 14) + 0.1
    ours = two_sample_test(first, second, FEW)
    welch = stats.ttest_ind(second, first, equal_var=False)
    np.testing.assert_allclose(ours.t, welch.statistic, rtol=1e-9)
    np.testing.assert_allclose(one_sample_test(first, FEW).t, stats.ttest_1samp(first, 0.0).statistic, rtol=1e-9)


def test_all_sign_flips_of_eight_units():
    found = one_sample_test(np.random.default_rng(0).normal(3.0, 1.0, (8, 20, 1)))
    assert (found.permutations, found.exact) == (128, True)
    assert found.p[0] == pytest.approx(1 / 128)


def test_a_cluster_has_its_place_sign_and_channel():
    rng = np.random.default_rng(3)
    first, second = smooth(rng, 20), smooth(rng, 24)
    sd = second.std()
    first[:, 12:56, 1] -= 4 * sd
    found = two_sample_test(first, second, FEW).clusters
    assert [(c.channel, c.sign) for c in found] == [(1, 1)]  # the second lies above
    assert found[0].first in (12, 13)
    assert found[0].last in (54, 55)
    assert found[0].p == pytest.approx(1 / 300)


def test_a_region_that_changes_sign_is_two_clusters():
    curves = np.random.default_rng(4).normal(0, 0.1, (10, 101, 1))
    curves[:, :50] += 5.0
    curves[:, 50:] -= 5.0
    assert [(c.first, c.last, c.sign) for c in one_sample_test(curves).clusters] == [(0, 49, 1), (50, 100, -1)]


def test_a_constant_difference_without_spread_is_seen_not_divided_by_zero():
    curves = np.random.default_rng(5).normal(0, 1, (10, 101, 2))
    curves[:, :20, 0] = 1.0
    found = one_sample_test(curves)
    assert np.isfinite(found.t).all()
    assert found.clusters[0].channel == 0
    assert found.clusters[0].last >= 19


@settings(max_examples=15, deadline=None)
@given(st.integers(0, 10**6), st.floats(0.01, 100.0), st.floats(-50.0, 50.0))
def test_unit_and_offset_do_not_matter_and_swapping_turns_the_sign(seed, scale, offset):
    rng = np.random.default_rng(seed)
    first, second = smooth(rng, 7, 2), smooth(rng, 8, 2) + 0.1
    one = two_sample_test(first, second, FEW)
    other = two_sample_test(scale * first + offset, scale * second + offset, FEW)
    np.testing.assert_allclose(one.t, other.t, rtol=1e-5, atol=1e-6)
    np.testing.assert_allclose(two_sample_test(second, first, FEW).t, -one.t, rtol=1e-9)
    assert one.threshold == pytest.approx(other.threshold, rel=1e-5)


def test_worth_divides_t():
    curves = np.random.default_rng(6).normal(0.5, 1, (12, 101, 2))
    plain, half = one_sample_test(curves, FEW), one_sample_test(curves, FEW, np.array([1.0, 0.25]))
    np.testing.assert_allclose(half.t, plain.t * [1.0, 0.5])
    np.testing.assert_allclose(half.standard_error, plain.standard_error * [1.0, 2.0])


def test_too_few_units_and_gaps_are_refused_in_words():
    with pytest.raises(ComparisonError, match=r"6 units.*5"):
        one_sample_test(np.zeros((5, 101, 1)))
    with pytest.raises(ComparisonError, match=r"6 units.*3"):
        two_sample_test(np.zeros((9, 101, 1)), np.zeros((3, 101, 1)))
    gap = np.ones((8, 101, 1))
    gap[2, 5] = np.nan
    with pytest.raises(ShapeError, match="1 values missing"):
        one_sample_test(gap)
    with pytest.raises(ShapeError, match="same points of the stride"):
        two_sample_test(np.ones((8, 101, 1)), np.ones((8, 51, 1)))
    with pytest.raises(ComparisonError, match=r"1000 permutations.*300"):
        one_sample_test(np.ones((20, 101, 1)), PermutationPlan(alpha=0.001, permutations=300))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("strides", "rho", "most"), [(16, 0.3, 0.10), (30, 0.0, 0.08), (30, 0.6, 0.10), (80, 0.6, 0.09), (80, 0.8, 0.10)]
)
def test_family_wise_error_with_autocorrelated_strides(strides, rho, most):
    """Six channels together, blocks as `gaitdisc compare` makes them; without blocks it is .3 to 1."""
    alarms = [], []
    for seed in range(200):
        rng = np.random.default_rng([strides, round(10 * rho), seed])
        first, second = autoregressed(rng, strides, rho), autoregressed(rng, strides + 5, rho)
        plan = PermutationPlan(permutations=300, seed=seed)
        correlation = np.maximum(stride_correlation(first), stride_correlation(second))
        length = block_length(float(correlation.max()), strides)
        worth = block_worth(correlation, length)
        two = two_sample_test(block_means(first, length), block_means(second, length), plan, worth)
        correlation = stride_correlation(second)
        length = block_length(float(correlation.max()), strides + 5)
        one = one_sample_test(block_means(second, length), plan, block_worth(correlation, length))
        for found, test in zip(alarms, (two, one), strict=True):
            found.append(bool(test.clusters))
    assert np.mean(alarms[0]) < most
    assert np.mean(alarms[1]) < most


@pytest.mark.slow
@pytest.mark.parametrize("width", [0.0, 3.0, 8.0])
def test_family_wise_error_of_independent_units_is_alpha(width):
    """White and smooth; three standard errors of a share of .05 in 400 are .033."""
    alarms = {"one": [], "two": []}
    for seed in range(400):
        rng = np.random.default_rng([7, seed])
        first, second = smooth(rng, 10, width=width), 3 * smooth(rng, 10, width=width)
        plan = PermutationPlan(permutations=300, seed=seed)
        alarms["one"].append(bool(one_sample_test(first, plan).clusters))
        alarms["two"].append(bool(two_sample_test(first, second, plan).clusters))
    assert np.mean(alarms["one"]) == pytest.approx(0.05, abs=0.035)
    assert np.mean(alarms["two"]) == pytest.approx(0.05, abs=0.035)
