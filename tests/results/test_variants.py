import pandas as pd
import pytest

from gaitdisc.errors import SchemaError
from gaitdisc.results.variants import VARIANT_COLUMNS, VARIANT_TEST_COLUMNS, VariantRun, Variants

TABLE = pd.DataFrame([("EMG", "knee_angle_r", "exo", "network", 0.9, 99)], columns=pd.Index(VARIANT_COLUMNS))


def test_a_table_without_a_column_is_refused():
    with pytest.raises(SchemaError, match=r"P01.*variant"):
        Variants("P01", "modalities", TABLE.drop(columns="variant"), {})


def test_a_question_is_one_of_two():
    with pytest.raises(SchemaError, match="is of the question 'why'"):
        Variants("P01", "why", TABLE, {})


def test_every_participant_is_in_the_table():
    people = tuple(Variants(name, "modalities", TABLE, {}) for name in ("P01", "P02"))
    empty = pd.DataFrame(columns=pd.Index(VARIANT_TEST_COLUMNS))
    run = VariantRun("study", "exo", "modalities", people, empty, (), (7.5, 7.5))
    assert run.r2_table()["participant"].tolist() == ["P01", "P02"]
    assert len(VariantRun("study", "exo", "modalities", (), empty, (), (0.0, 0.0)).r2_table()) == 0
