import numpy as np
from chapter3.sindy import library, products, written
from hypothesis import given
from hypothesis import strategies as st


@given(st.integers(1, 4), st.integers(0, 4))
def test_a_library_has_every_product_once(inputs, degree):
    from math import comb

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
