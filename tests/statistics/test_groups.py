import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gaitdisc.errors import ComparisonError
from gaitdisc.statistics.groups import adjusted_rand, best_cut, find_groups, mean_silhouette


def groups_of(sizes, apart, features=5, seed=0):
    rng = np.random.default_rng(seed)
    centres = apart * rng.standard_normal((len(sizes), features))
    return np.concatenate([c + rng.standard_normal((n, features)) for c, n in zip(centres, sizes, strict=True)])


@pytest.mark.parametrize("sizes", [(6, 6), (8, 4), (4, 4, 4)])
def test_groups_that_are_there_are_found(sizes):
    found = find_groups(groups_of(sizes, 15.0))
    assert found.count == len(sizes)
    truth = np.repeat(np.arange(len(sizes)), sizes)
    assert adjusted_rand(found.labels, truth) == 1.0
    assert found.p < 0.05 and found.stability > 0.9
    assert found.why.startswith(f"Sub-groups: {len(sizes)} groups part")


def test_one_cloud_has_none_and_says_so():
    found = find_groups(np.random.default_rng(1).standard_normal((12, 40)))
    assert (found.count, found.labels.tolist()) == (0, [0] * 12)
    assert found.why.startswith("No sub-groups: ")
    assert "by chance" in found.why


def test_a_long_cloud_is_no_pair_of_groups():
    rng = np.random.default_rng(2)
    long = rng.standard_normal((12, 6)) * [20.0, 1, 1, 1, 1, 1]
    assert best_cut(long)[1] > 0.4  # it looks parted
    assert find_groups(long).count == 0


@pytest.mark.slow
def test_false_sub_groups_are_rare():
    seen = [find_groups(np.random.default_rng(i).standard_normal((12, 8)), clouds=99, seed=i).count for i in range(200)]
    assert np.mean(np.array(seen) > 0) <= 0.05 + 3 * np.sqrt(0.05 * 0.95 / 200)


def test_silhouette_by_hand():
    x = np.array([0.0, 2.0, 10.0, 14.0])
    hand = [(12 - 2) / 12, (10 - 2) / 10, (9 - 4) / 9, (13 - 4) / 13]
    assert mean_silhouette(np.abs(x[:, None] - x), np.array([1, 1, 2, 2])) == pytest.approx(np.mean(hand))


def test_adjusted_rand_by_hand():
    # table [[1, 1], [1, 2]]: together 1, rows 1 + 3, columns 1 + 3, of 10 pairs: (1 - 1.6) / (4 - 1.6)
    assert adjusted_rand(np.array([1, 1, 2, 2, 2]), np.array([1, 2, 1, 2, 2])) == pytest.approx(-0.25)


@given(st.permutations(range(9)))
def test_the_order_of_participants_does_not_matter(order):
    features = groups_of((5, 4), 8.0)
    labels, value = best_cut(features)
    again, same = best_cut(features[order])
    assert adjusted_rand(labels[order], again) == pytest.approx(1.0)
    assert value == pytest.approx(same)


def test_missing_numbers_and_too_few_are_refused():
    with pytest.raises(ComparisonError, match="1 of the numbers missing"):
        find_groups(np.where(np.arange(12).reshape(6, 2) == 3, np.nan, 1.0))
    with pytest.raises(ComparisonError, match=r"6 participants.*\(5, 2\)"):
        find_groups(np.ones((5, 2)))


def test_participants_who_are_all_alike_have_none():
    found = find_groups(np.ones((8, 3)), clouds=19)
    assert (found.count, found.p) == (0, 1.0) and found.why.startswith("No sub-groups: ")
