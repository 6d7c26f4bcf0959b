"""What is kept: JSON with a hash of its own, units of a study, kinds; what was changed after is refused and named."""

import json
import pickle
from dataclasses import asdict, replace
from datetime import UTC, datetime, timedelta

import numpy as np
import pandas as pd
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from resealed import resealed

from gaitdisc.errors import SchemaError
from gaitdisc.processing.pooled_cycles import WALK
from gaitdisc.recording import Finding
from gaitdisc.report.saved_page import draw_saved
from gaitdisc.response.participant_response import RESPONSE, load_run
from gaitdisc.response.participants_result import TESTS
from gaitdisc.run.citations import list_citations
from gaitdisc.saved import kind as kinds
from gaitdisc.saved import unit_folder
from gaitdisc.saved.kind import Kind, Saved, find_kind
from gaitdisc.saved.provenance import Refusal, code_sha256, list_versions, provenance_now
from gaitdisc.saved.study_run import UNITS, keep_creation, save_run
from gaitdisc.saved.unit_folder import (
    OWN,
    check_files,
    file_sha256,
    lies_on_disk,
    load_finding,
    load_unit,
    read_sealed,
    save_unit,
    seal_text,
    unit_name,
)

NUMBERS = st.floats(allow_nan=False) | st.integers() | st.text() | st.booleans() | st.none()


@settings(max_examples=60, deadline=None)
@given(data=st.dictionaries(st.text().filter(lambda key: key != OWN), NUMBERS | st.lists(NUMBERS, max_size=3)))
def test_what_is_written_is_read(tmp_path_factory, data):
    path = tmp_path_factory.mktemp("sealed") / "walk.json"
    path.write_text(seal_text(data), encoding="utf-8")
    assert read_sealed(path) == json.loads(json.dumps(data))


def test_another_order_and_another_editors_line_ends_change_nothing(tmp_path):
    path = tmp_path / "walk.json"
    named = json.loads(seal_text({"seconds": 60.0, "rate_hz": 100.0}))
    path.write_bytes(json.dumps(dict(reversed(named.items()))).replace(",", ",\r\n").encode())
    assert read_sealed(path) == {"seconds": 60.0, "rate_hz": 100.0}


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        (lambda text: text.replace("100.0", "999.0"), "walk.json.*edited|walk.json.*changed"),
        (lambda text: text.replace(OWN, "other"), "walk.json.*has no hash of its own: an older version of gaitdisc"),
        (lambda text: text[:-8], "walk.json.*cannot be read as JSON"),
        (lambda text: "[" * 100_000, "walk.json.*nested too deeply"),
        (lambda text: "[1, 2]", "walk.json.*not a JSON object"),
    ],
)
def test_what_was_changed_is_refused(tmp_path, changed, words):
    path = tmp_path / "walk.json"
    path.write_text(changed(seal_text({"seconds": 60.0, "rate_hz": 100.0})))
    with pytest.raises(SchemaError, match=words):
        read_sealed(path)


def test_a_file_that_is_missing_is_named(tmp_path):
    with pytest.raises(SchemaError, match=r"walk\.json.*missing"):
        read_sealed(tmp_path / "walk.json")


def test_files_beside_it_are_held_against_their_hashes(tmp_path):
    file = tmp_path / "curves.csv"
    file.write_text("1,2\n")
    hashes = {"curves.csv": file_sha256(file)}
    check_files(tmp_path, hashes)
    file.write_text("1,3\n")
    with pytest.raises(SchemaError, match=r"curves\.csv"):
        check_files(tmp_path, hashes)
    file.unlink()
    with pytest.raises(SchemaError, match=r"curves\.csv.*missing"):
        check_files(tmp_path, hashes)


@pytest.fixture
def stored(response, tmp_path):
    RESPONSE.save(response, tmp_path, "key")
    return RESPONSE.load(tmp_path)


