"""Bad inputs that a laboratory meets: one refusal each, in words; the rest goes on; the exit code tells."""

import json
from dataclasses import replace

import numpy as np
import pytest
from driven_walker import DrivenWalker
from texts import says

from gaitdisc.commands.options import REFUSED, SOME_REFUSED
from gaitdisc.ingest.reading import read_trial
from gaitdisc.ingest.storage import write_storage
from gaitdisc.ingest.study import Conditions, Models, Participant, PlannedTrial, Study
from gaitdisc.ingest.study_file import load_study, write_study
from gaitdisc.ingest.table import write_table
from gaitdisc.processing.process import processed
from gaitdisc.signals.contacts import force_contacts

ANGLES = ("hip_flexion_r", "knee_angle_r", "ankle_angle_r", "hip_flexion_l", "knee_angle_l")


@pytest.fixture(scope="module")
def walk():
    return DrivenWalker("P01", seed=3).walked(30.0, "nominal")


@pytest.fixture
def folder(walk, tmp_path):
    kinematics = walk.stream("kinematics").selected(ANGLES)
    (tmp_path / "P02").mkdir()
    for number, name in enumerate(("nominal", "exo", "P02/nominal")):  # no two are one recording
        write_storage(kinematics.with_values(kinematics.values + 0.01 * number), tmp_path / f"{name}.mot")
    return tmp_path


def walker(name, **files):
    """Somebody with a trial in each condition, of one or several files."""
    trials = tuple(PlannedTrial(condition=word, files=tuple(own)) for word, own in files.items())
    return Participant(id=name, trials=trials)


SOUND = walker("P01", nominal=["nominal.mot"], exo=["exo.mot"])


def written(folder, *people, **settings):
    models, conditions = Models(angles=ANGLES, outputs=("knee_angle_r",)), Conditions(nominal="nominal", device="exo")
    study = Study(conditions=conditions, participants=people, models=models, **settings)
    write_study(study.placed(folder), folder / "study.toml")


@pytest.fixture
def checked(folder, called):
    """What `gaitdisc check` says of a sound person P01 and of P02, whose device walk is these files."""

    def check(*files, ends=0):
        written(folder, walker("P02", nominal=["P02/nominal.mot"], exo=files), SOUND)
        done = called("check", folder, "--json", ends=ends)
        return {(one["participant"], one["condition"]): one for one in json.loads(done.stdout)}

    return check


@pytest.fixture
def refusal(checked):
    """Why the device walk of P02 is refused, where nothing else is."""

    def refuse(*files):
        seen = checked(*files, ends=SOME_REFUSED)
        assert seen["P01", "exo"]["light"] != "red", "the rest of the batch goes on"
        assert seen["P02", "nominal"]["light"] != "red"
        assert seen["P02", "exo"]["light"] == "red"
        return seen["P02", "exo"]["refusal"]

    return refuse


def altered(walk, folder, change):
    kinematics = walk.stream("kinematics").selected(ANGLES)
    values = np.array(kinematics.values)
    write_storage(kinematics.with_values(change(values)), folder / "bad.mot")
    return "bad.mot"


@pytest.mark.parametrize(
    ("file", "content", "said"),
    [
        ("nowhere.mot", None, "no such file. Check"),
        ("empty.mot", b"", "empty"),
        ("empty.c3d", b"", "0 bytes"),
        ("packed.c3d", b"PK\x03\x04" + bytes(2000), "ZIP"),
    ],
)
def test_a_file_that_is_absent_empty_or_of_another_kind(folder, file, content, said, refusal):
    if content is not None:
        (folder / file).write_bytes(content)
    assert says(refusal(file), file, said)


def test_a_column_missing(walk, folder, refusal):
    write_storage(walk.stream("kinematics").selected(ANGLES[:4]), folder / "bad.mot")
    said = refusal("bad.mot")
    assert says(said, "bad.mot", "4 channels", "not knee_angle_l;")


def test_units_absent(walk, folder, refusal):
    kinematics = walk.stream("kinematics").selected(ANGLES)
    names = [f"my_{name}" for name in ANGLES]
    rows = [",".join(["time", *names])]
    rows += [",".join(map(str, row)) for row in np.column_stack([kinematics.time, kinematics.values])]
    (folder / "bad.csv").write_text("\n".join(rows))
    said = refusal("bad.csv")
    assert "unit" in said and "bad.csv" in said and "my_hip_flexion_r" in said


def test_a_rate_that_is_not_constant(walk, folder, refusal):
    kinematics = walk.stream("kinematics").selected(ANGLES)
    write_table(kinematics, folder / "bad.csv")
    lines = (folder / "bad.csv").read_text().splitlines()
    (folder / "bad.csv").write_text("\n".join(lines[:500] + lines[530:]))
    said = refusal("bad.csv")
    assert "bad.csv" in said and "0.31 s" in said


def test_nan_in_force(walk, folder, refusal):
    forces = walk.stream("forces")
    values = np.array(forces.values)
    values[5000:5010, 0] = np.nan
    write_storage(forces.with_values(values), folder / "forces.mot")
    said = refusal("exo.mot", "forces.mot")
    assert says(said, "forces.mot: ground_force_r_vy", "10 of 30000", "missing")
    assert "t = 5 s" in said


