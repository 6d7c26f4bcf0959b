import numpy as np
import pytest
from chapter3.bayesian_training import _drawn, _outputs, train_bayesian
from scipy.optimize import approx_fprime

from gaitdisc.errors import TrainingError
from gaitdisc.recording import Samples


def surface(noise=0.0, count=1500, seed=0):
    random = np.random.default_rng(seed)
    x = random.uniform(-2, 2, (count, 2)) * [1.0, 30.0]
    truth = 5.0 + 3 * np.sin(x[:, 0]) * np.cos(x[:, 1] / 30)
    y = truth + noise * truth.std() * random.standard_normal(count)
    t = np.arange(count) / 100
    return Samples(x, y[:, None], ("a", "b"), ("c",), t, t), truth


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


def test_too_few_samples_are_refused():
    samples, _ = surface(count=49)
    with pytest.raises(TrainingError, match="49"):
        train_bayesian(samples)
