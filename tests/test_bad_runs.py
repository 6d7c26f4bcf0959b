"""Bad input of a run, end to end through the command line: what is said, and that the others go on."""

import errno
import json
import os
import re
import shutil
import socket
from contextvars import ContextVar
from functools import partial

import numpy as np
import pandas as pd
import pytest
from driven_walker import DrivenWalker
from texts import says

from gaitdisc.commands.options import REFUSED, SOME_REFUSED
from gaitdisc.ingest.storage import write_storage
from gaitdisc.ingest.study import Conditions, Models, Participant, PlannedTrial, Study
from gaitdisc.ingest.study_file import write_study
from gaitdisc.models.training_settings import TrainingSettings

pytestmark = pytest.mark.usefixtures("trained_briefly", "unpainted")
ANGLES = ("hip_flexion_r", "knee_angle_r", "ankle_angle_r", "hip_flexion_l", "knee_angle_l", "ankle_angle_l")


@pytest.fixture(scope="module")
def recordings(tmp_path_factory):
    """Walks of 24 s without and with a spring, sound and with a channel that does not move."""
    folder = tmp_path_factory.mktemp("recordings")
    for word, spring in (("nominal", 0.0), ("exo", 250.0)):
        walk = DrivenWalker("P01", seed=3, spring_per_s2=spring).walked(24.0, word)
        angles = walk.stream("kinematics").selected(ANGLES)
        write_storage(angles, folder / f"{word}.mot")
        for channel in ("ankle_angle_r", "ankle_angle_l"):
            values = np.array(angles.values)
            values[:, angles.index(channel)] = 5.0
            write_storage(angles.with_values(values), folder / f"still_{channel}_{word}.mot")
    return folder


@pytest.fixture
def folder(recordings, tmp_path):
    for file in recordings.iterdir():
        (tmp_path / file.name).symlink_to(file)
    return tmp_path


@pytest.fixture(scope="module")
def ran(recordings, tmp_path_factory, said, briefly):
    """A finished run of one participant, to be copied."""
    folder = tmp_path_factory.mktemp("ran")
    for word in ("nominal", "exo"):
        shutil.copy(recordings / f"{word}.mot", folder)
    written(folder, walker("P01"))
    with briefly(painted=False):
        said("run", folder, "--quiet", ends=0)
    return folder


def walker(name, nominal="nominal.mot", exo="exo.mot"):
    files = {"nominal": nominal, "exo": exo}
    trials = tuple(PlannedTrial(condition=word, files=(file,)) for word, file in files.items() if file)
    return Participant(id=name, trials=trials)


def written(folder, *people, outputs=("knee_angle_r", "ankle_angle_r")):
    study = Study(
        conditions=Conditions(nominal="nominal", device="exo"),
        models=Models(angles=ANGLES, outputs=outputs),
        participants=people,
    )
    write_study(study.placed(folder), folder / "study.toml")


def page_of(folder):
    """Text of the report, without its figures."""
    page = (folder / "run" / "report" / "report.html").read_text(encoding="utf-8")
    text = re.sub(r"<svg.*?</svg>|<style.*?</style>|<[^>]+>", " ", page, flags=re.DOTALL)
    return " ".join(text.split())


@pytest.mark.slow
def test_one_participant_carries_no_test(ran):
    assert says(page_of(ran), "One participant is not enough")
    tests = json.loads((ran / "run" / "tests" / "tests.json").read_text())
    assert tests["participants"] == 1
    assert tests["too_few"]


@pytest.mark.slow
def test_whoever_is_left_out_is_named_and_every_table_has_its_n(folder, said):
    for name in ("P02", "P03", "P04_nominal", "P04_exo"):  # no two people share a recording
        file = "exo.mot" if name.endswith("exo") else "nominal.mot"
        (folder / f"{name}.mot").write_bytes((folder / file).read_bytes() + b"\n" * (2 + ord(name[2])))
    written(
        folder, walker("P01"), walker("P02", "P02.mot", ""), walker("P03", "P03.mot", "gone.mot"),
        walker("P04", "P04_nominal.mot", "P04_exo.mot"),
        walker("P05", "still_ankle_angle_r_nominal.mot", "still_ankle_angle_r_exo.mot"),
    )  # fmt: skip
    words = said("run", folder, "--quiet", ends=SOME_REFUSED)
    assert says(words, "P02", "'nominal'", "'exo'; P02", "1", "'nominal', none")
    assert says(words, "P03 exo: P03 exo", "1", "no", "'exo.mot'")
    assert says(words, "P05", "P05: d2(ankle_angle_r)/dt2")
    assert "n = 2 participants" in words
    page = page_of(folder)
    assert says(page, "2 of 5 participants") or "n = 2 participants" in page
    assert all(name in page for name in ("P02", "P03", "P05"))
    table = pd.read_csv(folder / "run" / "report" / "tables" / "r2.csv")
    assert sorted(set(table["participant"])) == ["P01", "P04"]
    assert (table["n"] > 0).all()
    tests = pd.read_csv(folder / "run" / "tests" / "tests.csv")
    assert set(tests["n"]) <= {2}


