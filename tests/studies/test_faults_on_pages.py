"""A planted fault changes what it names and nothing else, and an answer is scored against the one without the fault."""

import shutil

import ezc3d
import faults_in_people
import faults_on_pages
import numpy as np
import planted_faults
import pytest


@pytest.fixture
def person(gait_data, tmp_path):
    own, static = tmp_path / "rec" / "HC030A" / "walk", tmp_path / "rec" / "HC030A" / "static"
    own.mkdir(parents=True)
    static.mkdir()
    shutil.copy(gait_data / "young_straight_and_turn" / "HC030A" / "straight" / "HC030A05.c3d", own)
    shutil.copy(gait_data / "young_static" / "HC030A" / "HC030A01.c3d", static)
    return faults_in_people.Recorded(tmp_path / "rec", "HC030A", live_emg=("emg_gas_r", "emg_ta_r"))


def planted(person, name):
    before = person.walk.read_bytes(), ezc3d.c3d(str(person.walk))
    next(kind for kind in faults_in_people.KINDS if kind.name.startswith(name)).plant(person)
    return *before, person.walk.read_bytes(), ezc3d.c3d(str(person.walk))


def points(c3d, *labels):
    own = [label for key in ("LABELS", "LABELS2") for label in c3d["parameters"]["POINT"][key]["value"]]
    return c3d["data"]["points"][:3][:, [own.index(label) for label in labels]]


def test_views_of_a_file_are_what_ezc3d_reads(person):
    file, read = faults_in_people.InPlace(person.walk), ezc3d.c3d(str(person.walk))
    seen = file.points[..., 3] >= 0
    theirs = np.moveaxis(read["data"]["points"][:3], 0, 2).swapaxes(0, 1)
    assert np.abs(file.points[..., :3][seen] - theirs[seen]).max() < 1e-3  # mm
    analog = read["data"]["analogs"][0]
    np.testing.assert_allclose(file.newtons(range(len(analog))).T, analog, rtol=1e-5, atol=1e-6 * np.abs(analog).max())


def test_two_exchanged_labels_differ_in_their_samples_alone(person):
    raw, before, planted_raw, after = planted(person, "1 walk ankle and toe")
    np.testing.assert_array_equal(points(after, "RANK", "RTOE"), points(before, "RTOE", "RANK"))
    changed = np.flatnonzero(np.frombuffer(raw, "<u4") != np.frombuffer(planted_raw, "<u4"))
    frames, width = before["data"]["points"].shape[2], 4 * before["data"]["points"].shape[1] + 240
    assert len(raw) == len(planted_raw)
    assert len(np.unique((changed - changed[0]) % width)) <= 8  # two points of x, y, z and residual
    assert 0 < len(changed) <= 8 * frames


def test_half_a_second_is_half_a_second(person):
    _, before, _, after = planted(person, "1 walk heel and toe")
    moved = np.any(points(after, "RHEE") != points(before, "RHEE"), axis=(0, 1))
    assert moved.sum() == 50  # at 100 Hz
    np.testing.assert_array_equal(points(after, "RHEE")[..., moved], points(before, "RTOE")[..., moved])


def test_a_gain_of_1_3_is_1_3_times_the_force_of_one_plate(person):
    _, before, _, after = planted(person, "5 gain of a plate")
    own, theirs = before["data"]["analogs"][0], after["data"]["analogs"][0]
    scale = [float(np.dot(own[k], theirs[k]) / np.dot(own[k], own[k])) for k in (2, 8)]
    assert sorted(scale) == pytest.approx([1.0, 1.3], abs=1e-5)
    np.testing.assert_array_equal(own[12:], theirs[12:])


def test_exchanged_plates_give_each_others_newtons(person):
    _, before, _, after = planted(person, "5 plates exchanged")
    own, theirs = before["data"]["analogs"][0], after["data"]["analogs"][0]
    np.testing.assert_allclose(theirs[:6], own[6:12], rtol=1e-5, atol=1e-3)
    np.testing.assert_allclose(theirs[6:12], own[:6], rtol=1e-5, atol=1e-3)


