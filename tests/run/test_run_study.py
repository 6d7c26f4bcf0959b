"""A study run: each participant a unit, kept, taken up again and refused by name."""

import json
import os
import shutil
import signal
import subprocess
import sys
import time

import pandas as pd
import pytest
from texts import says

from gaitdisc.ingest.study_file import write_study
from gaitdisc.response.participant_response import load_run
from gaitdisc.run.run_study import compute_unit, run_study
from gaitdisc.run.workers import Workers


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    return tmp_path_factory.mktemp("run")


@pytest.fixture
def run(study, finished, trained_briefly):
    """Return the run that most tests load, in which networks hardly learn."""
    return run_study(study, finished)


@pytest.fixture(scope="module")
def whole(study, tmp_path_factory):
    """Return the run as other processes compute it."""
    return run_study(study, tmp_path_factory.mktemp("whole"))


def files_of(folder):
    return {
        str(path.relative_to(folder)): path.read_bytes()
        for part in ("walks", "responses")
        for path in sorted((folder / part).rglob("*"))
        if path.is_file()
    }


def test_a_run_is_saved_whole(run, finished):
    loaded = load_run(finished)
    pd.testing.assert_frame_equal(loaded.r2_table(), run.r2_table(), check_dtype=False)
    assert [response.participant for response in run.responses] == ["P01", "P02"]
    assert set(run.provenance.files) == {f"P0{k} {word}, file 1" for k in (1, 2) for word in ("nominal", "exo")}
    assert all(len(sha) == 64 for sha in run.provenance.files.values())


def test_a_second_run_computes_nothing(run, study, finished):
    before = {name: (finished / name).stat().st_mtime_ns for name in files_of(finished)}
    again = run_study(study, finished)
    assert {name: (finished / name).stat().st_mtime_ns for name in files_of(finished)} == before
    pd.testing.assert_frame_equal(again.r2_table(), run.r2_table(), check_dtype=False)


