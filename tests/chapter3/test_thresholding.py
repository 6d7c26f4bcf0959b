import numpy as np
import pytest
from chapter3.sindy import chosen_threshold, in_axes, library, products, sizes_of, thresholded

from gaitdisc.errors import TrainingError
from gaitdisc.recording import Samples

RNG = np.random.default_rng(0)
X = RNG.normal(size=(400, 2))
POWERS = library(2, 2)
COLUMNS = products(X, POWERS)
TRUE = np.array([[0.0], [2.0], [0.0], [0.0], [-1.0], [0.0]])
SAMPLES = Samples(X, COLUMNS @ TRUE, ("a", "b"), ("p",), np.arange(400) / 100, np.full(400, np.nan))


def test_least_squares_in_the_axes_is_least_squares():
    rows = in_axes((COLUMNS, SAMPLES.y), POWERS, SAMPLES)
    assert rows[0].shape == (6, 6)
    assert np.linalg.lstsq(*rows, rcond=None)[0] == pytest.approx(TRUE, abs=1e-12)


def test_small_coefficients_are_dropped_and_the_others_refitted():
    noisy = SAMPLES.y + 0.05 * RNG.standard_normal(SAMPLES.y.shape)
    found = thresholded(in_axes((COLUMNS, noisy), POWERS, SAMPLES), (1.0, 1.0), 0.1)
    assert (found != 0).ravel().tolist() == (TRUE != 0).ravel().tolist()
    only = np.linalg.lstsq(COLUMNS[:, [1, 4]], noisy, rcond=None)[0]
    assert found[[1, 4]] == pytest.approx(only, rel=1e-9)


def test_the_chosen_threshold_keeps_what_an_inner_block_needs():
    noisy = SAMPLES.y + 0.05 * RNG.standard_normal(SAMPLES.y.shape)
    sizes = sizes_of(COLUMNS, noisy)
    before = in_axes((COLUMNS[:300], noisy[:300]), POWERS, SAMPLES)
    threshold = chosen_threshold(before, (COLUMNS[300:], noisy[300:]), sizes)
    assert ((thresholded(before, sizes, threshold) != 0) == (TRUE != 0)).all()


def test_terms_that_are_one_on_the_samples_are_named():
    line = np.column_stack([X[:, 0], 2 * X[:, 0]])
    with pytest.raises(TrainingError, match=r"b = 2\*a.*400 samples"):
        in_axes((products(line, library(2, 1)), SAMPLES.y), library(2, 1), SAMPLES)
