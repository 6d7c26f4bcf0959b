import re
from collections.abc import Mapping
from dataclasses import fields, is_dataclass

import numpy as np
import pandas as pd
import pytest
from driven_walker import DrivenWalker
from made_cycles import made_cycles

from gaitdisc.comparison.compare import compare_walks
from gaitdisc.comparison.mismatch import MISMATCH
from gaitdisc.errors import SchemaError
from gaitdisc.processing.pooled_cycles import CYCLES, WALK, cycles_name
from gaitdisc.processing.walk_pair import walk_pair
from gaitdisc.response.participant_response import QUANTITY, QUANTITY_COLUMNS, RESPONSE, DataQuantity
from gaitdisc.response.participants_result import OVER, TABLES, TESTS, OverParticipants, join_rows
from gaitdisc.response.variants import (
    VARIANT_COLUMNS,
    VARIANT_TEST_COLUMNS,
    VARIANTS,
    VariantRun,
    Variants,
    load_variant_run,
    save_variant_run,
)
from gaitdisc.run.run_study import REFUSED, Refused
from gaitdisc.saved.provenance import Refusal
from gaitdisc.saved.unit_folder import unit_name


def test_a_folder_name_has_no_characters_that_a_disk_refuses():
    assert re.fullmatch(r"P_1-10___up_hill-[0-9a-f]{8}", unit_name("P/1", "10 % up:hill"))


def test_no_two_walks_share_a_folder():
    """Conditions that differ in signs alone, and a hyphen in the pseudonym or in the condition."""
    walks = [("P01", "[exo]"), ("P01", "(exo)"), ("P01", "_exo_"), ("P01-a", "b"), ("P01", "a-b")]
    assert len({unit_name(*walk) for walk in walks}) == len(walks)


def test_no_two_sets_share_a_folder():
    names = [cycles_name("P01", *words) for words in (("", "a b"), ("a", "b"), ("", "a_b"), ("a b", "c"), ("a", "b c"))]
    assert len({*names}) == len(names)


def test_saving_twice_gives_the_same_bytes(response, tmp_path):
    for folder in ("a", "b"):
        RESPONSE.save(response, tmp_path / folder, "key")
    for file in ("response.json", "r2.csv", "fits.csv", "arrays.npz"):
        assert (tmp_path / "a" / file).read_bytes() == (tmp_path / "b" / file).read_bytes()


@pytest.fixture
def over():
    tables = {name: join_rows(name) for name in TABLES}
    columns = list(TABLES["responders"])
    tables["responders"].loc[0, columns] = ["P01", 1, 2, 0.1 + 0.2, 0.005, 1.0]
    tables["baselines"].loc[0] = ["exo", "ridge", "network", "hip_flexion_r", *[0] * 15, 0.5, ""]
    return OverParticipants(**tables, lengths_said="", responders_said="Sub-groups: 2 (n = 12 participants)")


TABLE = pd.DataFrame(
    [("EMG", "knee_angle_r", "exo", "network", 0.1 + 0.2, 99), ("EMG", "knee_angle_r", "exo", "ridge", -3.5, 99)],
    columns=pd.Index(VARIANT_COLUMNS),
)
QUANTITIES = TABLE.assign(length_s=1.5, n_training=100, walk="exo")[list(QUANTITY_COLUMNS)]


def test_what_was_found_over_the_participants_is_loaded(tmp_path):
    person = Variants("P01", "modalities", TABLE, {})
    VARIANTS.save(person, tmp_path / "people" / "P01", "key")
    tests = pd.DataFrame(columns=pd.Index(VARIANT_TEST_COLUMNS))
    refusals = (Refusal("P02", "", "excluded in the study: ill"),)
    save_variant_run(VariantRun("two", "exo", "modalities", (person,), tests, refusals, (3.75, 7.5)), tmp_path)
    found = load_variant_run(tmp_path)
    assert (found.title, found.exo, found.question, found.held_out_s) == ("two", "exo", "modalities", (3.75, 7.5))
    assert found.refusals == refusals
    assert (len(found.tests), tuple(found.tests.columns)) == (0, VARIANT_TEST_COLUMNS)
    assert found.r2_table()["participant"].tolist() == ["P01", "P01"]


@pytest.fixture(scope="module")
def mismatch():
    walks = [DrivenWalker("A", seed=1, spring_per_s2=k).walked(25.0, name) for k, name in ((250, "exo"), (0, "free"))]
    return compare_walks(*walk_pair(*walks))


@pytest.mark.parametrize(
    ("kind", "saved", "table"),
    [
        (CYCLES, lambda _: made_cycles(), "cycles"),
        (MISMATCH, lambda request: request.getfixturevalue("mismatch"), "regions"),
        (OVER, lambda request: request.getfixturevalue("over"), "baselines"),
        (VARIANTS, lambda _: Variants("P01", "modalities", TABLE, {}), "variants"),
    ],
)
def test_a_table_that_is_missing_or_was_changed_is_refused(request, tmp_path, kind, saved, table):
    with pytest.raises(SchemaError, match="missing"):
        kind.load(tmp_path)
    kind.save(saved(request), tmp_path)
    (tmp_path / f"{table}.csv").write_text("channel\n")
    with pytest.raises(SchemaError, match=rf"{table}\.csv.*changed since it was saved"):
        kind.load(tmp_path)


def assert_same(one, other, typed):
    """Every number to the last digit, in tables, arrays and nouns; typed: and of the same type in tables."""
    if isinstance(other, pd.DataFrame):
        kept = dict.fromkeys(("check_dtype", "check_index_type", "check_column_type"), typed)
        pd.testing.assert_frame_equal(one, other, check_exact=True, **kept)
    elif isinstance(other, np.ndarray):
        np.testing.assert_array_equal(one, other)
    elif isinstance(other, Mapping):
        assert [*one] == [*other]
        for name, value in other.items():
            assert_same(one[name], value, typed)
    elif is_dataclass(other) and type(other).__eq__ is object.__eq__:
        for each in fields(other):
            assert_same(getattr(one, each.name), getattr(other, each.name), typed)
    else:
        assert one == other


@pytest.mark.parametrize(
    ("kind", "made"),
    [
        (WALK, "walk"),
        (CYCLES, made_cycles()),
        (CYCLES, made_cycles(session="after", group="control", contact_offset_s=0.06)),
        (CYCLES, made_cycles(each=0, out=2)),
        (RESPONSE, "response"),
        (REFUSED, Refused((Refusal("P07", "exo", "gait changes at 38 s"),), ("nominal",))),
        (TESTS, "pair_tests"),
        (OVER, "over"),
        (VARIANTS, Variants("P01", "sensitivity", TABLE, {"angles 4 Hz": "too short"})),
        (QUANTITY, DataQuantity("P01", "first", QUANTITIES, {500.0: "too long"})),
        (MISMATCH, "mismatch"),
    ],
)
def test_what_was_saved_is_loaded_with_its_key(request, tmp_path, kind, made):
    saved = request.getfixturevalue(made) if isinstance(made, str) else made
    kind.save(saved, tmp_path, "key")
    loaded, key = kind.load_keyed(tmp_path)
    assert key == ("key" if kind.keyed else "")
    assert_same(loaded, saved, typed=kind not in (WALK, CYCLES, OVER))
