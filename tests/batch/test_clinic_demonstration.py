from __future__ import annotations

import json

import pytest

from gaitdisc.batch import clinic_demonstration
from gaitdisc.batch.clinic_demonstration import WEEK, Visit, write_week
from gaitdisc.ingest.study_file import load_study


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    folder = tmp_path_factory.mktemp("week")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(clinic_demonstration, "WALK_S", 4.0)
        patch.setattr(
            clinic_demonstration, "WEEK", (Visit("P01", 0, "before", "drop foot"), Visit("P02", 1, what="bad file"))
        )
        return folder, write_week(folder, controls=1)


def test_two_studies_are_written_with_all_their_files_and_what_was_planted_apart(written):
    folder, (controls, week, planted) = written
    for study in (controls, week):
        assert load_study(study.folder).missing_files() == ()
    assert week.sessions == ("before",)
    assert planted == {"P01 before": "drop foot right", "P02": "bad file"}
    assert json.loads((folder / "planted.json").read_text()) == planted
    assert "simulated, no people" in week.title and "P01 before drop foot right" in week.title


def test_the_week_has_healthy_people_both_plants_two_sessions_and_a_bad_file():
    assert {one.what for one in WEEK} == {"", "stiff knee", "drop foot", "bad file"}
    assert {one.session for one in WEEK} == {"", "before", "after"}
