import json
from pathlib import Path

import numpy as np
import pytest
from texts import says

from gaitdisc.batch.demonstration import TRIALS, write_demonstration
from gaitdisc.batch.run_study import run_study
from gaitdisc.cohort.cohort import the_twelve, walks_of
from gaitdisc.errors import SchemaError
from gaitdisc.ingest.reading import read_planned_trial
from gaitdisc.ingest.study_file import load_study
from gaitdisc.kinematics.motion import moved_body


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("demo")
    write_demonstration(folder, 30.0, people=1)
    return folder


def test_the_files_are_read_as_a_laboratory_would_write_them(folder):
    study = load_study(folder)
    assert study.missing_files() == ()
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
    walked = walks_of(the_twelve()[0], 30.0).trials["nominal"]
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
    assert says(load_study(folder).title, "1", "embedded cohort, hidden")


def test_an_effect_that_is_none(tmp_path):
    with pytest.raises(SchemaError, match="found 'magic'"):
        write_demonstration(tmp_path, 30.0, 1, "magic")
    with pytest.raises(SchemaError, match=r"angles, markers, overground.*'video'"):
        write_demonstration(tmp_path, 30.0, 1, laboratory="video")


def test_markers_in_place_of_angles_go_through_the_same_reading(tmp_path):
    write_demonstration(tmp_path, 30.0, people=1, laboratory="markers")
    study = load_study(tmp_path)
    [person] = study.participants
    assert [trial.condition for trial in person.trials] == ["static", "nominal", "exo"]
    walk, standing = (read_planned_trial(study, person, person.trials[n]) for n in (1, 0))
    assert {"markers", "emg", "forces"} <= set(walk.streams)
    angles = angled(walk, standing)
    truth = walks_of(the_twelve()[0], 30.0).trials["nominal"].stream("kinematics")
    apart = angles["knee_angle_r"][: len(truth.time)] - truth["knee_angle_r"][: len(angles.time)]
    assert np.std(apart) < 2.0


def angled(walk, standing):
    return moved_body(walk.stream("markers"), standing.stream("markers"))[1].angles


@pytest.mark.slow
def test_short_trials_over_two_plates_are_pooled(tmp_path):
    study = write_demonstration(tmp_path, 30.0, people=1, laboratory="overground")
    [person] = study.participants
    assert [trial.condition for trial in person.trials].count("exo") == TRIALS
    run = run_study(load_study(tmp_path), tmp_path / "run")
    for pooled in run.cycles:
        assert pooled.kept["side"].value_counts().min() >= TRIALS
        assert pooled.kept["kinetic"].sum() >= TRIALS
