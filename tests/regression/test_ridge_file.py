import numpy as np
import pytest

from gaitdisc.errors import SchemaError
from gaitdisc.recording import Samples
from gaitdisc.regression.fourier_ridge import fit_fourier_ridge
from gaitdisc.regression.ridge_file import load_ridge, save_ridge


@pytest.fixture
def model():
    x = np.random.default_rng(0).normal(size=(200, 2))
    t = np.arange(200) / 100
    s = Samples(x, x[:, :1] * x[:, 1:], ("a", "b"), ("c",), t, t)
    return fit_fourier_ridge(s.rows(slice(0, 150)), s.rows(slice(150, None)), features=30)


def test_what_is_loaded_equals_what_was_saved(model, tmp_path):
    save_ridge(model, tmp_path / "m.npz")
    kept, x = load_ridge(tmp_path / "m.npz"), np.random.default_rng(1).normal(size=(9, 2))
    np.testing.assert_array_equal(kept(x), model(x))
    assert (kept.inputs, kept.outputs, kept.penalty) == (model.inputs, model.outputs, model.penalty)


def test_a_damaged_or_missing_file(model, tmp_path):
    path = tmp_path / "m.npz"
    with pytest.raises(SchemaError, match=r"m\.npz is to be read as a ridge regression"):
        load_ridge(path)
    save_ridge(model, path)
    path.write_bytes(path.read_bytes()[:-200])
    with pytest.raises(SchemaError, match="Fit the model again"):
        load_ridge(path)