def test_arrays_are_read_when_they_are_looked_at(response, stored, monkeypatch):
    assert lies_on_disk(stored, "held_out") and lies_on_disk(stored, "residuals")
    assert not lies_on_disk(response, "held_out")
    np.testing.assert_array_equal(stored.held_out.measured, response.held_out.measured)
    assert stored.residuals.keys() == response.residuals.keys()
    read = []
    monkeypatch.setattr(unit_folder.np, "load", lambda *_, **__: read.append(1))
    assert stored.held_out.time is stored.held_out.time  # what was just read is not read again
    assert read == []


def test_a_response_that_goes_to_another_process_takes_no_arrays_along(response, stored):
    assert len(pickle.dumps(stored)) < len(pickle.dumps(response))
    np.testing.assert_array_equal(pickle.loads(pickle.dumps(stored)).held_out.phi, response.held_out.phi)


def test_arrays_that_changed_or_went_since_the_run_was_loaded_are_reported(response, tmp_path):
    RESPONSE.save(response, tmp_path, "key")
    changed, gone = RESPONSE.load(tmp_path), RESPONSE.load(tmp_path)
    unit_folder._arrays.cache_clear()
    (tmp_path / "arrays.npz").write_bytes(b"other")
    with pytest.raises(SchemaError, match=r"arrays.npz.*changed since it was"):
        _ = changed.held_out
    (tmp_path / "arrays.npz").unlink()
    with pytest.raises(SchemaError, match=r"arrays.npz is missing"):
        _ = gone.residuals


def test_a_missing_file_and_another_format(response, tmp_path):
    with pytest.raises(SchemaError, match=r"run.json is missing"):
        load_run(tmp_path)
    RESPONSE.save(response, tmp_path, "key")
    resealed(tmp_path / "response.json", lambda data: data.update(format=99))
    with pytest.raises(SchemaError, match="has format 99, not 1"):
        RESPONSE.load_keyed(tmp_path)
    (tmp_path / "response.json").write_text("{")
    with pytest.raises(SchemaError, match="cannot be read as JSON"):
        RESPONSE.load_keyed(tmp_path)


def test_a_field_that_does_not_fit_the_schema_is_named(response, tmp_path):
    RESPONSE.save(response, tmp_path, "key")
    resealed(tmp_path / "response.json", lambda data: data.update(held_out_s=-1))
    with pytest.raises(SchemaError, match=r"at \$.held_out_s: -1"):
        RESPONSE.load_keyed(tmp_path)


def test_a_finding_comes_back_as_it_was():
    gap = Finding("warning", "gap", "a.mot", "0.1 s missing", "the windows", "knee_angle_r", ((1.0, 1.1), (2.0, 2.3)))
    assert load_finding(json.loads(json.dumps(asdict(gap)))) == gap


def test_a_table_saved_under_an_earlier_name_of_a_column_has_the_name_of_today(tmp_path):
    fields = {"participants": 0, "alpha": 0.05, "level": 0.95, "too_few": ""}
    save_unit(tmp_path, "tests.json", fields, {"curves.csv": pd.DataFrame({"state": ["knee"], "told": [1.5]})}, {})
    _, tables, _ = load_unit(tmp_path, "tests.json", {"curves.csv": ("state", "reconstructed")})
    assert tables["curves.csv"]["reconstructed"].tolist() == [1.5]


class Kept(Saved, file="kept.json"):
    pass


WRITTEN = []
KEPT = Kind(Kept, "kept.json", write=lambda *given: WRITTEN.append(given))


def test_a_result_is_saved_by_its_kind_and_gives_the_folder(tmp_path, monkeypatch):
    monkeypatch.setitem(kinds.KINDS, "kept.json", "kept:KEPT")
    monkeypatch.setattr(kinds, "load_word", {"kept:KEPT": KEPT}.get)
    one = Kept()
    assert one.save(str(tmp_path / "x")) == tmp_path / "x"
    assert [(one, tmp_path / "x")] == WRITTEN


def test_every_word_names_the_kind_of_its_file_and_every_class_is_of_a_kind():
    every = {file: kinds.load_word(word) for file, word in kinds.KINDS.items()}
    assert {file: kind.file for file, kind in every.items()} == {file: file for file in every}
    nouns = {kind.noun for kind in every.values()}
    assert {kind for kind in Saved.__subclasses__() if kind is not Kept and not kind.__subclasses__()} <= nouns


