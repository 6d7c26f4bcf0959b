import pandas as pd
import pytest

from gaitdisc.errors import SchemaError
from gaitdisc.results import Refusal
from gaitdisc.results.variant_store import load_variant_run, load_variants, save_variant_run, save_variants
from gaitdisc.results.variants import VARIANT_COLUMNS, VARIANT_TEST_COLUMNS, VariantRun, Variants

TABLE = pd.DataFrame(
    [("EMG", "knee_angle_r", "exo", "network", 0.1 + 0.2, 99), ("EMG", "knee_angle_r", "exo", "ridge", -3.5, 99)],
    columns=pd.Index(VARIANT_COLUMNS),
)


def test_what_was_saved_is_loaded(tmp_path):
    save_variants(Variants("P01", "sensitivity", TABLE, {"angles 4 Hz": "too short"}), tmp_path / "P01", "key")
    found, key = load_variants(tmp_path / "P01")
    assert (found.participant, found.question, key) == ("P01", "sensitivity", "key")
    assert found.left_away == {"angles 4 Hz": "too short"}
    pd.testing.assert_frame_equal(found.table, TABLE)


def test_a_damaged_table_is_told(tmp_path):
    save_variants(Variants("P01", "modalities", TABLE, {}), tmp_path, "key")
    (tmp_path / "variants.csv").write_text("nothing")
    with pytest.raises(SchemaError, match="changed since it was saved"):
        load_variants(tmp_path)


def test_an_empty_folder_holds_none(tmp_path):
    with pytest.raises(SchemaError, match="missing"):
        load_variants(tmp_path)


def test_what_was_found_over_the_participants_is_loaded(tmp_path):
    person = Variants("P01", "modalities", TABLE, {})
    save_variants(person, tmp_path / "people" / "P01", "key")
    tests = pd.DataFrame(columns=pd.Index(VARIANT_TEST_COLUMNS))
    refusals = (Refusal("P02", "", "excluded in the study: ill"),)
    save_variant_run(VariantRun("two", "exo", "modalities", (person,), tests, refusals, (3.75, 7.5)), tmp_path)
    found = load_variant_run(tmp_path)
    assert (found.title, found.exo, found.question, found.held_out_s) == ("two", "exo", "modalities", (3.75, 7.5))
    assert found.refusals == refusals
    assert (len(found.tests), tuple(found.tests.columns)) == (0, VARIANT_TEST_COLUMNS)
    assert found.r2_table()["participant"].tolist() == ["P01", "P01"]
