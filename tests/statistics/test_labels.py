"""Rows and columns of two tables that belong together, by their labels."""

import re

import numpy as np
import pandas as pd
import pytest

from gaitdisc.errors import ShapeError
from gaitdisc.statistics.labels import check_numbers, in_one_order

ONE = pd.Series([1.0, 2.0, 3.0], index=["a", "b", "c"])


def test_the_second_comes_in_the_order_of_the_first():
    assert in_one_order(ONE, ONE[::-1])[1].tolist() == [1.0, 2.0, 3.0]
    assert in_one_order(np.zeros(3), ONE[::-1])[1].tolist() == [3.0, 2.0, 1.0]  # an array has no labels


@pytest.mark.parametrize(
    ("index", "words"), [(list("abd"), "'c' is in one of them"), (list("abb"), "'c' is in one|'b' stands twice")]
)
def test_other_labels_and_doubled_ones_are_refused(index, words):
    with pytest.raises(ShapeError) as refusal:
        in_one_order(ONE, ONE.set_axis(index))
    assert re.search(words, refusal.value.found) and "participants" in refusal.value.needed


@pytest.mark.parametrize("column", [["a", "b"], [True, False]])
def test_words_and_flags_are_no_numbers(column):
    check_numbers(pd.DataFrame({"knee": [1, 2], "hip": [0.5, np.nan]}), "outputs")
    with pytest.raises(ShapeError) as refusal:
        check_numbers(pd.DataFrame({"knee": [1, 2], "who": column}), "outputs")
    assert "outputs" in refusal.value.needed and "'who'" in refusal.value.found
