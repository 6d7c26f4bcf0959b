import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gaitdisc.statistics.stride_blocks import block_length, block_means, block_worth, stride_correlation


def walk(rng, strides, rho):
    shocks = rng.standard_normal((strides, 101, 1))
    curves = shocks.copy()
    for k in range(1, strides):
        curves[k] = rho * curves[k - 1] + np.sqrt(1 - rho**2) * shocks[k]
    return curves


@pytest.mark.parametrize("rho", [0.0, 0.3, 0.7])
def test_the_correlation_of_a_known_series_is_found(rho):
    assert stride_correlation(walk(np.random.default_rng(0), 2000, rho))[0] == pytest.approx(rho, abs=0.03)


@pytest.mark.parametrize(("rho", "length"), [(0.5, 1), (0.5, 4), (0.8, 10)])
def test_worth_is_the_variance_ratio_of_a_long_series(rho, length):
    rng = np.random.default_rng(1)
    n = 40 * length
    walks = walk(rng, n, rho)[:, :, 0]
    for _ in range(20):
        walks = np.hstack([walks, walk(rng, n, rho)[:, :, 0]])
    means = block_means(walks[:, :, None], length)[:, :, 0]
    between_blocks = means.var(axis=0, ddof=1).mean() / len(means)
    assert between_blocks / walks.mean(axis=0).var() == pytest.approx(block_worth(np.array([rho]), length)[0], rel=0.1)


@given(st.floats(0.0, 0.95), st.integers(8, 300))
def test_eight_blocks_are_kept_and_worth_rises_with_length(rho, strides):
    length = block_length(rho, strides)
    assert 1 <= length <= max(1, strides // 8)
    worth = [block_worth(np.array([rho]), k)[0] for k in (1, 2, 5)]
    assert worth == sorted(worth)
    assert worth[-1] <= 1 + 1e-12


def test_strides_that_are_left_over_lengthen_blocks():
    assert [len(part) for part in np.array_split(np.arange(11), 11 // 4)] == [6, 5]
    assert block_means(np.ones((11, 101, 2)), 4).shape == (2, 101, 2)