def test_every_unit_of_a_run_is_of_a_kind():
    assert all(isinstance(kinds.load_word(word), Kind) for word in UNITS.values())


def test_no_result_is_refused(tmp_path):
    with pytest.raises(SchemaError, match="contains nothing"):
        find_kind(tmp_path)


def test_a_fitted_model_has_neither_page_nor_citations(tmp_path):
    (tmp_path / "model.json").touch()
    for refused in (draw_saved, list_citations):
        with pytest.raises(SchemaError, match=r"model\.json, a fitted model"):
            refused(tmp_path)


@pytest.fixture
def saved(run, pair_tests, tmp_path):
    WALK.save(run.walks[0], tmp_path / "walks" / unit_name("P01", "exo"), "key")
    RESPONSE.save(run.responses[0], tmp_path / "responses" / "P01", "key")
    save_run(run.with_units(TESTS, (pair_tests,)), tmp_path)
    return tmp_path


def test_a_run_comes_back_as_it_was_with_its_paired_tests(saved, run, pair_tests):
    again = load_run(saved)
    assert (again.title, again.refusals, again.provenance) == (run.title, run.refusals, run.provenance)
    pd.testing.assert_frame_equal(again.r2_table(), run.r2_table())
    loaded = again.tests
    assert (loaded.participants, loaded.alpha, loaded.level, loaded.too_few) == (11, 0.05, 0.95, "")
    pd.testing.assert_frame_equal(loaded.tests, pair_tests.tests)
    pd.testing.assert_frame_equal(loaded.families, pair_tests.families)


def test_a_run_of_before_there_were_tests_is_still_read(saved):
    resealed(saved / "run.json", lambda data: data.pop("tests"))
    assert load_run(saved).tests is None


def test_tests_that_were_changed_by_hand_are_reported(saved):
    file = saved / "tests" / "tests.csv"
    file.write_text(file.read_text().replace("0.05", "0.99"))
    with pytest.raises(SchemaError, match=r"tests/tests\.csv.*changed since it was"):
        load_run(saved)


def made_at(run, created):
    return replace(run, provenance=replace(run.provenance, created=created))


def test_a_run_that_repeats_the_saved_one_keeps_its_time(run, tmp_path):
    save_run(made_at(run, "2026-01-01T00:00:00+00:00"), tmp_path)
    later = made_at(run, "2026-02-02T00:00:00+00:00")
    assert keep_creation(later, tmp_path).provenance.created.startswith("2026-01-01")
    other = replace(later, title="another title")
    renewed = replace(later, renewed=("walks/P01-exo",))
    assert keep_creation(other, tmp_path) == other
    assert keep_creation(renewed, tmp_path) == renewed
    assert keep_creation(later, tmp_path / "empty") == later


def test_tables(run):
    table = run.r2_table()
    assert table["participant"].tolist() == ["P01", "P01"]
    findings = run.findings_table()
    assert findings.loc[0, "spans_s"] == "1.00-1.10"
    assert list(replace(run, units={}).r2_table().columns) == list(table.columns)


def test_versions_name_what_computes_the_numbers():
    versions = list_versions()
    assert {"gaitdisc", "python", "numpy", "torch", "ezc3d"} <= set(versions)
    assert all(versions.values())
    assert code_sha256()[:12] in versions["gaitdisc"]


def test_what_is_made_now_says_when_and_by_what():
    made = provenance_now({"filters": {"order": 4}}, 3, {"a.mot": "ff"}, "4.2")
    assert (made.settings, made.seed, made.files, made.section) == (
        {"filters": {"order": 4}},
        3,
        {"a.mot": "ff"},
        "4.2",
    )
    assert made.versions == list_versions()
    assert timedelta(0) <= datetime.now(UTC) - datetime.fromisoformat(made.created) < timedelta(minutes=1)


def test_a_refusal_is_a_participant_a_walk_and_a_reason():
    assert Refusal("P01", "", "why").reason == "why"
    assert Refusal("P01", "walk 2", "why") != Refusal("P01", "walk 3", "why")
