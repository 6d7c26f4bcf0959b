import numpy as np
import pytest
from scipy.ndimage import gaussian_filter1d
from scipy.signal import lfilter

from gaitdisc.errors import SamplingError
from gaitdisc.reconstruction.state_errors import coverage, effective_number, half_widths


def test_independent_errors_are_covered_as_often_as_promised():
    rng = np.random.default_rng(0)
    found = [
        coverage(errors[200:], half_widths(errors[:200], 0.9))[0]
        for errors in (rng.standard_t(3, size=(1200, 1)) for _ in range(50))
    ]
    assert np.mean(found) == pytest.approx(0.9, abs=0.01)


def test_a_stretch_that_hangs_together_is_covered_too():
    rng = np.random.default_rng(1)
    ours, plain = [], []
    for _ in range(150):
        noise = gaussian_filter1d(rng.normal(size=(1400, 1)), 10.0, axis=0)
        check, test = noise[:400], noise[450:]
        ours.append(coverage(test, half_widths(check))[0])
        plain.append(coverage(test, np.sort(np.abs(check), axis=0)[int(np.ceil(401 * 0.9)) - 1])[0])
    assert np.mean(plain) < 0.885
    assert 0.89 < np.mean(ours) < 0.93  # on the side of caution


@pytest.mark.parametrize("pole", [0.0, 0.8, 0.95])
def test_the_worth_of_an_autoregressive_series(pole):
    noise = np.random.default_rng(0).normal(size=40_000)
    series = lfilter([1.0], [1.0, -pole], noise)
    rho = pole ** np.arange(1, 400)
    sizes = 2 / np.pi * (np.sqrt(1 - rho**2) + rho * np.arcsin(rho) - 1) / (1 - 2 / np.pi)  # of |x|, x normal
    assert effective_number(series[:, None])[0] == pytest.approx(40_000 / (1 + 2 * sizes.sum()), rel=0.15)


def test_a_constant_error_is_worth_one_per_window_and_never_more():
    assert effective_number(np.ones((50, 1)))[0] == 50.0


def test_too_few_windows():
    with pytest.raises(SamplingError, match=r"least 9.*8"):
        half_widths(np.zeros((8, 1)))
