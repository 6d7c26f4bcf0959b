"""Walks and pooled cycles of a participant, kept on disk under a key and taken from there."""

import shutil

import numpy as np
import pytest
from driven_walker import DrivenWalker
from manufactured_body import RAJAGOPAL, known_angles, markers_of, static_of
from texts import says

from gaitdisc.errors import ReadError
from gaitdisc.ingest.c3d_writing import write_c3d
from gaitdisc.ingest.reading import read_trial
from gaitdisc.ingest.storage import write_storage
from gaitdisc.ingest.study import Conditions, Filters, Kinematics, Models, Participant, PlannedTrial, StrideRules, Study
from gaitdisc.processing.processed_walks import (
    compute_cycles,
    cycles_key,
    process_walks,
    response_key,
    unit_key,
    unit_keys,
    walks_and_errors,
)
from gaitdisc.response.participant_response import load_run
from gaitdisc.run.run_study import compute_unit, run_study


def test_both_walks_say_what_the_models_leave_away(study):
    walks, refusals = process_walks(study, study.participants[0])
    assert (list(walks), refusals) == (["nominal", "exo"], ())
    assert all(walk.findings[-1].severity == "note" for walk in walks.values())


def test_one_walk_that_cannot_be_read_leaves_the_other(study):
    person = study.participants[0]
    lost = person.trials[1].model_copy(update={"files": ("gone.mot",)})
    person = person.model_copy(update={"trials": (person.trials[0], lost)})
    walks, errors = walks_and_errors(study, person)
    assert (list(walks), list(errors)) == (["nominal"], ["exo"])
    assert isinstance(errors["exo"], ReadError)
    assert process_walks(study, person)[1][0].reason == str(errors["exo"])


@pytest.fixture(scope="module")
def of_markers(study, tmp_path_factory):
    """The first person's walks as markers in C3D files, with a static trial and no angles."""
    folder = tmp_path_factory.mktemp("markers")
    for word in ("nominal", "exo"):
        own = read_trial(study.path_of(f"P01_{word}.mot")).stream("kinematics")
        angles = {name: own[name] if name in own.names else np.zeros(len(own.time)) for name in known_angles(2)}
        write_c3d([markers_of(angles, RAJAGOPAL, speed=0.0)], folder / f"{word}.c3d")
    write_c3d([static_of(RAJAGOPAL)], folder / "static.c3d")
    words = ("nominal", "exo", "static")
    trials = tuple(PlannedTrial(condition=word, files=(f"{word}.c3d",)) for word in words)
    update = {"participants": (Participant(id="P01", trials=trials),), "kinematics": Kinematics(joints="free")}
    return study.model_copy(update=update).placed(folder)


def test_walks_of_markers_are_the_walks_of_their_angles(study, of_markers):
    found, refusals = process_walks(of_markers, of_markers.participants[0])
    given, _ = process_walks(study, study.participants[0])
    assert not refusals
    for word, walk in found.items():
        np.testing.assert_allclose(walk.state.values, given[word].state.values, atol=1e-3)  # C3D holds 32 bits
        assert any(finding.kind == "marker set" for finding in walk.findings)


def test_the_key_of_a_walk_rests_on_its_static_trial_and_its_person(of_markers):
    person = of_markers.participants[0]
    keys = unit_keys(of_markers, person)
    heavy = person.model_copy(update={"mass_kg": 30.0})
    alone = person.model_copy(update={"trials": person.trials[:2]})
    assert len({tuple(unit_keys(of_markers, one).values()) for one in (person, heavy, alone)}) == 3
    assert unit_keys(of_markers, person) == keys


ANGLES = ("hip_flexion_r", "knee_angle_r", "ankle_angle_r", "hip_flexion_l", "knee_angle_l", "ankle_angle_l")


@pytest.fixture(scope="module")
def laboratory(tmp_path_factory):
    """Two people, three short trials each with a name in the file, and a file that is no recording."""
    folder = tmp_path_factory.mktemp("laboratory")
    for number, who in enumerate(("Erika", "Otto"), 1):
        walk = DrivenWalker(f"P0{number}", seed=number).walked(20.0, "walk")
        for k in range(3):
            part = walk.stream("kinematics").selected(ANGLES).between(6.0 * k, 6.0 * k + 5.0)
            write_storage(part, folder / f"{who}_{k}.mot")
            write_storage(walk.stream("forces").between(6.0 * k, 6.0 * k + 5.0), folder / f"{who}_{k}_grf.mot")
    (folder / "Erika_9.mot").write_text("nothing")
    return folder


@pytest.fixture
def overground(laboratory):
    people = []
    for number, who in enumerate(("Erika", "Otto"), 1):
        trials = [PlannedTrial(condition="walk", files=(f"{who}_{k}.mot", f"{who}_{k}_grf.mot")) for k in range(3)]
        trials += [PlannedTrial(condition="walk", files=("Erika_9.mot",))] if who == "Erika" else []
        people.append(Participant(id=f"P0{number}", trials=tuple(trials)))
    return Study(
        conditions=Conditions(nominal="walk"), strides=StrideRules(ground="overground"), participants=tuple(people)
    ).placed(laboratory)


def test_cycles_are_pooled_kept_and_not_computed_twice(overground, tmp_path, monkeypatch):
    person = overground.participants[1]
    (first,) = compute_cycles(overground, person, tmp_path)
    assert first.trials == 3 and first.counted("r") >= 6
    monkeypatch.setattr("gaitdisc.processing.pooled.pool_cycles", None)  # would fail if it were called
    (again,) = compute_cycles(overground, person, tmp_path)
    assert again.cycles.equals(first.cycles)


