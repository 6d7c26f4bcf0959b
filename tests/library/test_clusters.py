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
        NOISE[0], NOISE[1] + BUMP, paired=paired, channels=("hip", "knee"), permutations=500
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


def test_pairs_of_two_tables_belong_together_by_their_index():
    one, other = (pd.DataFrame(noise[:, :, 0]).add(np.arange(12.0) * 3, axis=0) for noise in NOISE)
    found = gd.permutation_clusters(one, other, paired=True, permutations=200)
    turned = gd.permutation_clusters(one, other.iloc[::-1], paired=True, permutations=200)
    assert turned.attrs == found.attrs and turned.equals(found)


@pytest.mark.parametrize(
    ("curves", "words"),
    [
        (pd.DataFrame(NOISE[0][:, :, 0]).assign(participant=range(12)), "column 'participant' stands beside 101"),
        (pd.DataFrame(NOISE[0][:, :, 0]).assign(participant="P01"), "column 'participant' holds others"),
        (NOISE[0][:, :, 0].T, r"found \(101, 12\).*array.T"),
        (NOISE[0][0, :, 0], r"found \(101,\)"),
    ],
    ids=["number beside", "name beside", "on its side", "one curve"],
)
def test_what_is_no_set_of_curves_is_refused(curves, words):
    with pytest.raises(ShapeError, match=words):
        gd.permutation_clusters(curves, curves)


def test_one_channel_may_be_named_by_a_word():
    found = gd.permutation_clusters(
        NOISE[0][:, :, 1] + BUMP[:, 1], NOISE[1][:, :, 1], channels="knee", permutations=200
    )
    assert found["channel"].tolist() == ["knee"]
