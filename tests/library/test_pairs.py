"""Tests of pairs, a column of two tables each."""

import numpy as np
import pandas as pd
import pytest

import gaitdisc as gd
from gaitdisc.errors import ComparisonError, ShapeError

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
    with pytest.raises(ShapeError, match="the same participants, once each; 'P11' is in one of them"):
        gd.paired_tests(BEFORE, AFTER.iloc[:10])
    with pytest.raises(ShapeError, match="the same variables, once each; 'hip' is in one of them"):
        gd.paired_tests(BEFORE, AFTER.assign(hip=0.0))
    twice = BEFORE.rename({"P02": "P01"})
    with pytest.raises(ShapeError, match="'P01' stands twice"):
        gd.paired_tests(twice, twice)


def test_what_is_no_table_of_numbers_is_refused_in_words():
    named = BEFORE.rename_axis("participant").reset_index()
    with pytest.raises(ShapeError, match=r"column 'participant' holds others.*set_index"):
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