def test_another_setting_or_file_has_another_key(overground):
    person = overground.participants[0]
    other = overground.model_copy(update={"strides": StrideRules(ground="treadmill")})
    fewer = person.model_copy(update={"trials": person.trials[:2]})
    keys = {cycles_key(overground, person), cycles_key(other, person), cycles_key(overground, fewer)}
    assert len(keys) == 3


def test_the_body_s_mass_and_the_bytes_of_a_laboratory_s_marker_set_are_in_the_key(overground, tmp_path):
    person, own = overground.participants[0], tmp_path / "ours.toml"
    named = overground.model_copy(update={"kinematics": Kinematics(marker_set=str(own))})
    keys = {cycles_key(overground, person), cycles_key(overground, person.model_copy(update={"mass_kg": 60.0}))}
    for text in ("title = 'a'", "title = 'b'"):
        own.write_text(text)
        keys.add(cycles_key(named, person))
    assert len(keys) == 4


def test_a_trial_that_fails_costs_nobody_else_no_name_of_a_file_is_kept_and_the_cycles_come_back(overground, tmp_path):
    run = run_study(overground, tmp_path)
    assert run.reported == ("P01", "P02") and run.exo == ""
    (refusal,) = run.refusals
    assert (refusal.participant, refusal.condition) == ("P01", "walk 4")
    assert [one.trials for one in run.cycles] == [3, 3]
    texts = [path.read_text() for path in tmp_path.rglob("*") if path.suffix in (".json", ".csv")]
    assert len(texts) >= 5 and not any("Erika" in text or "Otto" in text for text in texts)
    loaded = load_run(tmp_path)
    assert [one.name for one in loaded.cycles] == [one.name for one in run.cycles] == ["P01 walk", "P02 walk"]
    assert loaded.reported == run.reported and loaded.refusals == run.refusals


def test_controls_without_the_device_are_pooled_beside_those_who_are_compared(overground, tmp_path):
    control = overground.participants[1].model_copy(update={"group": "control"})
    lonely = overground.participants[0]
    with_device = overground.model_copy(
        update={"conditions": Conditions(nominal="walk", device="exo"), "participants": (control, lonely)}
    )
    unit = compute_unit(with_device, control, tmp_path, lambda _: None)
    assert unit.cycles and not unit.refusals and says(unit.unfitted, "P02", "3", "'walk', none", "'exo'")
    refused = compute_unit(with_device, lonely, tmp_path, lambda _: None)
    assert not refused.cycles and says(refused.refusals[0].reason, "P01", "4", "'walk', none", "'exo'")


def test_a_file_that_could_not_be_read_is_tried_again(overground, laboratory, tmp_path):
    assert compute_cycles(overground, overground.participants[0], tmp_path)[0].refusals
    broken, text = laboratory / "Erika_9.mot", (laboratory / "Erika_9.mot").read_text()
    broken.write_text((laboratory / "Erika_0.mot").read_text())
    try:
        (mended,) = compute_cycles(overground, overground.participants[0], tmp_path)
    finally:
        broken.write_text(text)
    assert mended.refusals == () and mended.trials == 4


def test_two_short_walks_over_ground_that_no_model_can_use_are_pooled(overground, tmp_path):
    """One trial of each condition, three strides long: the run refused it, and there was nothing else to report."""
    first, second = overground.participants[1].trials[:2]
    trials = (first, second.model_copy(update={"condition": "exo"}))
    person = overground.participants[1].model_copy(update={"trials": trials})
    parts = {"conditions": Conditions(nominal="walk", device="exo"), "participants": (person,)}
    models = Models(angles=ANGLES, outputs=("knee_angle_r",))
    unit = compute_unit(overground.model_copy(update={**parts, "models": models}), person, tmp_path, lambda _: None)
    assert [one.condition for one in unit.cycles] == ["walk", "exo"] and all(len(one.kept) for one in unit.cycles)
    assert not unit.refusals and "10 are needed" in unit.unfitted
    treadmill = {**parts, "models": models, "strides": StrideRules(ground="treadmill")}
    refused = compute_unit(overground.model_copy(update=treadmill), person, tmp_path / "other", lambda _: None)
    assert not refused.cycles and [refusal.condition for refusal in refused.refusals] == ["walk", "exo"]


def test_the_key_follows_bytes_and_settings_not_names(study, tmp_path):
    planned = study.participants[0].trials[0]
    key = unit_key(study, planned)
    assert unit_key(study.model_copy(update={"title": "another"}), planned) == key
    assert unit_key(study.model_copy(update={"filters": Filters(kinematics_hz=8.0)}), planned) != key
    shutil.copy(study.path_of(planned.files[0]), tmp_path / "copy.mot")
    copied = PlannedTrial(condition="nominal", files=(str(tmp_path / "copy.mot"),))
    assert unit_key(study, copied) == key
    with (tmp_path / "copy.mot").open("a") as file:
        file.write(" ")
    assert unit_key(study, copied) != key


def test_a_response_rests_on_both_walks(study):
    keys = unit_keys(study, study.participants[0])
    assert list(keys) == ["nominal", "exo"]
    assert response_key(keys) != response_key({**keys, "exo": "another"})
