"""Demonstrations: of responses, of a clinic, of planted people."""

import json
from pathlib import Path

import numpy as np
import pytest
from texts import says

from gaitdisc.channel import Channel
from gaitdisc.clinic import demonstration as clinic_demonstration
from gaitdisc.clinic.demonstration import WEEK, Visit, draw_person, write_week
from gaitdisc.clinic.rules import rules
from gaitdisc.cohort.cohort import make_walks, the_twelve
from gaitdisc.cohort.demonstration import DROP_DEG, TRIALS, plant, write_demonstration
from gaitdisc.errors import SchemaError
from gaitdisc.ingest.reading import read_planned_trial
from gaitdisc.ingest.study_file import load_study
from gaitdisc.kinematics.motion import move_body
from gaitdisc.recording import Recording, Trial
from gaitdisc.run.run_study import run_study


def _all_there(study):
    return all(study.path_of(file).is_file() for one in study.participants for t in one.trials for file in t.files)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("demo")
    write_demonstration(folder, 30.0, people=1)
    return folder


def test_the_files_are_read_as_a_laboratory_would_write_them(folder):
    study = load_study(folder)
    assert _all_there(study)
    assert study.one_condition_only() == ()
    [person] = study.participants
    trial = read_planned_trial(study, person, person.trials[0])
    assert set(trial.streams) == {"kinematics", "emg", "forces"}
    assert (trial.stream("emg").rate_hz, trial.stream("emg").channels[0].unit) == (1000.0, "V")
    assert (len(trial.stream("emg").names), len(trial.stream("kinematics").names)) == (14, 10)
    assert trial.stream("kinematics").rate_hz == 100.0
    assert [Path(file).suffix for file in person.trials[0].files] == [".mot", ".c3d"]
    assert trial.stream("emg").source.reader.startswith("ezc3d")


def test_what_is_read_is_what_was_measured(folder):
    study = load_study(folder)
    [person] = study.participants
    walked = make_walks(the_twelve()[0], 30.0).trials["nominal"]
    read = read_planned_trial(study, person, person.trials[0])
    for key, within in (("emg", 0.0), ("forces", 1e-3), ("kinematics", 1e-5)):
        assert read.stream(key).names == walked.stream(key).names
        np.testing.assert_allclose(read.stream(key).values, walked.stream(key).values, rtol=0, atol=within)
        np.testing.assert_allclose(read.stream(key).time, walked.stream(key).time, rtol=0, atol=1e-9)


def test_the_truth_lies_apart_from_the_recordings(folder):
    truth = json.loads((folder / "truth" / "W01.json").read_text())
    assert truth["spring_nm_per_deg"] == 5.0
    assert not any("truth" in file for trial in load_study(folder).participants[0].trials for file in trial.files)


def test_it_says_what_it_is(folder):
    assert says(load_study(folder).title, "1", "embedded cohort", "hidden")


def test_an_effect_that_is_none(tmp_path):
    with pytest.raises(SchemaError, match="found 'magic'"):
        write_demonstration(tmp_path, 30.0, 1, "magic")
    with pytest.raises(SchemaError, match=r"angles or markers or overground.*'video'"):
        write_demonstration(tmp_path, 30.0, 1, laboratory="video")


@pytest.mark.slow
def test_markers_in_place_of_angles_go_through_the_same_reading(tmp_path):
    write_demonstration(tmp_path, 30.0, people=1, laboratory="markers")
    study = load_study(tmp_path)
    [person] = study.participants
    assert [trial.condition for trial in person.trials] == ["static", "nominal", "exo"]
    walk, standing = (read_planned_trial(study, person, person.trials[n]) for n in (1, 0))
    assert {"markers", "emg", "forces"} <= set(walk.streams)
    angles = angled(walk, standing)
    truth = make_walks(the_twelve()[0], 30.0).trials["nominal"].stream("kinematics")
    apart = angles["knee_angle_r"][: len(truth.time)] - truth["knee_angle_r"][: len(angles.time)]
    assert np.std(apart) < 2.0


def angled(walk, standing):
    return move_body(walk.stream("markers"), standing.stream("markers")).angles


@pytest.mark.slow
def test_short_trials_over_two_plates_are_pooled(tmp_path):
    study = write_demonstration(tmp_path, 30.0, people=1, laboratory="overground")
    [person] = study.participants
    assert [trial.condition for trial in person.trials].count("exo") == TRIALS
    run = run_study(load_study(tmp_path), tmp_path / "run")
    for pooled in run.cycles:
        assert pooled.kept["side"].value_counts().min() >= TRIALS
        assert pooled.kept["kinetic"].sum() >= TRIALS


def _trial():
    slow, quick = np.arange(400) / 100, np.arange(4000) / 1000
    angles = np.column_stack([30 - 30 * np.cos(2 * np.pi * slow), np.zeros_like(slow)])
    channels = (Channel("knee_angle_l", "angle", "deg", "l"), Channel("ankle_angle_l", "angle", "deg", "l"))
    load = 500.0 * (quick % 1.0 < 0.6)[:, None]
    force = Channel("ground_force_l_vy", "vertical_force", "N", "l")
    return Trial("a", {"kinematics": Recording(slow, angles, channels), "forces": Recording(quick, load, (force,))})


def test_a_stiff_knee_bends_less_in_swing_alone():
    knee = plant(_trial(), "stiff knee", "l").stream("kinematics")["knee_angle_l"]
    before = _trial().stream("kinematics")["knee_angle_l"]
    assert knee.max() == pytest.approx(40.0)
    np.testing.assert_array_equal(knee[before <= 20], before[before <= 20])


def test_a_foot_hangs_while_it_is_lifted_alone():
    ankle = plant(_trial(), "drop foot", "l").stream("kinematics")["ankle_angle_l"]
    assert ankle[180] == pytest.approx(-DROP_DEG, abs=0.1)
    assert ankle[130] == pytest.approx(0.0, abs=0.1)


def test_nothing_is_planted_for_an_empty_word():
    trial = _trial()
    assert plant(trial, "", "l") is trial
    assert {"knee flexion in swing", "dorsiflexion in swing"} <= {rule.name for rule in rules()}  # that must speak


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
        assert _all_there(load_study(study.folder))
    assert week.sessions == ("before",)
    child = week.participant("P03")
    assert (child.age_years, child.height_m) == (8, 1.26) and "P03 child" in week.title
    assert child.trials[0].speed_m_per_s == pytest.approx(1.1, abs=0.25)
    assert planted == {"P01 before": "drop foot right", "P02": "bad file", "P03": "child"}
    assert json.loads((folder / "planted.json").read_text()) == planted
    assert "simulated clinic week" in week.title and "P01 before drop foot right" in week.title


def test_the_child_has_a_childs_size_and_the_dimensionless_speed_of_the_grown_person():
    child, grown = (draw_person(Visit("P03", 2, what=what), 60_000) for what in ("child", ""))
    assert (child.height_m, child.mass_kg, child.age_years) == (1.26, 26.0, 8.0) and grown.height_m > 1.5
    assert child.dimensionless_speed == pytest.approx(grown.dimensionless_speed)
    assert child.speed_m_per_s * child.stride_s / child.height_m == pytest.approx(
        grown.speed_m_per_s * grown.stride_s / grown.height_m
    )


def test_the_week_has_healthy_people_both_plants_two_sessions_and_a_bad_file():
    assert {one.what for one in WEEK} == {"", "stiff knee", "drop foot", "bad file", "child"}
    assert {one.session for one in WEEK} == {"", "before", "after"}
