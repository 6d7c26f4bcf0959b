"""A draft of a study from real folders and from made ones; what came since is added, what stands in it stays."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from texts import says

from gaitdisc.channel import Channel, vocabulary
from gaitdisc.errors import ReadError, SchemaError
from gaitdisc.ingest.c3d import glance_at_c3d
from gaitdisc.ingest.new_study import _describe_trial, _read_drafts, draft_study, recording_files, stands
from gaitdisc.ingest.reading import read_planned_trial
from gaitdisc.ingest.storage import write_storage
from gaitdisc.ingest.study import Conditions, Participant, PlannedTrial, Study
from gaitdisc.ingest.study_file import grow_study, load_study, write_study
from gaitdisc.ingest.study_settings import ANGLES
from gaitdisc.own_files import LIST
from gaitdisc.recording import Event, Recording, Trial

TIME = np.arange(300) / 100
CHANNELS = tuple(c for c in vocabulary().channels if c.name in (*ANGLES, "mtp_angle_r", "lumbar_bending"))


def _walk(path, emg=False, channels=CHANNELS):
    path.parent.mkdir(parents=True, exist_ok=True)
    values = np.column_stack([30 * np.sin(6 * TIME + i) * (c.name != "mtp_angle_r") for i, c in enumerate(channels)])
    write_storage(Recording(TIME, values, channels), path)
    if emg:
        muscle = Channel("emg_sol_r", "emg", "1", "r")
        write_storage(Recording(TIME, values[:, :1] / 30, (muscle,)), path.with_name(path.stem + "_emg.sto"))


def test_the_draft_of_a_real_folder_can_be_used_as_it_is(gait_data, tmp_path):
    study, notes = draft_study(gait_data / "exotendon_run", tmp_path)
    study = load_study(write_study(study, tmp_path))
    assert (study.conditions.nominal, study.conditions.device) == ("natural", "exotendon")
    assert [each.id for each in study.participants] == ["P01", "welk002"]
    assert study.one_condition_only() == ("welk002",)
    assert study.models.angles == ANGLES
    assert all(study.path_of(file).is_file() for one in study.participants for t in one.trials for file in t.files)
    text = "\n".join(notes)
    assert says(text, "welk002/manual_ik.mot")
    assert "knee_angle_l_beta" in text and "mtp_angle_r" in text and "one condition only" in text
    trial = read_planned_trial(study, study.participants[0], study.participants[0].trials[1])
    assert trial.name == "P01 exotendon" and len(trial.streams["kinematics"].time) == 5992


def test_files_of_one_walk_are_found_together(gait_data):
    study, notes = draft_study(gait_data / "opensim_walks" / "mrs_emg_walking")
    (trial,) = study.participants[0].trials
    assert len(trial.files) == 5
    assert len(study.models.emg) == 24
    assert {"emg_sol_r", "emg_rf_r"} < set(study.models.outputs)
    assert any(says(note, "'walking'") for note in notes)
    assert study.conditions.words == ("walking",) and trial.condition == "walking"


def test_folders_become_people_and_names_pseudonyms(tmp_path):
    for person in ("Anna", "S02"):
        for condition in ("noexo", "exo"):
            _walk(tmp_path / "raw" / person / f"{condition}.mot", emg=True)
    (tmp_path / "raw" / "S02" / "broken_exo.mot").write_text("nothing")
    study, notes = draft_study(tmp_path / "raw", tmp_path / "study")
    assert {each.id for each in study.participants} == {"P01", "S02"}
    assert study.one_condition_only() == ()
    assert study.participant("S02").trials[0].files == ("../raw/S02/noexo.mot", "../raw/S02/noexo_emg.sto")
    assert study.models.emg == ("emg_sol_r",)
    assert "emg_sol_r" in study.models.outputs
    text = "\n".join(notes)
    assert "not pseudonyms were replaced by P01" in text
    assert says(text, "left", "S02/broken_exo.mot: broken_exo.mot", "OpenSim")
    assert "mtp_angle_r" in text and "lumbar_bending" in text


def test_angles_that_not_all_have_and_several_words_are_reported(tmp_path):
    _walk(tmp_path / "S1_baseline.mot")
    _walk(tmp_path / "S1_nominal.mot", channels=CHANNELS[:6])
    _walk(tmp_path / "S1_exo.mot", emg=True)
    study, notes = draft_study(tmp_path)
    assert study.models.emg == ()
    assert set(study.models.angles) == {channel.name for channel in CHANNELS[:6]} & set(ANGLES)
    text = "\n".join(notes)
    assert says(text, "'baseline'")
    assert says(text, "trials with EMG: 1 of 3")
    assert says(text, "excluded because some")


def test_files_that_do_not_go_together_are_reported(tmp_path):
    _walk(tmp_path / "S1" / "exo_ik.mot")
    _walk(tmp_path / "S1" / "exo_coordinates.mot")
    study, notes = draft_study(tmp_path)
    assert len(study.participants[0].trials[0].files) == 1
    assert any("both contain" in note for note in notes)


def test_the_way_to_the_folder_does_not_matter_but_hidden_folders_are_passed_over(tmp_path, monkeypatch):
    _walk(tmp_path / "lab" / "natural.mot")
    _walk(tmp_path / "lab" / ".trash" / "exo.mot")
    (tmp_path / "here").mkdir()
    monkeypatch.chdir(tmp_path / "here")
    study, _ = draft_study("../lab")
    assert [trial.files for trial in study.participants[0].trials] == [("natural.mot",)]


def test_folders_without_recordings_are_refused(tmp_path):
    with pytest.raises(ReadError, match="none must be a folder"):
        draft_study(tmp_path / "none")
    (tmp_path / "run").mkdir()
    for name in ("plates.forces", "study.toml", "run/run.json", f"run/{LIST}", "run/cycles.csv"):  # a study and its run
        (tmp_path / name).touch()
    with pytest.raises(ReadError, match=r"none.*; files not read because of their ending: 1 \.forces\. Name"):
        draft_study(tmp_path)
    (tmp_path / "a.mot").write_text("x")
    with pytest.raises(ReadError, match=r"none.*left.*a\.mot"):
        draft_study(tmp_path)


def test_folders_of_a_laboratory_need_no_edit(gait_data, tmp_path):
    study, notes = draft_study(gait_data / "young_straight_and_turn", tmp_path)
    study = load_study(write_study(study, tmp_path))
    assert study.conditions.words == ("straight", "turn") and study.conditions.device is None
    words = [sorted(trial.condition for trial in person.trials) for person in study.participants]
    both, three = ["straight", "turn"], ["static", "straight", "turn"]
    assert words == [three, both, both, three, both, both]
    assert not any("unknown" in note for note in notes)
    assert max(map(len, notes)) < 500  # labels of the files' own are counted, not listed


def test_a_folder_without_any_word_is_one_condition(gait_data, tmp_path):
    study, notes = draft_study(gait_data / "treadmill_walk_ik", tmp_path)
    assert [trial.condition for trial in study.participants[0].trials] == ["walking"] * 3
    assert any(says(note, "'walking'") for note in notes)


def test_sessions_groups_kinds_and_standing_are_found(tmp_path):
    _walk(tmp_path / "patients" / "S01" / "pre" / "IK" / "barefoot1.mot")
    muscle = Channel("emg_sol_r", "emg", "1", "r")
    other = tmp_path / "patients" / "S01" / "pre" / "EMG" / "barefoot1.sto"
    other.parent.mkdir()
    write_storage(Recording(TIME, np.sin(6 * TIME)[:, None], (muscle,)), other)
    _walk(tmp_path / "patients" / "S01" / "post" / "barefoot1.mot")
    _walk(tmp_path / "controls" / "S02_2024-03-01" / "shod_a.mot")
    _walk(tmp_path / "controls" / "S02_2024-06-01" / "shod_b.mot")
    still = Recording(TIME, np.full((300, len(CHANNELS)), 3.0), CHANNELS)
    write_storage(still, tmp_path / "controls" / "S02_2024-03-01" / "a7.mot")
    study, notes = draft_study(tmp_path)
    assert [(person.id, person.group) for person in study.participants] == [("S01", "patients"), ("S02", "controls")]
    assert study.conditions.words == ("barefoot", "shod")
    assert set(study.sessions) == {"pre", "post", "session 1", "session 2"}
    assert study.sessions.index("pre") < study.sessions.index("post")
    first, second = study.participants
    assert [(t.session, t.condition) for t in first.trials] == [("post", "barefoot"), ("pre", "barefoot")]
    assert [len(t.files) for t in first.trials] == [1, 2]  # kinematics and EMG of one stem, in two folders
    assert [(t.session, t.condition) for t in second.trials] == [
        ("session 1", "shod"), ("session 2", "shod"), ("session 1", "static"),
    ]  # fmt: skip
    assert "2024" not in "".join(study.sessions)
    assert any("trials, assigned the condition 'static': controls/S02_2024-03-01/a7.mot" in note for note in notes)


def test_what_no_name_shows_is_listed_with_the_one_line_for_all(tmp_path):
    for name in ("fast1", "fast2", "a1", "a2"):
        _walk(tmp_path / "S01" / f"{name}.mot")
    study, notes = draft_study(tmp_path)
    assert [trial.condition for trial in study.participants[0].trials].count("unknown") == 2
    (said,) = [note for note in notes if "unknown condition" in note]
    assert says(said, "S01/a1.mot, S01/a2.mot", "[conditions]", '= "fast"')
    path = write_study(study, tmp_path / "study.toml")
    text = path.read_text().replace('# unnamed = "walking"', 'unnamed = "fast"')
    path.write_text(text)
    assert [trial.condition for trial in load_study(path).participants[0].trials] == ["fast"] * 4


def test_mass_sex_and_stature_come_from_a_table_beside_the_folders(tmp_path):
    for person in ("sub-01", "sub-02", "sub-03"):
        _walk(tmp_path / "raw" / person / "walk.mot")
    table = {"participant_id": ["sub-01", "sub-02"], "sex": ["F", "M"], "weight": [61.3, "n/a"], "height": [172, 181]}
    pd.DataFrame(table).to_csv(tmp_path / "raw" / "participants.tsv", sep="\t", index=False)
    study, notes = draft_study(tmp_path / "raw", tmp_path / "study")
    study = load_study(write_study(study, tmp_path / "study.toml"))
    found = {one.id: (one.mass_kg, one.height_m, one.sex) for one in study.participants}
    assert found == {"sub-01": (61.3, 1.72, "f"), "sub-02": (None, 1.81, "m"), "sub-03": (None, None, "")}
    text = "\n".join(notes)
    assert says(text, "1 of 3", "2 of 3", "2 of 3 people", "participants.tsv")
    assert "not in participants.tsv: sub-03" in text
    assert "left out: participants" not in text


def test_the_mass_of_a_real_manifest(gait_data, tmp_path):
    study, _ = draft_study(gait_data / "young_straight_and_turn", tmp_path)
    assert [round(one.mass_kg or 0, 1) for one in study.participants[:2]] == [32.1, 45.8]
    assert all(one.mass_kg for one in study.participants)


def test_who_walks_straight_along_an_axis_does_not_stand():
    """Two of three coordinates of each marker then stay within 5 cm."""
    time = np.arange(300) / 100
    names = [f"M{n}.{axis}" for n in range(6) for axis in "xyz"]
    step = np.column_stack([1.2 * time, 0.02 * np.sin(6 * time), 0.9 + 0.02 * np.sin(12 * time)])
    channels = tuple(Channel(name, "marker", "m") for name in names)
    assert not stands(Trial("walk", {"markers": Recording(time, np.tile(step, 6), channels)}))
    assert stands(Trial("static", {"markers": Recording(time, np.tile(step * [0, 1, 1], 6), channels)}))
    events = tuple(Event("initial contact", side, at) for side, at in (("r", 0.2), ("l", 0.7)))
    among_still_points = {"markers": Recording(time, np.tile(step * [0, 1, 1], 6), channels)}
    assert not stands(Trial("a walk by its contacts", among_still_points, events))


def test_a_glance_at_a_c3d_shows_what_reading_all_of_it_shows(gait_data, real_files):
    count = 0
    for file, *read in real_files:
        if not file.is_relative_to(gait_data) or file.suffix != ".c3d" or file.name.startswith("M"):
            continue  # MotionMonitor's contradict themselves: a draft reads all of it
        if len(read) == 1:
            with pytest.raises(read[0]):
                glance_at_c3d(file)
        else:
            assert _describe_trial((Path("P01/a.c3d"),), glance_at_c3d(file)) == read[-1], file.name
            count += 1
    assert count >= 40


def test_a_draft_keeps_no_samples(tmp_path):
    _walk(tmp_path / "S1_exo.mot", emg=True)
    _walk(tmp_path / "S1_noexo.mot", emg=True)
    (one, _) = _read_drafts(tmp_path, recording_files(tmp_path), [], {})
    assert not [value for value in vars(one).values() if isinstance(value, Trial | Recording)]


def test_one_name_in_two_groups_is_two_people(tmp_path):
    raw = tmp_path / "raw"
    for group in ("controls", "patients"):
        _walk(raw / group / "Smith" / "walk.mot")
        _walk(raw / group / "S07_walk.mot")
    (raw / "participants.tsv").write_text("participant_id\tweight\nSmith\t61.3\n")
    study, notes = draft_study(raw, tmp_path / "study")
    found = {one.trials[0].files[0].removeprefix("../raw/"): one for one in study.participants}
    assert {file: one.group for file, one in found.items()} == {file: file.split("/")[0] for file in found}
    assert len(study.participants) == len({one.id for one in study.participants}) == 4
    assert {one.mass_kg for one in study.participants} == {None}  # the table does not say whose it is
    (said,) = [note for note in notes if says(note, "several groups, taken")]
    assert "P01 (controls)" in said and "P02 (patients)" in said


def test_trials_of_no_group_are_those_of_the_only_person_of_that_name(tmp_path):
    for file in ("controls/S07/walk.mot", "S07/walk2.mot"):
        _walk(tmp_path / file)
    (person,) = draft_study(tmp_path)[0].participants
    assert (person.id, person.group, len(person.trials)) == ("S07", "controls", 2)


def study_of(people, sessions=(), others=(), **more):
    participants = tuple(
        Participant(id=who, trials=tuple(trials), **more.get(who, {})) for who, trials in people.items()
    )
    return Study(sessions=sessions, conditions=Conditions(nominal="straight", others=others), participants=participants)


def walk(*files, condition="straight", session=None):
    return PlannedTrial(condition=condition, session=session, files=files)


@pytest.fixture
def study(tmp_path):
    """As somebody edited it: Zoe is P01, and one of her trials is not used."""
    return study_of({"P01": [walk("zoe/1.c3d"), walk("zoe/2.c3d", condition="unknown")]}).placed(tmp_path)


def test_a_person_keeps_the_pseudonym_and_edits_and_a_new_one_gets_another(study, tmp_path):
    draft = study_of(
        {
            "P01": [walk("anna/1.c3d")],
            "P02": [walk("zoe/1.c3d"), walk("zoe/2.c3d"), walk("zoe/3.c3d", condition="turn")],
        },
        others=("turn",), P01={"height_m": 1.6}, P02={"age_years": 30},
    ).placed(tmp_path)  # fmt: skip
    grown = grow_study(study, draft)
    assert [one.id for one in grown.participants] == ["P01", "P02"]
    zoe, anna = grown.participants
    assert [trial.files for trial in zoe.trials] == [("zoe/1.c3d",), ("zoe/2.c3d",), ("zoe/3.c3d",)]
    assert [trial.condition for trial in zoe.trials] == ["straight", "unknown", "turn"]
    assert (anna.trials[0].files, anna.height_m, zoe.age_years) == (("anna/1.c3d",), 1.6, 30)
    assert grown.conditions.others == ("turn",) and grown.folder == tmp_path


def test_nothing_new_is_the_same_study_and_files_of_a_trial_join_it(study, tmp_path):
    assert grow_study(study, study) == study
    draft = study_of({"P07": [walk("zoe/1.c3d", "zoe/1_ik.mot")]}).placed(tmp_path)
    (zoe,) = grow_study(study, draft).participants
    assert [trial.files for trial in zoe.trials] == [("zoe/1.c3d", "zoe/1_ik.mot"), ("zoe/2.c3d",)]


def test_sessions_of_the_draft_come_behind_and_what_does_not_fit_is_refused(study, tmp_path):
    own = study_of({"P01": [walk("zoe/1.c3d", session="pre")]}, ("pre",)).placed(tmp_path)
    draft = study_of({"P01": [walk("zoe/9.c3d", session="post")]}, ("pre", "post")).placed(tmp_path)
    assert grow_study(own, draft).sessions == ("pre", "post")
    stray = (Participant(id="P01", trials=(walk("zoe/9.c3d", session="later"),)),)
    with pytest.raises(SchemaError, match="later"):
        grow_study(own, draft.model_copy(update={"participants": stray}).placed(tmp_path))
