import pytest
from chapter3.methods import OF_TIME, MethodSettings, fitted
from chapter3.record import error_samples


@pytest.mark.parametrize(
    "method", ["sindy", "esindy", "dmd", "exactdmd", pytest.param("bopdmd", marks=pytest.mark.slow), "gp", "gpm", "nn"]
)
def test_every_method_fits_the_same_error_signal(quiet, method):
    samples = error_samples(quiet, "dynamics", of_time=method in OF_TIME)
    model = fitted(samples, method, MethodSettings(nodes=5))
    assert model.outputs == ("x", "y")
    close = 0.2 if method == "exactdmd" else 0.1  # its modes are those of the map, not of the record
    assert (model(samples.x)[:, 1] - samples.y[:, 1]).std() < close * samples.y[:, 1].std()
