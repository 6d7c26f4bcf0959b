import numpy as np
import pytest
from chapter3.sindy import fit_sindy, library, products

from gaitdisc.errors import TrainingError
from gaitdisc.recording import Samples

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
    with pytest.raises(TrainingError, match=r"degree 9.*55 terms.*30, 25"):
        fit_sindy(samples(x, x), degree=9)


def test_a_library_that_could_not_be_held_is_refused_before_it_is_made():
    x = np.ones((60, 256))
    many = Samples(x, x, tuple(f"u{k}" for k in range(256)), tuple(f"u{k}" for k in range(256)), x[:, 0], x[:, 0])
    with pytest.raises(TrainingError, match="2862209 terms"):
        fit_sindy(many)


T = np.arange(200) / 20


def of(x, y, inputs=("x", "y")):
    return Samples(x, y, inputs, ("v",), T, np.full(len(x), np.nan))


def test_terms_that_are_the_same_on_the_samples_are_refused_by_name():
    x = np.column_stack([np.sin(T), np.cos(2 * T)])  # cos 2t = 1 - 2 sin^2 t
    for threshold in (0.005, None):
        with pytest.raises(TrainingError, match=r"x\*\*2 = 0.5 -.*200 samples.*2 more"):
            fit_sindy(of(x, -0.01 * x[:, :1] ** 3), threshold=threshold)


@pytest.mark.parametrize(
    ("second", "relation"),
    [
        (np.cos(T), r"y\*\*2 = 1 - 1\*x\*\*2 in all"),
        (np.full(200, 3.0), r"y = 3 in all"),
        (np.zeros(200), r"y = 0 in all"),
        (2 * np.sin(T), r"y = 2\*x in all"),
    ],
)
def test_whichever_relation_holds_is_written_out(second, relation):
    x = np.column_stack([np.sin(T), second])
    with pytest.raises(TrainingError, match=relation):
        fit_sindy(of(x, x[:, :1]), threshold=0.005)


def test_an_angle_far_from_zero_is_no_collinear_library():
    x = np.column_stack([100.0 + np.sin(T), 90.0 + 3 * np.cos(np.sqrt(2) * T)])  # 1e-7 of its length apart
    found = fit_sindy(of(x, 0.3 * x[:, :1] * x[:, 1:]), threshold=1e-4)
    assert found.terms("v") == {"x*y": pytest.approx(0.3, rel=1e-6)}


def test_what_pysindy_finds_on_all_samples_is_what_comes_out():
    from pysindy import STLSQ

    x = RNG.standard_normal((300, 2))
    y = 0.3 * x[:, :1] ** 2 - 2.0 * x[:, 1:] + 0.1 * RNG.standard_normal((300, 1))
    powers = library(2, 3)
    whole = STLSQ(threshold=0.05, alpha=0.0, max_iter=10).fit(products(x, powers), y)
    found = fit_sindy(Samples(x, y, ("a", "b"), ("p",), np.arange(300.0), x[:, 0]), threshold=0.05)
    assert np.allclose(found.coefficients.T, whole.coef_, rtol=1e-9, atol=1e-12)


def test_products_of_powers():
    x = RNG.standard_normal((5, 3))
    powers = library(3, 3)
    assert len(powers) == 20
    row = powers.tolist().index([1, 0, 2])
    assert np.allclose(products(x, powers)[:, row], x[:, 0] * x[:, 2] ** 2)
