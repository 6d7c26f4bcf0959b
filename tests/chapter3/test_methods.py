"""Methods by one name, and each output by a model of its own."""

import numpy as np
import pytest
from chapter3.methods import OF_TIME, MethodSettings, fitted, fitted_by_output
from chapter3.record import error_samples
from chapter3.sindy import fit_sindy


@pytest.mark.parametrize(
    "method", ["sindy", "esindy", "dmd", "exactdmd", pytest.param("bopdmd", marks=pytest.mark.slow), "gp", "gpm", "nn"]
)
def test_every_method_fits_the_same_error_signal(quiet, method):
    samples = error_samples(quiet, "dynamics", of_time=method in OF_TIME)
    model = fitted(samples, method, MethodSettings(nodes=5))
    assert model.outputs == ("x", "y")
    close = 0.2 if method == "exactdmd" else 0.1  # its modes are those of the map, not of the record
    assert (model(samples.x)[:, 1] - samples.y[:, 1]).std() < close * samples.y[:, 1].std()


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
