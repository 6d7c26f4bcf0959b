from dataclasses import replace

import pandas as pd
import pytest
from resealed import resealed

from gaitdisc.errors import SchemaError
from gaitdisc.results.over_participants import TESTS
from gaitdisc.results.participant_response import RESPONSE, load_run
from gaitdisc.results.pooled_cycles import WALK
from gaitdisc.results.study_run import created_before, save_run
from gaitdisc.results.unit_folder import unit_name


def test_a_run_comes_back_as_it_was(run, tmp_path):
    WALK.save(run.walks[0], tmp_path / "walks" / unit_name("P01", "exo"), "key")
    RESPONSE.save(run.responses[0], tmp_path / "responses" / "P01", "key")
    save_run(run, tmp_path)
    loaded = load_run(tmp_path)
    assert (loaded.title, loaded.refusals, loaded.provenance) == (run.title, run.refusals, run.provenance)
    pd.testing.assert_frame_equal(loaded.r2_table(), run.r2_table())


@pytest.fixture
def saved(run, pair_tests, tmp_path):
    WALK.save(run.walks[0], tmp_path / "walks" / unit_name("P01", "exo"), "key")
    RESPONSE.save(run.responses[0], tmp_path / "responses" / "P01", "key")
    save_run(run.with_units(TESTS, (pair_tests,)), tmp_path)
    return tmp_path


def test_the_paired_tests_come_back_as_they_were(saved, pair_tests):
    loaded = load_run(saved).tests
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
    assert created_before(later, tmp_path).provenance.created.startswith("2026-01-01")
    other = replace(later, title="another title")
    renewed = replace(later, renewed=("walks/P01-exo",))
    assert created_before(other, tmp_path) == other
    assert created_before(renewed, tmp_path) == renewed
    assert created_before(later, tmp_path / "empty") == later
