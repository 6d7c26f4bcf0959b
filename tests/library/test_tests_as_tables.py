"""Tests as tables: of pairs, column by column, and of curves over the stride."""

import numpy as np
import pandas as pd
import pytest

import gaitdisc as gd
from gaitdisc.errors import ComparisonError, ShapeError

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
    with pytest.raises(ShapeError, match=r"\(12, 101, 2\).*\(11, 101, 2\)"):
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
        (pd.DataFrame(NOISE[0][:, :, 0]).assign(participant=range(12)), "column 'participant' is not a number"),
        (pd.DataFrame(NOISE[0][:, :, 0]).assign(participant="P01"), "column 'participant'"),
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


PEOPLE = [f"P{k:02}" for k in range(1, 12)]
RISE = np.array([5.0, 6, 7, 8, 9, 10, 11, 1, -2, -3, -4]) / 100
BEFORE = pd.DataFrame(0.0, index=PEOPLE, columns=["knee", "ankle"])
AFTER = BEFORE.assign(knee=RISE, ankle=np.arange(1.0, 12.0))


def test_every_column_is_tested_and_corrected_over_all():
    found = gd.paired_tests(BEFORE, AFTER).set_index("variable")
    knee = gd.signed_rank(np.zeros(11), RISE)
    assert found.loc["knee", ["w", "p", "shift"]].tolist() == [knee.w, knee.p, knee.shift]
    assert found.loc["ankle", "p"] == pytest.approx(2 / 2**11)
    np.testing.assert_allclose(found["p_adjusted"], gd.holm_sidak(found["p"]).adjusted)


def test_participants_are_paired_by_name_and_who_misses_a_number_is_named():
    turned = AFTER.iloc[::-1][["ankle", "knee"]]
    pd.testing.assert_frame_equal(gd.paired_tests(BEFORE, turned), gd.paired_tests(BEFORE, AFTER))
    found = gd.paired_tests(BEFORE, AFTER.assign(knee=AFTER["knee"].where(AFTER.index != "P03"))).set_index("variable")
    assert found.loc["knee", "n"] == 10 and found.loc["knee", "left_out"] == "not computed: P03"


def test_tables_of_others_are_refused():
    with pytest.raises(ShapeError, match=r"same participants,.*'P11'"):
        gd.paired_tests(BEFORE, AFTER.iloc[:10])
    with pytest.raises(ShapeError, match=r"same variables,.*'hip'"):
        gd.paired_tests(BEFORE, AFTER.assign(hip=0.0))
    twice = BEFORE.rename({"P02": "P01"})
    with pytest.raises(ShapeError, match="'P01' occurs twice"):
        gd.paired_tests(twice, twice)


def test_what_is_no_table_of_numbers_is_refused_in_words():
    named = BEFORE.rename_axis("participant").reset_index()
    with pytest.raises(ShapeError, match=r"column 'participant'.*set_index"):
        gd.paired_tests(named, named)
    for given in (BEFORE["knee"], BEFORE.to_numpy()):
        with pytest.raises(ShapeError, match=f"two DataFrames.*found {type(given).__name__}"):
            gd.paired_tests(given, given)


def test_a_level_in_percent_is_refused():
    with pytest.raises(ComparisonError, match=r"alpha.*found 5"):
        gd.paired_tests(BEFORE, AFTER, alpha=5)
    with pytest.raises(ComparisonError, match=r"level.*found 95"):
        gd.signed_rank(np.zeros(11), RISE, level=95)


def test_two_columns_are_paired_by_their_index():
    assert gd.signed_rank(BEFORE["knee"], AFTER["knee"].iloc[::-1]) == gd.signed_rank(BEFORE["knee"], AFTER["knee"])
    uneven = pd.Series(np.arange(11.0), index=PEOPLE)
    assert gd.signed_rank(uneven, (uneven + RISE).iloc[::-1]).p == pytest.approx(gd.signed_rank(np.zeros(11), RISE).p)
    with pytest.raises(ShapeError, match="same participants"):
        gd.signed_rank(uneven, uneven.set_axis(range(11)))
