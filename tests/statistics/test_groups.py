"""R2, tables that belong together by their labels, and groups of people."""

import re

import numpy as np
import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st
from sklearn.metrics import adjusted_rand_score, r2_score
from texts import says

from gaitdisc.errors import ComparisonError, ShapeError
from gaitdisc.statistics.groups import best_cut, find_groups
from gaitdisc.statistics.r2 import r2, why_no_r2
from gaitdisc.statistics.signed_rank import check_numbers, in_one_order


def groups_of(sizes, apart, features=5, seed=0):
    rng = np.random.default_rng(seed)
    centres = apart * rng.standard_normal((len(sizes), features))
    return np.concatenate([c + rng.standard_normal((n, features)) for c, n in zip(centres, sizes, strict=True)])


@pytest.mark.parametrize("sizes", [(6, 6), (8, 4), (4, 4, 4)])
def test_groups_that_are_there_are_found(sizes):
    found = find_groups(groups_of(sizes, 15.0), clouds=39)
    assert found.count == len(sizes)
    truth = np.repeat(np.arange(len(sizes)), sizes)
    assert adjusted_rand_score(found.labels, truth) == 1.0
    assert found.p < 0.05 and found.stability > 0.9
    assert found.why.startswith(f"Sub-groups: {len(sizes)} groups separate")


def test_one_cloud_has_none_and_says_so():
    found = find_groups(np.random.default_rng(1).standard_normal((12, 40)))
    assert (found.count, found.labels.tolist()) == (0, [0] * 12)
    assert found.why.startswith("No sub-groups: ")
    assert "by chance" in found.why


def test_a_long_cloud_is_no_pair_of_groups():
    rng = np.random.default_rng(2)
    long = rng.standard_normal((12, 6)) * [20.0, 1, 1, 1, 1, 1]
    assert best_cut(long)[1] > 0.4  # it looks parted
    assert find_groups(long, clouds=39).count == 0


@pytest.mark.slow
def test_false_sub_groups_are_rare():
    seen = [find_groups(np.random.default_rng(i).standard_normal((12, 8)), clouds=99, seed=i).count for i in range(200)]
    assert np.mean(np.array(seen) > 0) <= 0.05 + 3 * np.sqrt(0.05 * 0.95 / 200)


def test_a_cut_has_the_silhouette_of_its_groups_computed_by_hand():
    x = np.array([0.0, 2.0, 10.0, 14.0])
    hand = [(12 - 2) / 12, (10 - 2) / 10, (9 - 4) / 9, (13 - 4) / 13]
    labels, value = best_cut(x[:, None])
    assert labels.tolist() == [1, 1, 2, 2] and value == pytest.approx(np.mean(hand))


@given(st.permutations(range(9)))
def test_the_order_of_participants_does_not_matter(order):
    features = groups_of((5, 4), 8.0)
    labels, value = best_cut(features)
    again, same = best_cut(features[order])
    assert adjusted_rand_score(labels[order], again) == pytest.approx(1.0)
    assert value == pytest.approx(same)


def test_missing_numbers_and_too_few_are_refused():
    with pytest.raises(ComparisonError, match="1 values missing"):
        find_groups(np.where(np.arange(12).reshape(6, 2) == 3, np.nan, 1.0))
    with pytest.raises(ComparisonError, match=r"6 participants.*\(5, 2\)"):
        find_groups(np.ones((5, 2)))


def test_participants_who_are_all_alike_have_none():
    found = find_groups(np.ones((8, 3)), clouds=19)
    assert (found.count, found.p) == (0, 1.0) and found.why.startswith("No sub-groups: ")


ONE = pd.Series([1.0, 2.0, 3.0], index=["a", "b", "c"])


def test_the_second_comes_in_the_order_of_the_first():
    assert in_one_order(ONE, ONE[::-1])[1].tolist() == [1.0, 2.0, 3.0]
    assert in_one_order(np.zeros(3), ONE[::-1])[1].tolist() == [3.0, 2.0, 1.0]  # an array has no labels


@pytest.mark.parametrize(
    ("index", "words"), [(list("abd"), "'c' is in only one"), (list("abb"), "'c' is in only one|'b' occurs twice")]
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


@given(st.integers(0, 999), st.floats(1e-6, 1e6), st.floats(-1e6, 1e6))
def test_it_is_scikit_learns_and_does_not_depend_on_the_unit(seed, unit, offset):
    rng = np.random.default_rng(seed)
    y, f = rng.normal(size=(2, 30, 3))
    np.testing.assert_allclose(r2(y, f), r2_score(y, f, multioutput="raw_values"))
    if unit > 1e-3 * abs(offset):
        np.testing.assert_allclose(r2(unit * y + offset, unit * f + offset), r2(y, f), rtol=1e-6)


def test_perfect_mean_and_worse_than_the_mean():
    y = np.arange(5.0)[:, None] * np.ones(3)
    f = np.column_stack([y[:, 0], np.full(5, 2.0), y[::-1, 0]])
    np.testing.assert_allclose(r2(y, f), [1.0, 0.0, -3.0])


def test_the_mean_is_that_of_the_held_out_part_itself():
    """A prediction by another mean, 3 beside a spread of 1, is judged by what it misses: 1 - (1 + 9) / 1."""
    y = np.array([[-1.0], [1.0]])
    assert r2(y, np.full((2, 1), 3.0))[0] == pytest.approx(-9.0)


def test_it_is_nan_with_a_reason_where_it_means_nothing():
    y = np.column_stack([np.full(4, 0.3), np.arange(4.0), np.full(4, 1e5) + 1e-6 * np.arange(4), np.arange(4.0)])
    f = y.copy()
    f[2, 1] = np.nan
    assert np.isnan(r2(y, f)).tolist() == [True, True, True, False]
    constant, missing, rounding, fine = why_no_r2(y, f)
    assert says(constant, "0.3", "4 samples")
    assert says(missing, "1 of 4 samples")
    assert says(rounding, "the measured values", "100000")
    assert fine == ""
    assert why_no_r2(y[:1], f[:1])[0] == "too few samples (n = 1)"
    assert np.isnan(r2(y[:0], f[:0])).all()


def test_shapes():
    with pytest.raises(ShapeError, match=r"shape \(sample, column\).*\(4, 1\).*\(4, 2\)"):
        r2(np.zeros((4, 1)), np.zeros((4, 2)))
