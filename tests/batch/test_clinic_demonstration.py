from __future__ import annotations

import json

import pytest

from gaitdisc.batch import clinic_demonstration
from gaitdisc.batch.clinic_demonstration import WEEK, Visit, person_of, write_week
from gaitdisc.ingest.study_file import load_study


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    folder = tmp_path_factory.mktemp("week")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(clinic_demonstration, "WALK_S", 4.0)
        patch.setattr(
            clinic_demonstration,
            "WEEK",
            (Visit("P01", 0, "before", "drop foot"), Visit("P02", 1, what="bad file"), Visit("P03", 2, what="child")),
        )
        return folder, write_week(folder, controls=1)


def test_two_studies_are_written_with_all_their_files_and_what_was_planted_apart(written):
    folder, (controls, week, planted) = written
    for study in (controls, week):
        assert load_study(study.folder).missing_files() == ()
    assert week.sessions == ("before",)
    child = week.participant("P03")
    assert (child.age_years, child.height_m) == (8, 1.26) and "P03 child" in week.title
    assert child.trials[0].speed_m_per_s == pytest.approx(1.1, abs=0.25)
    assert planted == {"P01 before": "drop foot right", "P02": "bad file", "P03": "child"}
    assert json.loads((folder / "planted.json").read_text()) == planted
    assert "simulated, no people" in week.title and "P01 before drop foot right" in week.title


def test_the_child_has_a_childs_size_and_the_dimensionless_speed_of_the_grown_person():
    child, grown = (person_of(Visit("P03", 2, what=what), 60_000) for what in ("child", ""))
    assert (child.height_m, child.mass_kg, child.age_years) == (1.26, 26.0, 8.0) and grown.height_m > 1.5
    assert child.dimensionless_speed == pytest.approx(grown.dimensionless_speed)
    assert child.speed_m_per_s * child.stride_s / child.height_m == pytest.approx(
        grown.speed_m_per_s * grown.stride_s / grown.height_m
    )


def test_the_week_has_healthy_people_both_plants_two_sessions_and_a_bad_file():
    assert {one.what for one in WEEK} == {"", "stiff knee", "drop foot", "bad file", "child"}
    assert {one.session for one in WEEK} == {"", "before", "after"}
