import pytest

from gaitdisc.batch.demonstration import write_demonstration
from gaitdisc.ingest.reading import read_trial
from gaitdisc.ingest.study_file import load_study


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("demo")
    write_demonstration(folder, 20.0)
    return folder


def test_the_files_are_read_as_a_laboratory_would_write_them(folder):
    study = load_study(folder)
    assert study.missing_files() == ()
    assert study.one_condition_only() == ()
    planned = study.participants[0].trials[0]
    trial = read_trial([study.path_of(file) for file in planned.files], study.channels)
    assert set(trial.streams) == {"kinematics", "emg", "forces"}
    assert (trial.stream("emg").rate_hz, trial.stream("emg").channels[0].unit) == (1000.0, "V")
    assert trial.stream("kinematics").rate_hz == 100.0


def test_it_says_that_nobody_walked(folder):
    assert "driven walkers" in load_study(folder).title
