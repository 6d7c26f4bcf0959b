import pytest

from gaitdisc.errors import SchemaError
from gaitdisc.results import OverParticipants
from gaitdisc.results.comparison_store import load_over, load_tests, save_over, save_tests
from gaitdisc.results.over_participants import TABLES, no_rows


@pytest.fixture
def over():
    tables = {name: no_rows(name) for name in TABLES}
    columns = list(TABLES["responders"])
    tables["responders"].loc[0, columns] = ["P01", 1, 2, 0.1 + 0.2, 0.005, 1.0]
    tables["baselines"].loc[0] = ["exo", "ridge", "network", "hip_flexion_r", *[0] * 15, 0.5, ""]
    return OverParticipants(**tables, lengths_said="", responders_said="Sub-groups: 2 (n = 12 participants)")


def test_paired_tests_come_back_to_the_last_digit(pair_tests, tmp_path):
    save_tests(pair_tests, tmp_path)
    again = load_tests(tmp_path)
    assert (again.participants, again.too_few) == (pair_tests.participants, pair_tests.too_few)
    assert again.tests.equals(pair_tests.tests)
    assert again.families.equals(pair_tests.families)


def test_comparisons_come_back_to_the_last_digit(over, tmp_path):
    save_over(over, tmp_path)
    again = load_over(tmp_path)
    assert again.responders_said == over.responders_said
    for name, table in over.tables().items():
        assert again.tables()[name].to_numpy().tolist() == table.to_numpy().tolist()
        assert list(again.tables()[name].columns) == list(table.columns)


def test_a_changed_table_is_told(over, tmp_path):
    save_over(over, tmp_path)
    (tmp_path / "baselines.csv").write_text("model\n")
    with pytest.raises(SchemaError, match=r"baselines\.csv is changed since it was saved"):
        load_over(tmp_path)
