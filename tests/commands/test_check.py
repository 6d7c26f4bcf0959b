"""Small verbs and what all share: check, new, cite, doctor, options, exit codes."""

import json
from pathlib import Path
from unittest.mock import patch

import pytest
from manufactured_discovery import manufactured
from texts import says

import gaitdisc
from gaitdisc.commands.options import REFUSED, SOME_REFUSED, STOPPED
from gaitdisc.run import installation
from gaitdisc.run.installation import Check


def test_each_trial_has_its_strides(study, called):
    seen = json.loads(called("check", study, "--json", ends=0).stdout)
    assert sorted(one["condition"] for one in seen) == ["exo", "natural"]
    assert all(20 < one["strides"]["r"]["kept"] <= 30 / 1.1 for one in seen)  # 30 s of strides of 1.1 s


def test_check_writes_nothing(study, called):
    before = sorted(study.rglob("*"))
    called("check", study)
    assert sorted(study.rglob("*")) == before


def test_a_refusal_is_one_sentence_and_exit_code_1(tmp_path, called):
    done = called("check", tmp_path / "nowhere", ends=REFUSED)
    assert says(done.stderr, "SchemaError", "recording")


def test_a_condition_in_brackets_is_printed_as_it_is(study, tmp_path, called):
    text = (study / "study.toml").read_text().replace('"exo"', '"xo[/b]"').replace('"natural"', '"[natural]"')
    home = tmp_path / "study"
    home.mkdir()
    (home / "study.toml").write_text(text.replace("../..", str(study.parents[1])))
    checked = called("check", home)
    assert "xo[/b]" in checked.stdout and "[natural]" in checked.stdout


DATA = Path(__file__).parents[3] / "shared/data/opensim_gait10dof"


def test_a_study_is_not_overwritten(study, recordings, called):
    done = called("new", study, "--from", recordings, ends=REFUSED)
    assert says(" ".join(done.stderr.split()), "study.toml", "changed", "new")


def test_the_mapping_of_a_walk_needs_its_ground_forces_and_a_model_of_opensim(tmp_path, called):
    model = tmp_path / "leg.osim"
    model.write_text("<OpenSimDocument/>")
    loads = ("--external-loads", "grf.xml")
    for out, words, said in (
        ("walk.toml", (model, "--forces", "forces.sto"), "Add --external-loads grf.xml"),
        ("walk.toml", (tmp_path / "leg.xml", *loads), "found leg.xml"),
        ("walk", (model, *loads), "Name it leg.toml"),
    ):
        assert said in called("new", tmp_path / out, "--from", *words, ends=REFUSED).stderr


@pytest.mark.slow
@pytest.mark.skipif(not DATA.is_dir(), reason="the recorded walk is not here")
def test_the_mapping_of_a_walk_is_written_and_searched(tmp_path, called):
    pytest.importorskip("opensim", reason="OpenSim is not installed: gaitdisc[opensim]")
    results = DATA / "CMC/results_no_spring"
    files = {
        "--from": DATA / "CMC/subject01_metabolics.osim",
        "--external-loads": DATA / "ExperimentalData/subject01_walk_grf.xml",
        "--forces": results / "walk_subject_Actuation_force.sto",
        "--actuators": DATA / "gait10dof_Reserve_Actuators.xml",
    }
    done = called("new", tmp_path / "walk.toml", *(word for pair in files.items() for word in pair), ends=0)
    assert says(done.stdout, "72.6 kg, 10 free")
    out = ("--out", tmp_path / "found", "-q", "--no-report")
    done = called("discover", tmp_path / "walk.toml", results / "walk_subject_Kinematics_q.sto", *out, ends=0)
    assert says(done.stdout, "no missing effect")


def test_bibtex_is_printed_or_written_with_what_each_entry_is_for(called, tmp_path):
    folder = manufactured().save(tmp_path / "found")
    said = called("cite", folder).stdout
    assert said.startswith("% this program\n@software{gaitdisc,")
    assert f"version = {{{gaitdisc.__version__}}}" in said
    assert "% multiple shooting\n@inproceedings{bock1984," in said
    done = called("cite", folder, "--out", tmp_path / "methods.bib")
    assert (tmp_path / "methods.bib").read_text(encoding="utf-8") == said
    assert done.stdout == f"{tmp_path / 'methods.bib'}: {said.count('@')} entries\n"


def test_a_folder_without_a_result_is_refused(called, tmp_path):
    assert says(called("cite", tmp_path, ends=REFUSED).stderr, "a saved result")


def test_it_says_that_this_installation_works(called):
    done = called("doctor", ends=0)
    assert "This installation works." in done.stdout and "reads C3D" in done.stdout and "fonts" in done.stdout


def test_what_is_wrong_is_named_and_the_exit_code_says_so(called):
    with patch.object(installation, "checks", lambda: iter([Check("reads C3D", "wrong", "ReadError: no")])):
        assert says(called("doctor", ends=1).stderr, "Not working", "C3D")


def test_each_exit_code_says_something_else():
    done, wrong_usage = 0, 2
    assert len({done, wrong_usage, REFUSED, SOME_REFUSED, STOPPED}) == 5
