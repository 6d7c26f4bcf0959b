import numpy as np
import pytest

from gaitdisc.errors import TrainingError
from gaitdisc.recording import Samples
from gaitdisc.regression.sindy import fit_sindy, library, products

RNG = np.random.default_rng(0)


def samples(x, y):
    time = np.arange(len(x)) / 100
    return Samples(x, y, ("a", "b"), ("p", "q"), time, np.full(len(x), np.nan))


def test_the_terms_that_were_put_in_come_out():
    x = RNG.standard_normal((800, 2))
    y = np.column_stack([0.3 * x[:, 0] ** 2 * x[:, 1], 2.0 - 0.5 * x[:, 1]])
    model = fit_sindy(samples(x, y + 1e-3 * RNG.standard_normal(y.shape)))
    assert set(model.terms("p")) == {"a**2*b"}
    assert set(model.terms("q")) == {"1", "b"}
    assert model.terms("q")["b"] == pytest.approx(-0.5, abs=1e-3)
    assert np.allclose(model(x), y, atol=1e-2)


def test_bags_drop_what_only_some_draws_see():
    x = RNG.standard_normal((400, 2))
    y = np.column_stack([x[:, 0] ** 3, x[:, 1]]) + 0.05 * RNG.standard_normal((400, 2))
    assert set(fit_sindy(samples(x, y), threshold=0.2, bags=15).terms("p")) == {"a**3"}


def test_a_library_larger_than_the_data_says_by_how_much():
    x = RNG.standard_normal((30, 2))
    with pytest.raises(TrainingError, match=r"degree 9 in 2 inputs has 55 terms.*there are 30, 25 too few"):
        fit_sindy(samples(x, x), degree=9)


def test_a_library_that_could_not_be_held_is_refused_before_it_is_made():
    x = np.ones((60, 256))
    many = Samples(x, x, tuple(f"u{k}" for k in range(256)), tuple(f"u{k}" for k in range(256)), x[:, 0], x[:, 0])
    with pytest.raises(TrainingError, match="2862209 terms"):
        fit_sindy(many)


def test_products_of_powers():
    x = RNG.standard_normal((5, 3))
    powers = library(3, 3)
    assert len(powers) == 20
    row = powers.tolist().index([1, 0, 2])
    assert np.allclose(products(x, powers)[:, row], x[:, 0] * x[:, 2] ** 2)