def test_a_damaged_unit_is_computed_again_to_the_same_tables(run, study, finished, tmp_path):
    copy = shutil.copytree(finished, tmp_path / "copy")
    arrays = copy / "responses" / "P02" / "arrays.npz"
    content = bytearray(arrays.read_bytes())
    content[len(content) // 2] ^= 1
    arrays.write_bytes(bytes(content))
    first = copy / "responses" / "P01" / "response.json"
    kept = first.stat().st_mtime_ns
    run_study(study, copy)
    assert first.stat().st_mtime_ns == kept
    repaired, whole = files_of(copy), files_of(finished)
    assert repaired.keys() == whole.keys()
    for name, content in whole.items():
        if not name.endswith(("fits.csv", "response.json")):  # these hold the seconds that a fit took
            assert repaired[name] == content, name


def test_what_was_edited_is_never_printed_but_computed_again_and_said(run, study, finished, tmp_path):
    copy = shutil.copytree(finished, tmp_path / "copy")
    edited = copy / "walks" / "P01-nominal" / "walk.json"
    data = json.loads(edited.read_text())
    edited.write_text(json.dumps({**data, "duration_s": 3.0, "rate_hz": 999.0}))
    (copy / "over" / "over.json").write_text("[" * 100_000)
    old = json.loads((copy / "responses" / "P02" / "response.json").read_text())
    del old["own_sha256"]
    (copy / "responses" / "P02" / "response.json").write_text(json.dumps(old))
    again = run_study(study, copy)
    assert [(walk.duration_s, walk.rate_hz) for walk in again.walks] == [
        (walk.duration_s, walk.rate_hz) for walk in run.walks
    ]
    pd.testing.assert_frame_equal(again.r2_table(), run.r2_table(), check_dtype=False)
    assert [line.partition(": ")[0] for line in again.renewed] == [
        "over/over.json",
        "responses/P02/response.json",
        "walks/P01-nominal/walk.json",
    ]
    assert all(says(line, why) for line, why in zip(again.renewed, ("JSON", "own_sha256", "SHA-256"), strict=True))
    assert run_study(study, copy).renewed == ()


def killed_for_the_second(study, participant, folder, progress):
    if participant.id == "P02":
        os.kill(os.getpid(), signal.SIGKILL)
    return compute_unit(study, participant, folder, progress)


@pytest.mark.slow  # tests/run/test_workers.py kills a process that computes next to nothing
def test_a_participant_whose_process_is_killed_is_refused_and_others_stand(run, study, finished, tmp_path, monkeypatch):
    copy = shutil.copytree(finished, tmp_path / "copy")
    monkeypatch.setattr("gaitdisc.run.run_study.compute_unit", killed_for_the_second)
    done = run_study(study, copy, Workers(jobs=2))
    assert [response.participant for response in done.responses] == ["P01"]
    [refusal] = done.refusals
    assert refusal.participant == "P02" and says(refusal.reason, "(SIGKILL) 2 times")
    assert [refusal.reason for refusal in load_run(copy).refusals] == [refusal.reason]


@pytest.mark.slow
def test_side_by_side_gives_the_same_tables(whole, study, tmp_path):
    parallel = run_study(study, tmp_path / "parallel", Workers(jobs=2))
    pd.testing.assert_frame_equal(parallel.r2_table(), whole.r2_table(), check_dtype=False)


@pytest.mark.slow  # that what stands is kept and the rest computed, the damaged unit above shows without a process
def test_a_run_that_was_killed_goes_on(whole, study, tmp_path):
    write_study(study, tmp_path / "study.toml")
    command = [sys.executable, "-m", "gaitdisc", "run", str(tmp_path), "--quiet"]
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    first = tmp_path / "run" / "responses" / "P01" / "response.json"
    while not first.exists() and process.poll() is None:
        time.sleep(0.05)
    os.kill(process.pid, signal.SIGKILL)
    process.wait()
    kept = first.stat().st_mtime_ns
    resumed = run_study(study, tmp_path / "run")
    assert first.stat().st_mtime_ns == kept
    pd.testing.assert_frame_equal(resumed.r2_table(), whole.r2_table(), check_dtype=False)


def alone(study, **changes):
    person = study.participants[0].model_copy(update=changes)
    return study.model_copy(update={"participants": (person,)}), person


def test_the_device_is_what_the_augmented_model_adds(study, tmp_path):
    shares = []
    unit = compute_unit(study, study.participants[0], tmp_path, shares.append)
    response = unit.response
    assert response is not None
    nominal, augmented, exo = (response.r2_of("ankle_angle_r", model) for model in ("nominal", "augmented", "exo"))
    assert nominal < augmented - 0.02
    assert augmented == pytest.approx(exo, abs=0.05)
    assert response.r2_of("knee_angle_r", "nominal") == pytest.approx(
        response.r2_of("knee_angle_r", "augmented"), abs=0.05
    )
    assert shares == sorted(shares)
    assert shares[-1] <= 1.0


def test_one_condition_only_is_refused_by_name(study, tmp_path):
    lonely, person = alone(study, trials=study.participants[0].trials[:1])
    unit = compute_unit(lonely, person, tmp_path, lambda _: None)
    assert unit.response is None
    assert says(unit.refusals[0].reason, "P01", "1", "'nominal', none", "'exo'")


def test_two_trials_of_one_condition_are_pooled_and_not_chosen_between(study, tmp_path):
    first, second = study.participants[0].trials
    halves = [first.model_copy(update={"crop_s": crop}) for crop in ((0.0, 15.0), (15.0, 30.0))]
    twice, person = alone(study, trials=(*halves, second))
    unit = compute_unit(twice, person, tmp_path, lambda _: None)
    assert says(unit.unfitted, "P01", "2", "'nominal', 1", "'exo'")
    assert unit.response is None and unit.refusals == ()
    nominal, exo = unit.cycles
    assert (nominal.trials, exo.trials) == (2, 1)
    of_trial = nominal.kept[nominal.kept["side"] == "r"]["trial"].value_counts()
    assert min(of_trial[1], of_trial[2]) >= 10  # 15 s of strides of 1.1 s each


def test_an_excluded_person_is_left_out_with_the_reason(study, tmp_path):
    without, person = alone(study, excluded="changed shoes")
    assert compute_unit(without, person, tmp_path, lambda _: None).refusals[0].reason.endswith("changed shoes")


def test_a_held_out_part_longer_than_the_trial_is_refused(study, tmp_path):
    held = study.held_out.model_copy(update={"seconds": 60.0, "share": None})
    unit = compute_unit(study.model_copy(update={"held_out": held}), study.participants[0], tmp_path, lambda _: None)
    assert says(unit.refusals[0].reason, "must be longer than", "60 s to be held out")
    assert len(unit.walks) == 2
