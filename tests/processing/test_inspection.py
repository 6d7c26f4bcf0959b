import numpy as np
import pytest
from changed_trials import with_column
from texts import says

from gaitdisc.ingest.reading import read_trial
from gaitdisc.ingest.storage import write_storage
from gaitdisc.ingest.study import Conditions, Participant, PlannedTrial, Study
from gaitdisc.ingest.study_file import load_study, write_study
from gaitdisc.processing.inspection import inspect_file, inspect_study
from gaitdisc.run.run_study import run_study


@pytest.fixture
def folder(trial, tmp_path):
    good = trial.stream("kinematics")
    write_storage(good, tmp_path / "good.mot")
    write_storage(with_column(good, good.names[3], np.nan, slice(500, 560)), tmp_path / "gappy.mot")
    (tmp_path / "empty.mot").write_text("")
    return tmp_path


def test_the_three_lights(folder):
    good = inspect_file(folder / "good.mot")
    assert good.refusal == "" and good.strides["r"][0] > 30
    assert sum(says(line, "contact offset: contacts", "no") for line in good.grouped()) == 1  # without asking for notes
    gappy = inspect_file(folder / "gappy.mot")
    assert gappy.light == "amber"
    assert any(line.startswith("warning: gappy.mot, knee_angle_r: gap") for line in gappy.grouped())
    empty = inspect_file(folder / "empty.mot")
    assert empty.light == "red"
    assert "empty.mot" in empty.refusal


def test_a_study_is_looked_at_whole_though_one_file_is_broken(folder):
    trials = (PlannedTrial(condition="a", files=("good.mot",)), PlannedTrial(condition="b", files=("empty.mot",)))
    lone = (PlannedTrial(condition="a", files=("gappy.mot",)), PlannedTrial(condition="unknown", files=("good.mot",)))
    study = Study(
        conditions=Conditions(nominal="a", device="b"),
        participants=(Participant(id="P01", trials=trials), Participant(id="P02", trials=lone)),
    ).placed(folder)
    write_study(study, folder / "study.toml")
    seen = list(inspect_study(load_study(folder)))
    assert [one.light for one in seen[1:]] == ["red", "amber", seen[3].light, "red"]
    assert says(seen[-1].refusal, "'a'", "'b'; P02", "1", "'a', none", "'b'", "1")


def test_findings_of_one_kind_share_a_line(trial, tmp_path):
    broken = np.array(trial.stream("kinematics").values)
    broken[500:560] = np.nan
    write_storage(trial.stream("kinematics").with_values(broken), tmp_path / "gappy.mot")
    lines = [line for line in inspect_file(tmp_path / "gappy.mot").grouped() if ": gap," in line]
    assert len(lines) == 1
    assert says(lines[0], "6 more", "10 times")


def test_calibration_trials_are_refused_as_walking(gait_data):
    seen = inspect_file(gait_data / "treadmill_walk_ik" / "S01DN603_ik.mot")
    assert seen.light == "red"
    assert "not used as a walk" in seen.refusal


def test_check_refuses_what_run_refuses_of_several_trials_and_no_more(folder):
    """Two trials of a condition passed the check and were refused by the run; now both pool their cycles."""
    good = read_trial(folder / "good.mot").stream("kinematics")
    for place in range(5):  # five recordings: one that is used twice is refused
        write_storage(good.with_values(good.values + 0.01 * place), folder / f"good{place}.mot")
    files = [("a", "good0"), ("a", "good1"), ("b", "good2"), ("a", "good3"), ("a", "empty"), ("a", "good4")]
    trials = tuple(PlannedTrial(condition=word, files=(f"{name}.mot",)) for word, name in files)
    two, broken, lone = (("P01", "", trials[:3]), ("P02", "control", trials[3:5]), ("P03", "", trials[5:]))
    people = tuple(Participant(id=name, group=group, trials=own) for name, group, own in (two, broken, lone))
    study = Study(conditions=Conditions(nominal="a", device="b"), participants=people).placed(folder)
    seen = list(inspect_study(study))
    run = run_study(study, folder / "run")
    refused = [(one.participant, one.condition) for one in seen if one.refusal]
    assert refused == [(one.participant, one.condition) for one in run.refusals] == [("P02", "a 2"), ("P03", "")]
    assert all(one.strides for one in seen if one.participant == "P01")


def test_a_walk_that_is_refused_keeps_what_its_reader_saw(gait_data, tmp_path):
    source = gait_data.parent / "opensim_gait10dof" / "ID" / "Results" / "subject01_walk_ID.sto"
    moments = read_trial(source).stream("moments")
    write_storage(moments.with_values(moments.values / 72.6), tmp_path / "id.sto")
    study = Study(
        conditions=Conditions(nominal="walking"),
        participants=(Participant(id="P01", trials=(PlannedTrial(condition="walking", files=("id.sto",)),)),),
    ).placed(tmp_path)
    (seen,) = inspect_study(study)
    assert seen.light == "red"
    (finding,) = [finding for finding in seen.findings if finding.kind == "per body mass"]
    assert says(finding.what, "seems to be N m per kg")
