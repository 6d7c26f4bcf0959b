from __future__ import annotations

import pytest
from made_clinic import made_person, made_run
from texts import says

from gaitdisc.results.clinical_reference import load_reference


@pytest.fixture(scope="module")
def run_folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("controls") / "run"
    made_run(made_person("C1", group="control"), made_person("C2", group="control"), made_person("P1")).save(folder)
    return folder


def test_controls_of_a_run_become_one_file(called, run_folder, tmp_path):
    done = called("reference", run_folder, "--out", tmp_path, "--group", "control")
    assert done.returncode == 0, done.stderr
    assert says(done.stdout, "walk: 2 people, 4 legs;", "fewer", "5", "nothing")
    assert load_reference(tmp_path).people("walk") == 2


def test_a_group_that_nobody_is_of_is_refused(called, run_folder, tmp_path):
    done = called("reference", run_folder, "--out", tmp_path, "--group", "td")
    assert done.returncode == 1
    assert says(done.stderr, "controls of group 'td'") and "has control, no group" in done.stderr