def test_left_and_right_swapped(walk, folder, refusal):
    kinematics = walk.stream("kinematics")
    swap = str.maketrans("rl", "lr")
    columns = [kinematics.index(name[:-1] + name[-1].translate(swap)) for name in ANGLES[:2]]
    values = np.array(kinematics.selected(ANGLES).values)
    values[:, :2] = kinematics.values[:, columns]
    values[:, 3:] = kinematics.selected(ANGLES).values[:, :2]
    write_storage(kinematics.selected(ANGLES).with_values(values), folder / "bad.mot")
    write_storage(walk.stream("forces"), folder / "forces.mot")
    said = refusal("bad.mot", "forces.mot")
    assert "exchanged" in said


def test_radians_in_a_file_that_says_degrees(walk, folder, refusal):
    said = refusal(altered(walk, folder, np.deg2rad))
    assert "bad.mot" in said and "rad" in said


def test_somebody_who_stands(walk, folder, refusal):
    said = refusal(altered(walk, folder, lambda values: values[:1] + 0.01 * np.sin(values)))
    assert "bad.mot" in said


def test_a_participant_with_one_condition_only(folder, called):
    written(folder, walker("P02", nominal=["nominal.mot"]))
    said = called("run", folder, "--quiet", ends=REFUSED).stderr
    assert says(said, "'nominal'", "'exo'; P02", "1", "'nominal', none", "'exo'")


def test_a_held_out_part_longer_than_the_trial(folder, walk, called, undrawn):
    written(folder, SOUND, held_out={"seconds": 90.0})
    said = called("run", folder, "--quiet", ends=REFUSED).stderr
    assert says(said, "must be longer than", "90 s to be held out") and "lasts 30.00 s" in said


def test_a_typo_in_the_study(folder, called):
    written(folder, SOUND)
    text = (folder / "study.toml").read_text()
    (folder / "study.toml").write_text(text.replace("kinematics_hz", "kinematic_hz"))
    said = called("check", folder, ends=REFUSED).stderr
    assert "kinematics_hz" in said and "study.toml" in said and "line" in said


def test_a_trial_of_a_person_who_changed_is_refused(walk, folder, refusal):
    def changed(values):
        values[2250:] += np.array([8.0, -8.0, 6.0, 8.0, -8.0])
        return values

    said = refusal(altered(walk, folder, changed))
    assert "not change towards the end" in said


def test_dropping_nothing_silently(walk, folder, checked):
    trial = replace(walk, streams={"kinematics": walk.stream("kinematics").selected(ANGLES)})
    values = np.array(trial.stream("kinematics").values)
    values[1000:1040, 1] = np.nan
    write_storage(trial.stream("kinematics").with_values(values), folder / "bad.mot")
    seen = checked("bad.mot")
    kinds = {(finding["kind"], finding["channel"]) for finding in seen["P02", "exo"]["findings"]}
    assert ("gap", "knee_angle_r") in kinds


def test_moments_named_after_the_force_add_no_contact(walk, folder):
    forces = walk.stream("forces").selected(["ground_force_r_vy", "ground_force_l_vy"])
    labels = ["time", *forces.names, "ground_force_r_my", "ground_force_l_my"]
    table = np.column_stack([forces.time, forces.values, 0.3 * np.roll(forces.values, 300, axis=0)])
    rows = ["\t".join(map(repr, row)) for row in table.tolist()]
    (folder / "belts.mot").write_text("\n".join(["belts", "endheader", "\t".join(labels), *rows]) + "\n")
    read = read_trial(folder / "belts.mot").stream("forces")
    for side, contacts in force_contacts(forces).items():
        np.testing.assert_array_equal(force_contacts(read)[side].time, contacts.time)


def test_knees_counted_the_other_way_give_the_same_strides(walk, folder, checked):
    signs = np.where([name.startswith("knee") for name in ANGLES], -1.0, 1.0)
    seen = checked(altered(walk, folder, lambda values: values * signs))
    assert seen["P02", "exo"]["strides"] == seen["P01", "exo"]["strides"] != {}
    said = [one for one in seen["P02", "exo"]["findings"] if one["kind"] == "knee sign"]
    assert [(one["file"], one["channel"]) for one in said] == [("bad.mot", "knee_angle_r"), ("bad.mot", "knee_angle_l")]


def test_one_absurd_cell_costs_itself_only(walk, folder, checked):
    def absurd(values):
        values[1500, 1] = 1e6
        return values

    seen = checked(altered(walk, folder, absurd))
    (said,) = [one for one in seen["P02", "exo"]["findings"] if one["kind"] == "out of range"]
    assert seen["P02", "exo"]["light"] == "amber"
    assert (said["file"], said["channel"]) == ("bad.mot", "knee_angle_r")
    assert says(said["what"], "1e+06 deg", "frame 1501 (t = 15", "s)", "range", "-90", "180 deg")
    study = load_study(folder)
    sound, bad = (processed(read_trial(folder / file), study).state["knee_angle_r"] for file in ("exo.mot", "bad.mot"))
    assert np.nanmax(np.abs(bad - sound)) < 1.0  # what the spline over one missing frame leaves [deg]