def test_late_events_are_0_1_s_late_and_mass_8_percent_off(person):
    raw, before, planted_raw, after = planted(person, "7 events 0.1 s late")
    times = [one["parameters"]["EVENT"]["TIMES"]["value"][1] for one in (before, after)]
    np.testing.assert_allclose(times[1] - times[0], 0.1, atol=1e-6)
    assert len(raw) == len(planted_raw)
    _, before, _, after = planted(person, "5 mass 8 % off")
    masses = [one["parameters"]["PROCESSING"]["Bodymass"]["value"][0] for one in (before, after)]
    assert masses[1] / masses[0] == pytest.approx(1.08)
    power = [points(one, "LAnklePower") for one in (before, after)]
    assert np.nanmax(power[1]) == pytest.approx(np.nanmax(power[0]) / 1.08)


def test_outputs_of_the_model_are_turned_shifted_and_scaled(person):
    _, before, _, after = planted(person, "8 left knee +20 deg")
    shift = points(after, "LKneeAngles") - points(before, "LKneeAngles")
    seen = np.isfinite(shift[0]) & (points(before, "LKneeAngles")[0] != 0)
    assert shift[0][seen] == pytest.approx(20.0, abs=1e-4)
    assert np.nanmax(np.abs(shift[1:])) == 0
    _, before, _, after = planted(person, "8 ankle moment / 1000")
    assert np.nanmax(points(after, "RAnkleMoment")) == pytest.approx(1e-3 * np.nanmax(points(before, "RAnkleMoment")))


def test_standing_comes_before_the_very_same_walk(person):
    _, before, _, after = planted(person, "11 standing before")
    events = [one["parameters"]["EVENT"]["TIMES"]["value"][1] for one in (before, after)]
    late = max(events[1]) - max(events[0])
    shift = round(100 * late)
    assert late == pytest.approx(1.5 + 0.8 / 2, abs=0.05)  # stands, and half of what eases in
    own, theirs = points(before, "LHEE")[:, 0], points(after, "LHEE")[:, 0]
    np.testing.assert_allclose(theirs[:, shift + 60 : shift + 150], own[:, 60:150], atol=1e-3)
    still = theirs[:, :150] - theirs[:, :1]
    assert np.nanmax(np.abs(still)) < 20.0  # mm
    assert after["data"]["analogs"].shape[2] == 10 * after["data"]["points"].shape[2]


def test_what_a_person_lacks_is_skipped_with_the_reason(person):
    person.static.unlink()
    with pytest.raises(faults_in_people.NotHereError, match="no static trial"):
        planted(person, "1 static heel and toe")
    with pytest.raises(faults_in_people.NotHereError, match="fewer than two live electrodes"):
        faults_in_people.emg_sides(faults_in_people.Recorded(person.folder, person.who))


def test_only_what_is_new_and_named_counts_as_said():
    clean = faults_on_pages.Answer(["warning: a.c3d, 3 gaps"], {"hip flexion l": (30.0, "")}, 2, 1, [], [])
    counted = clean._replace(lines=["warning: a.c3d, 4 gaps", "note: stands for 2 s"])
    assert faults_on_pages.new_lines(counted, clean) == []
    assert faults_on_pages.new_lines(counted, clean, notes=True) == ["note: stands for 2 s"]
    spoken = clean._replace(numbers={"hip flexion l": (50.0, "increased hip flexion")})
    assert spoken.spoken(clean) == ["l increased hip flexion"]
    tighter_limits = clean._replace(numbers={"hip flexion l": (30.1, "increased hip flexion")})
    assert tighter_limits.spoken(clean) == []
    kinds = {kind.name: kind for kind in faults_on_pages.KINDS}
    assert not faults_on_pages.said(kinds["6 twice"], clean._replace(cycles=4), clean, True)
    assert faults_on_pages.said(
        next(one for one in faults_on_pages.KINDS if one.people == 2), clean._replace(people=2), clean, False
    )
    assert not faults_on_pages.said(kinds["11 heels 0.5 s"], clean._replace(cycles=1), clean, True)


@pytest.mark.slow
def test_three_faults_in_three_files_are_found_and_the_files_themselves_raise_no_alarm(gait_data):
    found, alarms = planted_faults.outcomes(gait_data.parent, quick=True)
    assert alarms == []
    assert [one.found for one in found] == [True, True, True]
    assert planted_faults.table(found)[-1] == ("all", 3, 3, 0, 0)
