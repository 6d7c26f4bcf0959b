"""Gaussian processes, their kernels, and networks trained by Bayes' rule."""

import numpy as np
import pytest
from chapter3.bayesian_training import _drawn, _outputs, train_bayesian
from chapter3.gaussian_process import FORGOTTEN, KERNELS, far_apart, fit_gaussian_process, kernel
from scipy.optimize import approx_fprime
from sklearn.gaussian_process.kernels import RBF, Matern

from gaitdisc.errors import TrainingError
from gaitdisc.recording import Samples
from gaitdisc.recording.arrays import autocorrelation_time

RNG = np.random.default_rng(0)
X = RNG.uniform(-2, 2, (700, 2))
Y = np.column_stack([np.sin(X[:, 0]) * X[:, 1], 5 + X[:, 1] ** 2])


def samples(y, x=X):
    time = np.arange(len(y)) / 100
    return Samples(x[: len(y)], y, ("a", "b")[: x.shape[1]], ("p", "q")[: y.shape[1]], time, np.full(len(y), np.nan))


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
    with pytest.raises(TrainingError, match="must have at least 20 samples"):
        fit_gaussian_process(samples(Y[:10]))


def test_points_far_apart_cover_a_line():
    line = np.linspace(0, 1, 101)[:, None]
    assert np.diff(np.sort(line[far_apart(line, 5)].ravel())).max() <= 0.26


@pytest.mark.parametrize("kind", KERNELS)
def test_the_standard_deviation_is_that_of_the_textbook(kind):
    line = np.linspace(-3, 3, 60)
    y = np.sin(line) + 0.1 * np.random.default_rng(2).standard_normal(60)
    found = fit_gaussian_process(samples(y[:, None], line[:, None]), kind=kind, variance=True)
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
        found = fit_gaussian_process(samples(y, x), variance=True)
        inside.append(np.abs(found(new) - truth(new)) < 1.96 * found.sd(new))
    assert np.mean(inside) == pytest.approx(0.95, abs=0.05)


def test_a_variance_that_was_not_kept_is_refused():
    with pytest.raises(TrainingError, match="was fitted without"):
        fit_gaussian_process(samples(Y)).sd(X)


def test_an_interval_of_noise_that_remembers_is_as_wide_as_of_so_many_samples_fewer():
    t = np.arange(2000) / 100
    slow = np.convolve(np.random.default_rng(3).standard_normal(2009), np.ones(10) / np.sqrt(10), "valid")
    y = (np.sin(t) + 0.2 * slow)[:, None]
    few, all_ = (fit_gaussian_process(samples(y[::n], t[::n, None]), variance=True) for n in (10, 1))
    new = np.linspace(2, 18, 30)[:, None]
    assert np.median(all_.sd(new)) == pytest.approx(np.median(few.sd(new)), rel=0.35)


PEERS = {
    "squared_exponential": RBF,
    "matern_3_2": lambda lengths: Matern(lengths, nu=1.5),
    "matern_5_2": lambda lengths: Matern(lengths, nu=2.5),
}


@pytest.mark.parametrize("kind", KERNELS)
def test_every_kernel_is_that_of_scikit_learn(kind):
    rng = np.random.default_rng(0)
    a, b, lengths = rng.normal(size=(7, 3)), rng.normal(size=(5, 3)), np.array([0.5, 1.0, 3.0])
    assert kernel(kind, a, b, lengths) == pytest.approx(PEERS[kind](lengths)(a, b), abs=1e-12)


@pytest.mark.parametrize("kind", KERNELS)
def test_every_kernel_is_positive(kind):
    x = np.random.default_rng(1).normal(size=(40, 2))
    assert np.linalg.eigvalsh(kernel(kind, x, x, np.ones(2))).min() > -1e-12


def surface(noise=0.0, count=1500, seed=0):
    random = np.random.default_rng(seed)
    x = random.uniform(-2, 2, (count, 2)) * [1.0, 30.0]
    truth = 5.0 + 3 * np.sin(x[:, 0]) * np.cos(x[:, 1] / 30)
    y = truth + noise * truth.std() * random.standard_normal(count)
    return samples(y[:, None], x), truth


def test_slopes_are_the_derivatives_of_the_output():
    x, weights = np.array([[0.3, -1.2]]), _drawn(2, 3, 0)
    by_differences = approx_fprime(weights, lambda w: _outputs(w, x)[0][0], 1e-7)
    assert _outputs(weights, x)[1][0] == pytest.approx(by_differences, abs=1e-5)


def test_the_module_computes_what_was_descended_and_a_smooth_surface_is_learned():
    samples, truth = surface()
    off = train_bayesian(samples)(samples.x)[:, 0] - truth
    assert off.std() < 2e-3 * truth.std()
    assert abs(off.mean()) < 1e-3 * truth.std()


def test_of_noise_little_more_is_learned_than_the_weights_that_it_determines():
    samples, truth = surface(noise=0.3)
    network = train_bayesian(samples)
    off = network(samples.x)[:, 0] - truth
    fresh, other = surface(seed=1)
    assert off.std() < 0.3 * np.sqrt(60 / 1500) * truth.std() * 1.5
    assert (network(fresh.x)[:, 0] - other).std() < 0.15 * truth.std()


def test_nothing_but_noise_is_its_mean():
    samples, _ = surface()
    noise = samples.with_outputs(7 + np.random.default_rng(2).standard_normal((len(samples), 1)))
    assert train_bayesian(noise)(samples.x)[:, 0].std() < 0.15


def test_a_seed_decides_everything():
    samples, _ = surface(noise=0.1, count=200)
    one, again, other = (train_bayesian(samples, 4, seed)(samples.x[:50]) for seed in (1, 1, 2))
    assert np.array_equal(one, again)
    assert not np.array_equal(one, other)


def test_too_few_samples_for_bayes_rule_are_refused():
    samples, _ = surface(count=49)
    with pytest.raises(TrainingError, match="49"):
        train_bayesian(samples)
