import numpy as np
import pytest
from chapter3.gaussian_process import FORGOTTEN, KERNELS, far_apart, fit_gaussian_process, kernel

from gaitdisc.errors import TrainingError
from gaitdisc.recording import Samples
from gaitdisc.recording.autocorrelation import autocorrelation_time

RNG = np.random.default_rng(0)
X = RNG.uniform(-2, 2, (700, 2))
Y = np.column_stack([np.sin(X[:, 0]) * X[:, 1], 5 + X[:, 1] ** 2])


def samples(y):
    time = np.arange(len(y)) / 100
    return Samples(X[: len(y)], y, ("a", "b"), ("p", "q"), time, np.full(len(y), np.nan))


@pytest.mark.parametrize("most_exact", [700, 100])
def test_a_smooth_map_is_learned_exactly_or_on_inducing_points(most_exact):
    model = fit_gaussian_process(samples(Y), most_exact, inducing=120)
    new = RNG.uniform(-1.8, 1.8, (50, 2))
    wanted = np.column_stack([np.sin(new[:, 0]) * new[:, 1], 5 + new[:, 1] ** 2])
    assert model.exact == (most_exact == 700)
    assert np.abs(model(new) - wanted).max() < 1e-2


def test_the_noise_is_estimated():
    model = fit_gaussian_process(samples(Y + 0.2 * RNG.standard_normal(Y.shape)))
    assert model.noise == pytest.approx([0.2, 0.2], rel=0.2)


def test_too_few_samples_are_refused():
    with pytest.raises(TrainingError, match="needs 20 samples"):
        fit_gaussian_process(samples(Y[:10]))


def test_points_far_apart_cover_a_line():
    line = np.linspace(0, 1, 101)[:, None]
    assert np.diff(np.sort(line[far_apart(line, 5)].ravel())).max() <= 0.26


@pytest.mark.parametrize("kind", KERNELS)
def test_the_standard_deviation_is_that_of_the_textbook(kind):
    line = np.linspace(-3, 3, 60)
    y = np.sin(line) + 0.1 * np.random.default_rng(2).standard_normal(60)
    found = fit_gaussian_process(
        Samples(line[:, None], y[:, None], ("a",), ("b",), line, np.full(60, np.nan)), kind=kind, variance=True
    )
    new = np.linspace(-4, 4, 9)[:, None]
    size, noise, lengths = found.size[0] ** 2, found.noise[0] ** 2, found.lengths[0]
    noise *= autocorrelation_time(y[:, None] - found(line[:, None]), FORGOTTEN)[0]
    scaled, there = found.scale.scaled(new), found.centres
    among = size * kernel(kind, there, there, lengths) + noise * np.eye(60)
    across = size * kernel(kind, scaled, there, lengths)
    wanted = size - np.sum(across * np.linalg.solve(among, across.T).T, axis=1)  # Eq. 2.26
    assert found.sd(new)[:, 0] == pytest.approx(np.sqrt(wanted), rel=1e-3)


def test_inducing_points_tell_nearly_the_standard_deviation_of_all_samples():
    new = np.random.default_rng(5).uniform(-3, 3, (40, 2))
    noisy = samples(Y + 0.2 * np.random.default_rng(4).standard_normal(Y.shape))
    whole, projected = (fit_gaussian_process(noisy, most, 200, variance=True).sd(new)[:, 0] for most in (700, 100))
    assert projected == pytest.approx(whole, rel=0.1)


def test_ninety_five_of_a_hundred_values_lie_within_two_standard_deviations():
    def truth(x):
        return np.sin(2 * x[:, :1]) * np.cos(x[:, 1:])

    inside = []
    for seed in range(6):
        rng = np.random.default_rng(seed)
        x, new = rng.uniform(-2, 2, (2, 300, 2))
        y = truth(x) + 0.3 * rng.standard_normal((300, 1))
        found = fit_gaussian_process(
            Samples(x, y, ("a", "b"), ("p",), np.arange(300) / 100, np.full(300, np.nan)), variance=True
        )
        inside.append(np.abs(found(new) - truth(new)) < 1.96 * found.sd(new))
    assert np.mean(inside) == pytest.approx(0.95, abs=0.05)


def test_a_variance_that_was_not_kept_is_refused():
    with pytest.raises(TrainingError, match="was fitted without"):
        fit_gaussian_process(samples(Y)).sd(X)


def test_an_interval_of_noise_that_remembers_is_as_wide_as_of_so_many_samples_fewer():
    t = np.arange(2000) / 100
    slow = np.convolve(np.random.default_rng(3).standard_normal(2009), np.ones(10) / np.sqrt(10), "valid")
    few, all_ = (
        fit_gaussian_process(
            Samples(at[:, None], y[:, None], ("t",), ("b",), at, np.full(len(at), np.nan)), variance=True
        )
        for at, y in ((t[::10], (np.sin(t) + 0.2 * slow)[::10]), (t, np.sin(t) + 0.2 * slow))
    )
    new = np.linspace(2, 18, 30)[:, None]
    assert np.median(all_.sd(new)) == pytest.approx(np.median(few.sd(new)), rel=0.35)
