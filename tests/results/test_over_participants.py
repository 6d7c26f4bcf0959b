import pandas as pd
import pytest

from gaitdisc.errors import SchemaError
from gaitdisc.results.over_participants import (
    FAMILY_COLUMNS,
    LENGTH_COLUMNS,
    TABLES,
    TEST_COLUMNS,
    WHOLE,
    OverParticipants,
    PairTests,
    no_rows,
)


def test_a_table_without_a_column_is_refused():
    whole = pd.DataFrame(columns=list(FAMILY_COLUMNS))
    with pytest.raises(SchemaError, match=r"p_adjusted\. Compare the models"):
        PairTests(8, 0.05, 0.95, "", pd.DataFrame(columns=[c for c in TEST_COLUMNS if c != "p_adjusted"]), whole)


def test_one_pair_of_models(pair_tests):
    assert pair_tests.of_pair("augmented", "exo")["variable"].tolist() == ["hip_flexion_r"]
    assert not len(pair_tests.of_pair("exo", "perfect"))


def over(lengths=None, **other):
    tables = {name: no_rows(name) for name in TABLES} | other
    tables |= {} if lengths is None else {"lengths": lengths}
    return OverParticipants(**tables, lengths_said="", responders_said="")


def lengths(different, second=WHOLE):
    rows = [{"length_s": length, "second": second, "different": d, "p": 0.5} for length, d in different.items()]
    return pd.DataFrame(rows).reindex(columns=list(LENGTH_COLUMNS))


def test_enough_is_the_shortest_length_after_the_last_that_differs():
    assert over(lengths({1.0: True, 30.0: False, 60.0: True, 90.0: False, 120.0: False})).enough_length() == 90.0


def test_nothing_is_enough_where_the_longest_still_differs():
    assert over(lengths({1.0: False, 60.0: True})).enough_length() is None
    assert over().enough_length("exo") is None


def test_each_comparison_has_its_own_length():
    both = pd.concat([lengths({1.0: True, 30.0: False}), lengths({1.0: False, 30.0: False}, "exo")])
    assert (over(both).enough_length(), over(both).enough_length("exo")) == (30.0, 1.0)


def test_a_missing_column_is_named():
    with pytest.raises(SchemaError, match="baselines lacks rank_biserial"):
        over(baselines=no_rows("baselines").drop(columns="rank_biserial"))