def test_an_input_that_does_not_move_is_told(folder, said, trained_briefly, undrawn):
    written(folder, walker("P01", "still_ankle_angle_l_nominal.mot", "still_ankle_angle_l_exo.mot"))
    said("run", folder, "--quiet", ends=0)
    findings = pd.read_csv(folder / "run" / "report" / "tables" / "findings.csv")
    told = findings[findings["channel"] == "ankle_angle_l"]
    assert list(told["what"]) == ["5 deg throughout"] * 2
    assert told["spoils"].str.contains("coordinate is locked").all()


def test_a_training_that_does_not_converge_is_refused_by_participant_and_model(folder, monkeypatch, said):
    diverging = partial(TrainingSettings, learning_rate=1e30)
    monkeypatch.setattr("gaitdisc.run.run_study.TrainingSettings", diverging)
    written(folder, walker("P01"))
    words = said("run", folder, "--quiet", ends=REFUSED)
    assert says(words, "P01", "Nominal model:")
    assert says(words, "1e+30. Use another seed")


@pytest.mark.slow
def test_a_trial_shorter_than_the_longest_training_length_shortens_the_ablation_and_says_so(folder, said):
    written(folder, walker("P01"))
    words = said("ablate", folder, "--length", 5, "--length", 60, "--quiet", ends=0)
    assert says(words, "P01", "60 s", "left out", "20.7 s")
    assert says(page_of(folder), "lengths are left out", "60 s")
    quantity = pd.read_csv(folder / "run" / "quantities" / "P01" / "quantity.csv")
    assert sorted(set(quantity["length_s"])) == [5.0, 20.7]


@pytest.mark.slow
def test_a_disk_that_fills_in_the_middle_keeps_what_was_finished(folder, monkeypatch, said):
    for word in ("nominal", "exo"):
        (folder / f"second_{word}.mot").write_bytes((folder / f"{word}.mot").read_bytes() + b"\n")
    written(folder, walker("P01"), walker("P02", "second_nominal.mot", "second_exo.mot"))
    plain = os.fsync

    def full(handle):
        if (folder / "run" / "responses" / "P01" / "response.json").exists():
            raise OSError(errno.ENOSPC, "No space left on device")
        plain(handle)

    with monkeypatch.context() as disk:
        disk.setattr(os, "fsync", full)
        words = said("run", folder, "--quiet", ends=REFUSED)
    assert "WriteError" in words and says(words, "left", "choose another folder")
    assert not (folder / "run" / "run.json").exists()
    assert not list(folder.rglob(".part-*"))
    kept = (folder / "run" / "responses" / "P01" / "response.json").stat().st_mtime_ns
    assert "n = 2 participants" in said("run", folder, "--quiet", ends=0)
    assert (folder / "run" / "responses" / "P01" / "response.json").stat().st_mtime_ns == kept


def test_a_folder_that_cannot_be_written(folder, said):
    written(folder, walker("P01"))
    (folder / "file").write_text("")
    words = said("run", folder, "--quiet", "--out", folder / "file" / "run", ends=REFUSED)
    assert says(words, "folder") and "choose another folder with --out" in words


def test_two_runs_in_one_folder(folder, monkeypatch, said):
    from gaitdisc.write_lock import write_lock

    written(folder, walker("P01"))
    with write_lock(folder / "run"), monkeypatch.context() as another:
        another.setattr("gaitdisc.write_lock._HELD", ContextVar("held", default=frozenset()))
        words = said("run", folder, "--quiet", ends=REFUSED)
    assert says(words, f"{os.getpid()}", f"{folder}/run/")


@pytest.mark.usefixtures("undrawn")
def test_a_run_that_was_moved_to_another_machine_goes_on_there(ran, monkeypatch, tmp_path, said, called, request):
    there = shutil.copytree(ran, tmp_path / "machine")
    here = ran.rename(tmp_path / "here")
    request.addfinalizer(lambda: here.rename(ran))
    monkeypatch.setattr(socket, "gethostname", lambda: "another")
    kept = (there / "run" / "responses" / "P01" / "response.json").stat().st_mtime_ns
    said("run", there, "--quiet", ends=0)
    assert (there / "run" / "responses" / "P01" / "response.json").stat().st_mtime_ns == kept
    called("report", there / "run", ends=0)


@pytest.mark.usefixtures("undrawn")
@pytest.mark.parametrize("file", ["response.json", "r2.csv", "arrays.npz"])
def test_a_damaged_unit_is_told_by_report_and_mended_by_run(ran, tmp_path, said, file):
    folder = shutil.copytree(ran, tmp_path / "copy")
    damaged = folder / "run" / "responses" / "P01" / file
    whole = damaged.read_bytes()
    damaged.write_bytes(whole[: len(whole) // 2])
    words = said("report", folder / "run", ends=REFUSED)
    assert f"P01/{file} " in words and says(words, "`gaitdisc run` keeps")
    said("run", folder, "--quiet", ends=0)
    assert damaged.read_bytes() == whole
