import pandas as pd
import pytest

from gaitdisc.errors import SchemaError
from gaitdisc.results import PairTests
from gaitdisc.results.pair_test import FAMILY_COLUMNS, TEST_COLUMNS


def test_a_table_without_a_column_is_refused():
    whole = pd.DataFrame(columns=list(FAMILY_COLUMNS))
    with pytest.raises(SchemaError, match=r"in tests; tests lacks p_adjusted\. Compare the models again"):
        PairTests(8, 0.05, 0.95, "", pd.DataFrame(columns=[c for c in TEST_COLUMNS if c != "p_adjusted"]), whole)


def test_one_pair_of_models(pair_tests):
    assert pair_tests.of_pair("augmented", "exo")["variable"].tolist() == ["hip_flexion_r"]
    assert not len(pair_tests.of_pair("exo", "perfect"))
