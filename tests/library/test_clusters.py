"""Where over the stride curves differ, as a table."""

import numpy as np
import pandas as pd
import pytest

import gaitdisc as gd
from gaitdisc.errors import ShapeError

RNG = np.random.default_rng(0)
NOISE = [RNG.normal(0.0, 1.0, (12, 101, 2)) for _ in range(2)]
BUMP = np.zeros((101, 2))
BUMP[30:50, 1] = 4.0


@pytest.mark.parametrize("paired", [False, True])
def test_a_bump_in_one_channel_is_found_there_alone(paired):
    found = gd.permutation_clusters(
        NOISE[0] + BUMP, NOISE[1], paired=paired, channels=("hip", "knee"), permutations=500
    )
    assert found["channel"].tolist() == ["knee"] and found["sign"].tolist() == [1]
    assert (found["first_point"][0], found["last_point"][0]) == (30, 49)
    assert found["p"][0] < 0.05 and found.attrs["threshold"] > 2


def test_tables_of_one_channel_go_too_and_an_empty_answer_has_its_columns():
    one, other = (pd.DataFrame(noise[:, :, 0]) for noise in NOISE)
    found = gd.permutation_clusters(one, other, permutations=200)
    assert not len(found) and list(found) == ["channel", "first_point", "last_point", "sign", "mass", "p"]


def test_sets_that_do_not_fit_are_refused():
    with pytest.raises(ShapeError, match=r"as many rows in pairs; found \(12, 101, 2\) and \(11, 101, 2\)"):
        gd.permutation_clusters(NOISE[0], NOISE[1][:11], paired=True)
    with pytest.raises(ShapeError, match="with 1 names of channels"):
        gd.permutation_clusters(*NOISE, channels=("hip",))
