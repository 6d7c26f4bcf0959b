import numpy as np
import pytest
from chapter3.augmented_run import learned_rate, learned_term
from chapter3.methods import OF_TIME, MethodSettings, fitted
from chapter3.record import error_samples


@pytest.mark.parametrize("method", ["sindy", "gp", "gpm", "nn", "dmd", "bopdmd"])
def test_compiled_code_gives_the_numbers_of_the_model(quiet, method):
    samples = error_samples(quiet, "dynamics", of_time=method in OF_TIME)
    settings = MethodSettings(nodes=4, bags=2 if method == "bopdmd" else 0)
    model = fitted(samples, method, settings)
    points = samples.x[::300]
    term = learned_term(model, points[:, 0])
    found = np.empty((len(points), 2))
    for place, point in enumerate(points):
        learned_rate(term.kind, term.tables, place, np.resize(point, 2), found[place])
    assert np.allclose(found, model(points), atol=1e-5 * np.abs(samples.y).max())
