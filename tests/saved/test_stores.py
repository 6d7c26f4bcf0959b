import re

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
from gaitdisc.response.participant_response import RESPONSE
from gaitdisc.response.participants_result import OVER, TABLES, TESTS, OverParticipants, no_rows
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


def test_a_walk_comes_back_as_it_was(walk, tmp_path):
    WALK.save(walk, tmp_path, "key")
    loaded, key = WALK.load_keyed(tmp_path)
    assert key == "key"
    np.testing.assert_array_equal(loaded.curves, walk.curves)
    pd.testing.assert_frame_equal(loaded.strides, walk.strides, check_dtype=False)
    for name in ("subject", "condition", "duration_s", "rate_hz", "detector", "channels", "findings", "files"):
        assert getattr(loaded, name) == getattr(walk, name)


def test_a_folder_name_has_no_characters_that_a_disk_refuses():
    assert re.fullmatch(r"P_1-10___up_hill-[0-9a-f]{8}", unit_name("P/1", "10 % up:hill"))


def test_no_two_walks_share_a_folder():
    """Conditions that differ in signs alone, and a hyphen in the pseudonym or in the condition."""
    walks = [("P01", "[exo]"), ("P01", "(exo)"), ("P01", "_exo_"), ("P01-a", "b"), ("P01", "a-b")]
    assert len({unit_name(*walk) for walk in walks}) == len(walks)


@pytest.mark.parametrize("fields", [{}, {"session": "after", "group": "control", "contact_offset_s": 0.06}])
def test_cycles_come_back_as_they_were(tmp_path, fields):
    made = made_cycles(**fields)
    CYCLES.save(made, tmp_path, "key")
    loaded, key = CYCLES.load_keyed(tmp_path)
    assert key == "key"
    np.testing.assert_array_equal(loaded.curves, made.curves)
    pd.testing.assert_frame_equal(loaded.cycles, made.cycles, check_dtype=False)
    pd.testing.assert_frame_equal(loaded.kept, made.kept, check_dtype=False)
    for name in ("name", "group", "trials", "detectors", "contact_offset_s", "foot_off_offset_s", "offset_steps",
                 "over_ground", "channels", "findings", "refusals", "files"):  # fmt: skip
        assert getattr(loaded, name) == getattr(made, name), name


def test_a_set_without_a_kept_cycle_comes_back_too(tmp_path):
    CYCLES.save(made_cycles(each=0, out=2), tmp_path, "key")
    assert len(CYCLES.load(tmp_path).kept) == 0


def test_no_two_sets_share_a_folder():
    names = [cycles_name("P01", *words) for words in (("", "a b"), ("a", "b"), ("", "a_b"), ("a b", "c"), ("a", "b c"))]
    assert len({*names}) == len(names)


def test_a_response_comes_back_as_it_was(response, tmp_path):
    RESPONSE.save(response, tmp_path, "key")
    loaded, _ = RESPONSE.load_keyed(tmp_path)
    pd.testing.assert_frame_equal(loaded.r2, response.r2)
    pd.testing.assert_frame_equal(loaded.fits, response.fits)
    np.testing.assert_array_equal(loaded.held_out.predicted["nominal"], response.held_out.predicted["nominal"])
    np.testing.assert_array_equal(loaded.residuals["nominal"], response.residuals["nominal"])
    assert (loaded.inputs, loaded.outputs, loaded.units) == (response.inputs, response.outputs, response.units)


def test_saving_twice_gives_the_same_bytes(response, tmp_path):
    for folder in ("a", "b"):
        RESPONSE.save(response, tmp_path / folder, "key")
    for file in ("response.json", "r2.csv", "fits.csv", "arrays.npz"):
        assert (tmp_path / "a" / file).read_bytes() == (tmp_path / "b" / file).read_bytes()


def test_why_somebody_was_refused_comes_back_as_it_was(tmp_path):
    refusals = (Refusal("P07", "exo", "gait changes at 38 s"),)
    refused = Refused(refusals, ("nominal",))
    REFUSED.save(refused, tmp_path, "key")
    assert REFUSED.load_keyed(tmp_path) == (refused, "key")


@pytest.fixture
def over():
    tables = {name: no_rows(name) for name in TABLES}
    columns = list(TABLES["responders"])
    tables["responders"].loc[0, columns] = ["P01", 1, 2, 0.1 + 0.2, 0.005, 1.0]
    tables["baselines"].loc[0] = ["exo", "ridge", "network", "hip_flexion_r", *[0] * 15, 0.5, ""]
    return OverParticipants(**tables, lengths_said="", responders_said="Sub-groups: 2 (n = 12 participants)")


def test_paired_tests_come_back_to_the_last_digit(pair_tests, tmp_path):
    TESTS.save(pair_tests, tmp_path)
    again = TESTS.load(tmp_path)
    assert (again.participants, again.too_few) == (pair_tests.participants, pair_tests.too_few)
    assert again.tests.equals(pair_tests.tests)
    assert again.families.equals(pair_tests.families)


def test_comparisons_come_back_to_the_last_digit(over, tmp_path):
    OVER.save(over, tmp_path)
    again = OVER.load(tmp_path)
    assert again.responders_said == over.responders_said
    for name, table in over.tables().items():
        assert again.tables()[name].to_numpy().tolist() == table.to_numpy().tolist()
        assert list(again.tables()[name].columns) == list(table.columns)


TABLE = pd.DataFrame(
    [("EMG", "knee_angle_r", "exo", "network", 0.1 + 0.2, 99), ("EMG", "knee_angle_r", "exo", "ridge", -3.5, 99)],
    columns=pd.Index(VARIANT_COLUMNS),
)


def test_what_was_saved_is_loaded(tmp_path):
    VARIANTS.save(Variants("P01", "sensitivity", TABLE, {"angles 4 Hz": "too short"}), tmp_path / "P01", "key")
    found, key = VARIANTS.load_keyed(tmp_path / "P01")
    assert (found.participant, found.question, key) == ("P01", "sensitivity", "key")
    assert found.left_away == {"angles 4 Hz": "too short"}
    pd.testing.assert_frame_equal(found.table, TABLE)


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
    walks = [
        DrivenWalker("A", seed=1, spring_per_s2=k).walked(25.0, name) for k, name in ((250.0, "exo"), (0.0, "free"))
    ]
    return compare_walks(*walk_pair(*walks))


def test_saved_is_loaded(mismatch, tmp_path):
    MISMATCH.save(mismatch, tmp_path)
    again = MISMATCH.load(tmp_path)
    for name, curves in mismatch.curves.items():
        np.testing.assert_array_equal(again.curves[name], curves)
    pd.testing.assert_frame_equal(again.regions, mismatch.regions)
    pd.testing.assert_frame_equal(again.summary, mismatch.summary)
    assert (again.exchange, again.findings, again.channels) == (mismatch.exchange, mismatch.findings, mismatch.channels)


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
