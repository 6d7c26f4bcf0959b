import numpy as np
import pytest

from gaitdisc.errors import TrainingError
from gaitdisc.recording import Samples
from gaitdisc.regression.gaussian_process import far_apart, fit_gaussian_process

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


def test_the_noise_is_told():
    model = fit_gaussian_process(samples(Y + 0.2 * RNG.standard_normal(Y.shape)))
    assert model.noise == pytest.approx([0.2, 0.2], rel=0.2)


def test_too_few_samples_are_refused():
    with pytest.raises(TrainingError, match="needs 20 samples"):
        fit_gaussian_process(samples(Y[:10]))


def test_points_far_apart_cover_a_line():
    line = np.linspace(0, 1, 101)[:, None]
    assert np.diff(np.sort(line[far_apart(line, 5)].ravel())).max() <= 0.26
