from __future__ import annotations

import numpy as np

from gaitdisc.recording import Samples
from gaitdisc.response.fit_response import Fit, fit_linear, fit_models, fit_network


class Offset:
    """Predicts the mean of what it was fitted to."""

    def __init__(self, samples):
        self.inputs, self.outputs, self.mean = samples.inputs, samples.outputs, samples.y.mean(axis=0)

    def __call__(self, x):
        return np.tile(self.mean, (len(x), 1))


def samples(mean, seed=0):
    rng = np.random.default_rng(seed)
    time = np.arange(400) / 100
    return Samples(rng.normal(size=(400, 1)), mean + rng.normal(size=(400, 1)), ("a",), ("b",), time, time)


def test_the_discrepancy_model_learns_what_the_nominal_model_misses_of_device_walking():
    told = []

    def fit(part, progress):
        progress(1.0)
        return Fit(Offset(part), 0.0, 0, len(part), 0, 0.0)

    nominal, exo = samples(10.0), samples(17.0, seed=1)
    models = fit_models(nominal, exo, fit, told.append)
    x = np.zeros((3, 1))
    missing = exo.y.mean() - nominal.y.mean()
    np.testing.assert_allclose(models.discrepancy.model(x), missing)
    np.testing.assert_allclose(models.augmented(x), models.exo.model(x))
    assert list(models.on_exo()) == ["nominal", "augmented", "exo"]
    np.testing.assert_allclose(told, [1 / 3, 2 / 3, 1])


def test_both_kinds_say_how_they_were_fitted():
    for fit in (fit_linear(samples(3.0)), fit_network(samples(3.0))):
        assert (fit.n_training, fit.n_inner) == (400, 60)
        assert fit.seconds > 0
