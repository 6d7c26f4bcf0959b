import numpy as np
import pytest
from chapter3.methods import MethodSettings, fitted, fitted_by_output
from chapter3.record import error_samples
from chapter3.sindy import fit_sindy


def test_each_output_is_fitted_alone_and_they_stand_in_order(quiet):
    samples = error_samples(quiet, "dynamics")
    found = fitted_by_output(samples, lambda one: fit_sindy(one, threshold=0.005))
    assert (found.inputs, found.outputs) == (("x", "y"), ("x", "y"))
    assert [model.outputs for model in found.models] == [("x",), ("y",)]
    assert np.allclose(found(samples.x)[:, 1], -0.01 * samples.x[:, 0] ** 3, atol=1e-4)


def test_an_output_that_is_noise_does_not_change_the_network_of_another(quiet):
    samples = error_samples(quiet, "dynamics")
    loud = samples.with_outputs(samples.y + np.random.default_rng(0).standard_normal((len(samples), 1)) * [[1.0, 0.0]])
    settings = MethodSettings(nodes=4)
    one, other = (fitted(each, "nn", settings)(samples.x) for each in (samples, loud))
    assert other[:, 1] == pytest.approx(one[:, 1], abs=1e-12)
    assert not np.allclose(other[:, 0], one[:, 0])
