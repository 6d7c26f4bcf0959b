import numpy as np
import pytest

from gaitdisc.errors import ComparisonError
from gaitdisc.statistics.permutation import PermutationPlan, sign_flips


def test_few_units_have_every_sign_once():
    signs, exact = sign_flips(7, PermutationPlan())
    assert exact
    assert len({tuple(row) for row in signs}) == len(signs) == 2**6 - 1
    assert (signs[:, 0] == 1).all()
    assert set(np.unique(signs)) == {-1.0, 1.0}


def test_many_units_have_as_many_as_are_asked_for_and_the_same_for_a_seed():
    signs, exact = sign_flips(40, PermutationPlan(permutations=300, seed=3))
    assert (signs.shape, exact) == ((299, 40), False)
    np.testing.assert_array_equal(signs, sign_flips(40, PermutationPlan(permutations=300, seed=3))[0])
    assert abs(signs[:, 1:].mean()) < 0.05


def test_permutations_that_could_show_nothing_are_refused():
    with pytest.raises(ComparisonError, match=r"at level 0\.01 needs 100 permutations or more; there are 32"):
        sign_flips(6, PermutationPlan(alpha=0.01))
