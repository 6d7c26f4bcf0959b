from __future__ import annotations

import numpy as np
import pytest

from gaitdisc.clinic.reading import multiple_correlation


def test_a_coefficient_computed_by_hand():
    """0 2 4 and 1 3 5: within 1.5 / (3 * 1) = 0.5, about the grand mean 17.5 / 5 = 3.5, so the root of 6/7."""
    assert multiple_correlation(np.array([[0.0, 2.0, 4.0], [1.0, 3.0, 5.0]])) == pytest.approx(np.sqrt(6 / 7))


def test_equal_cycles_are_one_and_what_is_not_defined_is_not_a_number():
    curve = np.sin(np.linspace(0, 6, 101))
    assert multiple_correlation(np.tile(curve, (3, 1))) == pytest.approx(1.0)
    assert np.isnan(multiple_correlation(curve[None]))
    assert np.isnan(multiple_correlation(np.array([[0.0, 0.0, 0.1], [9.0, 9.0, 9.1]])))
    assert np.isnan(multiple_correlation(np.ones((3, 5))))
