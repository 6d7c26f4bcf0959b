import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gaitdisc.errors import StrideError
from gaitdisc.recording import Strides
from gaitdisc.statistics.stride_residuals import (
    block_length,
    block_means,
    block_worth,
    effective_strides,
    mean_over_strides,
    stride_correlation,
    stride_curves,
    strides_of_phase,
)

PHASE = np.arange(101) / 100


def autoregressive_strides(count, rho, seed, columns=1):
    """Curves of four random harmonics whose sizes carry over from stride to stride; their true mean is zero."""
    rng = np.random.default_rng(seed)
    size = rng.standard_normal((count + 40, 4, columns))
    for k in range(1, len(size)):
        size[k] += rho * size[k - 1]
    waves = np.cos(2 * np.pi * np.arange(1, 5)[:, None] * PHASE + np.arange(4)[:, None])
    return np.einsum("skc,kp->spc", size[40:], waves)


@settings(max_examples=50)
@given(st.lists(st.floats(0.5, 1.6), min_size=3, max_size=12), st.floats(-0.4, 0.4), st.integers(0, 12))
def test_strides_are_recovered_from_percent_stride(durations, first, missing):
    contacts = first + np.concatenate([[0.0], np.cumsum(durations)])
    kept = np.arange(len(durations)) != missing
    walked = Strides(contacts[:-1][kept], contacts[1:][kept], "r", "force")
    time = np.arange(0, contacts[-1] - 0.1, 0.01)
    found = strides_of_phase(time, walked.phi(time))
    whole = walked.between(time[0], time[-1])
    assert abs(len(found) - len(whole)) <= 1  # a contact that falls on the first sample
    for start, end in zip(found.start, found.end, strict=True):
        assert np.min(np.abs(walked.start - start) + np.abs(walked.end - end)) < 1e-8


def test_no_phase_no_strides():
    assert len(strides_of_phase(np.arange(5.0), np.full(5, np.nan))) == 0


def test_a_missing_sample_is_missing_in_the_curve_and_nowhere_else():
    time = np.arange(0, 3, 0.01)
    walked = Strides(np.array([0.0, 1.0]), np.array([1.0, 2.0]), "r", "force")
    values = np.sin(2 * np.pi * time)[:, None]
    values[150] = np.nan
    curves = stride_curves(time, values, walked)
    np.testing.assert_allclose(curves[0, :, 0], np.sin(2 * np.pi * PHASE), atol=1e-9)
    assert np.flatnonzero(np.isnan(curves[1, :, 0])).tolist() == [50]


def test_amplitude_of_a_known_pattern():
    noise = np.random.default_rng(0).normal(0, 1, (400, 1, 1))
    pattern = 3 * np.sin(2 * np.pi * PHASE)[None, :, None]
    found = mean_over_strides(pattern + noise - noise.mean())
    assert found.rms[0] == pytest.approx(3 / np.sqrt(2), rel=0.01)
    assert found.peak_to_peak[0] == pytest.approx(6.0, rel=1e-3)
    np.testing.assert_allclose(found.mean[:, 0], pattern[0, :, 0], atol=1e-9)


@pytest.mark.parametrize("rho", [0.0, 0.3, 0.6])
def test_the_interval_holds_the_true_mean_as_often_as_it_says(rho):
    held = [
        np.mean((found.low < 0) & (found.high > 0))
        for seed in range(60)
        for found in [mean_over_strides(autoregressive_strides(28, rho, seed, columns=5))]
    ]
    assert np.mean(held) == pytest.approx(0.95, abs=0.03)


def test_effective_strides_of_known_correlation():
    for rho in (0.0, 0.5, 0.8):
        worth = effective_strides(autoregressive_strides(4000, rho, 1, columns=3))
        np.testing.assert_allclose(worth / 4000, (1 - rho) / (1 + rho), rtol=0.1)
    assert effective_strides(np.ones((30, 101, 1)) * np.array([1.0, -1.0] * 15)[:, None, None])[0] == 30


def test_points_with_too_few_strides_have_no_mean():
    curves = np.random.default_rng(0).normal(size=(8, 101, 2))
    curves[:4, 10, 0] = np.nan
    curves[:, :, 1] = np.nan
    found = mean_over_strides(curves)
    assert np.flatnonzero(np.isnan(found.mean[:, 0])).tolist() == [10]
    assert found.strides[10].tolist() == [4, 0]
    assert np.isfinite(found.rms[0])
    assert np.isnan(found.rms[1])
    assert np.isnan(found.peak_to_peak[1])


def test_too_few_strides():
    with pytest.raises(StrideError, match=r"5 complete strides.*4"):
        mean_over_strides(np.zeros((4, 101, 1)))


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
