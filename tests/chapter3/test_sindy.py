"""SINDy: its library, its threshold, its weak form."""

import sys
from math import comb

import numpy as np
import pytest
from chapter3.sindy import (
    chapter3_library,
    chosen_threshold,
    fit_sindy,
    fit_weak_sindy,
    in_axes,
    library,
    products,
    sizes_of,
    thresholded,
    written,
)
from hypothesis import given
from hypothesis import strategies as st

from gaitdisc.errors import TrainingError
from gaitdisc.recording import Samples

RNG = np.random.default_rng(0)


def samples(x, y):
    time = np.arange(len(x)) / 100
    return Samples(x, y, ("a", "b"), ("p", "q")[: y.shape[1]], time, np.full(len(x), np.nan))


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
    found = fit_sindy(samples(x, y), threshold=0.05)
    assert np.allclose(found.coefficients.T, whole.coef_, rtol=1e-9, atol=1e-12)


def test_products_of_powers():
    x = RNG.standard_normal((5, 3))
    powers = library(3, 3)
    assert len(powers) == 20
    row = powers.tolist().index([1, 0, 2])
    assert np.allclose(products(x, powers)[:, row], x[:, 0] * x[:, 2] ** 2)


X = RNG.normal(size=(400, 2))
POWERS = library(2, 2)
COLUMNS = products(X, POWERS)
PLANTED = np.array([[0.0], [2.0], [0.0], [0.0], [-1.0], [0.0]])
SAMPLES = samples(X, COLUMNS @ PLANTED)


def test_least_squares_in_the_axes_is_least_squares():
    rows = in_axes((COLUMNS, SAMPLES.y), POWERS, SAMPLES)
    assert rows[0].shape == (6, 6)
    assert np.linalg.lstsq(*rows, rcond=None)[0] == pytest.approx(PLANTED, abs=1e-12)


def test_small_coefficients_are_dropped_and_the_others_refitted():
    noisy = SAMPLES.y + 0.05 * RNG.standard_normal(SAMPLES.y.shape)
    found = thresholded(in_axes((COLUMNS, noisy), POWERS, SAMPLES), (1.0, 1.0), 0.1)
    assert (found != 0).ravel().tolist() == (PLANTED != 0).ravel().tolist()
    only = np.linalg.lstsq(COLUMNS[:, [1, 4]], noisy, rcond=None)[0]
    assert found[[1, 4]] == pytest.approx(only, rel=1e-9)


def test_the_chosen_threshold_keeps_what_an_inner_block_needs():
    noisy = SAMPLES.y + 0.05 * RNG.standard_normal(SAMPLES.y.shape)
    sizes = sizes_of(COLUMNS, noisy)
    before = in_axes((COLUMNS[:300], noisy[:300]), POWERS, SAMPLES)
    threshold = chosen_threshold(before, (COLUMNS[300:], noisy[300:]), sizes)
    assert ((thresholded(before, sizes, threshold) != 0) == (PLANTED != 0)).all()


def test_terms_that_are_one_on_the_samples_are_named():
    line = np.column_stack([X[:, 0], 2 * X[:, 0]])
    with pytest.raises(TrainingError, match=r"b = 2\*a.*400 samples"):
        in_axes((products(line, library(2, 1)), SAMPLES.y), library(2, 1), SAMPLES)


TIME = np.arange(3000) / 100
TRUE = np.column_stack([np.sin(TIME) + 0.5 * np.sin(2.3 * TIME), np.cos(TIME) + 1.15 * np.cos(2.3 * TIME)])
RATES = np.column_stack([TRUE[:, 1], -np.sin(TIME) - 2.645 * np.sin(2.3 * TIME)])
MISSING = -0.2 * TRUE[:, 0] ** 3


def of_oscillator(noise=0.0):
    """What a model knows of the rates of v, which lacks a cubic of x, at states with noise."""
    states = TRUE + noise * np.random.default_rng(1).standard_normal(TRUE.shape)
    known = np.column_stack([states[:, 1], RATES[:, 1] - MISSING])
    return Samples(states, known, ("x", "v"), ("x", "v"), TIME, np.full(len(TIME), np.nan))


def test_a_missing_term_is_found_without_a_derivative():
    assert fit_weak_sindy(of_oscillator()).terms("v") == {"x**3": pytest.approx(-0.2, rel=1e-3)}
    assert fit_weak_sindy(of_oscillator()).terms("x") == {}


def test_noise_a_hundred_times_the_missing_rate_leaves_the_term():
    noisy = of_oscillator(noise=0.1)  # a central difference of it has noise of 7, what is missing is 0.1
    assert fit_weak_sindy(noisy).terms("v")["x**3"] == pytest.approx(-0.2, rel=0.25)


def test_too_short_a_record_says_how_many_windows_it_holds():
    short = of_oscillator().rows(slice(0, 120))
    with pytest.raises(TrainingError, match=r"10 terms.*36 windows.*0.5 s.*120 samples.*12"):
        fit_weak_sindy(short)


@given(st.integers(1, 4), st.integers(0, 4))
def test_a_library_has_every_product_once(inputs, degree):
    powers = library(inputs, degree)
    assert len({tuple(row) for row in powers}) == len(powers) == comb(inputs + degree, degree)
    assert powers.sum(axis=1).max(initial=0) == degree


@given(st.lists(st.floats(-3, 3), min_size=2, max_size=2))
def test_a_written_term_is_the_column_that_it_names(values):
    x = np.array([values])
    for k, row in enumerate(library(2, 3)):
        assert np.isclose(
            eval(written(("a", "b"), row), {"a": values[0], "b": values[1]}), products(x, library(2, 3))[0, k]
        )


def test_what_is_missing_is_named_with_its_remedy(monkeypatch):
    monkeypatch.setitem(sys.modules, "pysindy", None)
    with pytest.raises(TrainingError, match=r"needs the library pysindy; .*gaitdisc\[chapter3\]"):
        chapter3_library("pysindy")
