"""Angles and moments from markers inside a study: those that the same steps give by hand, and what is said without."""

import re
from dataclasses import replace

import numpy as np
import pytest
from changed_trials import gained, markers_at, with_labels_exchanged, with_stream
from texts import says

from gaitdisc.ingest.c3d import C3DReader, read_c3d
from gaitdisc.ingest.c3d_parameters import read_body_measures
from gaitdisc.ingest.reading import read_trial
from gaitdisc.ingest.study import Conditions, Kinematics, Participant, PlannedTrial, Study
from gaitdisc.kinematics.calibration import calibrate_body
from gaitdisc.kinematics.marker_set import marker_set
from gaitdisc.kinetics.body_inertia import Person
from gaitdisc.processing.markers_to_moments import compute_trial, without_exchanged_markers
from gaitdisc.processing.pooled import pool_cycles
from gaitdisc.processing.standing import person_findings, segment_distances
from gaitdisc.processing.two_sources import line_angles
from gaitdisc.recording import Strides
from gaitdisc.recording.trial import BodyMeasures
from gaitdisc.signals.butterworth import low_pass

MARKERS = Kinematics(angles="markers", marker_set="plug_in_gait")


@pytest.fixture(scope="module")
def files(gait_data):
    walks = gait_data / "young_straight_and_turn" / "HC030A"
    return {
        "straight": walks / "straight" / "HC030A05.c3d",
        "turn": walks / "turn" / "HC030A22.c3d",
        "static": gait_data / "young_static" / "HC030A" / "HC030A01.c3d",
    }


@pytest.fixture(scope="module")
def trials(files):
    return {kind: replace(read_c3d(file), name=f"P01 {kind}") for kind, file in files.items()}


def pooled(files, trials, kinematics=None, without=(), **person):
    """Cycles of the person's straight walk and turn, and all findings."""
    planned = tuple(PlannedTrial(condition=kind, files=(str(files[kind]),)) for kind in files if kind not in without)
    participant = Participant(id="P01", trials=planned, **person)
    conditions = Conditions(nominal="straight", others=("turn",))
    study = Study(conditions=conditions, participants=(participant,), kinematics=kinematics)
    found = pool_cycles(study, participant, lambda one: trials[one.condition])
    return found, [finding for one in found for finding in one.findings]


def bare(trial, *streams):
    return replace(trial, streams={key: value for key, value in trial.streams.items() if key not in streams})


def names(one):
    return [channel.name for channel in one.channels]


@pytest.fixture(scope="module")
def from_markers(files, trials):
    return pooled(files, trials, MARKERS)


@pytest.fixture(scope="module")
def from_file(files, trials):
    return pooled(files, trials, Kinematics(angles="file"))


def test_cycles_of_a_study_are_those_of_the_steps_taken_by_hand(files, trials, from_markers):
    measures = read_body_measures(files["static"])
    body = calibrate_body(trials["static"].stream("markers"), marker_set("plug_in_gait"), measures)
    found, findings = from_markers
    for one in found:
        made = compute_trial(trials[one.condition], body, Person(45.8)).trial
        angles, moments = low_pass(made.stream("kinematics"), 6.0, 4, 0.1), made.stream("moments")
        for row, curves in zip(one.kept.itertuples(), one.curves, strict=True):
            cycle = Strides(np.array([row.start_s]), np.array([row.end_s]), str(row.side), "events")
            apart = curves[:, [names(one).index(name) for name in angles.names]] - cycle.normalised(angles)[0]
            assert np.abs(apart).max() < 1e-6
            ankle = curves[:, names(one).index(f"ankle_angle_{row.side}_moment")]
            known = np.isfinite(ankle)
            assert known.any() == row.kinetic
            if row.kinetic:
                theirs = cycle.normalised(moments.selected([f"ankle_angle_{row.side}_moment"]))[0][:, 0]
                assert ankle[known] == pytest.approx(theirs[known], abs=1e-6)
                assert -1.6 < ankle[known].min() < -0.9  # plantarflexion at push-off, N m/kg
    assert [int(one.kept["kinetic"].sum()) for one in found] == [2, 2]
    said = {finding.kind: finding for finding in findings}
    assert said["marker set"].what.startswith("plug_in_gait: ")
    far = re.match(r"the distance of the markers .* is (\S+) mm .* is (\S+) mm \(\w+\)$", said["residual"].what)
    assert far and 0 < float(far[1]) <= float(far[2]) < 5.5
    assert {"force balance", "own model"} <= set(said)


@pytest.mark.slow
def test_a_file_without_a_model_gets_one_and_a_file_with_its_own_keeps_it(files, trials, from_markers):
    stripped = {kind: bare(trial, "kinematics", "moments") for kind, trial in trials.items()}
    made, findings = pooled(files, stripped, Kinematics(marker_set="plug_in_gait"))
    for one, same in zip(made, from_markers[0], strict=True):
        assert names(one) == names(same) and np.array_equal(one.curves, same.curves, equal_nan=True)
    assert "own model" not in {finding.kind for finding in findings}
    own, said = pooled(files, trials)
    alone, _ = pooled(files, trials, Kinematics(angles="file"), without=("static",))
    for one, same, other in zip(own, alone, made, strict=True):
        assert np.array_equal(one.curves, same.curves, equal_nan=True)
        assert np.nanmax(np.abs(one.curves[0, :, names(one).index("knee_angle_r")]
                                - other.curves[0, :, names(other).index("knee_angle_r")])) > 0.01  # fmt: skip
    assert not {"marker set", "residual", "no moments"} & {finding.kind for finding in said}
    left, _ = pooled(files, stripped, Kinematics(angles="file"))
    assert not any("knee_angle_r" in names(one) for one in left)


def test_what_a_file_computed_is_on_the_page_as_the_file_has_it(trials, from_file):
    found, findings = from_file
    for one in found:
        for row, curves in zip(one.kept.itertuples(), one.curves, strict=True):
            cycle = Strides(np.array([row.start_s]), np.array([row.end_s]), str(row.side), "events")
            wanted = [f"knee_angle_{row.side}", f"ankle_power_{row.side}", f"hip_flexion_{row.side}_moment"]
            for name, key in zip(wanted, ("kinematics", "moments", "moments"), strict=True):
                theirs = cycle.normalised(trials[one.condition].stream(key).selected([name]))[0][:, 0]
                apart = curves[:, names(one).index(name)] - theirs
                assert not np.isfinite(apart).any() or np.nanmax(np.abs(apart)) < 1e-9  # deg, W/kg, N m/kg
    filters = [finding.what for finding in findings if finding.kind == "filter"]
    assert filters and all(says(one, "angles as in", "moments and powers as in") for one in filters)


def test_a_person_without_a_mass_has_angles_and_one_word_on_it(files, trials, monkeypatch):
    measures = read_body_measures(files["static"])
    monkeypatch.setattr(
        "gaitdisc.processing.standing.read_body_measures", lambda _: BodyMeasures(
            None, inter_asis_m=measures.inter_asis_m, leg_length_m=measures.leg_length_m,
            knee_width_m=measures.knee_width_m, ankle_width_m=measures.ankle_width_m,
        ),
    )  # fmt: skip
    found, findings = pooled(files, trials, MARKERS)
    assert all("knee_angle_r" in names(one) and "knee_angle_r_moment" not in names(one) for one in found)
    (said,) = [finding for finding in findings if finding.kind == "no moments"]
    assert says(said.line(), "P01: no moments", "body mass [kg]", "PROCESSING:BODYMASS")
    weighed, _ = pooled(files, trials, MARKERS, mass_kg=45.8)
    assert all("knee_angle_r_moment" in names(one) for one in weighed)


def renamed(trial):
    """Same trial with marker labels of no set."""
    markers = trial.stream("markers")
    channels = tuple(replace(channel, name=f"Q{channel.name}") for channel in markers.channels)
    return with_stream(trial, "markers", replace(markers, channels=channels))


def test_markers_of_no_known_set_are_said_once_and_cost_no_cycle(files, trials):
    strange = {kind: renamed(trial) for kind, trial in trials.items()}
    found, findings = pooled(files, strange, Kinematics(angles="markers"))
    (said,) = [finding for finding in findings if finding.kind == "no angles"]
    assert (said.severity, said.file) == ("warning", "P01")
    assert says(said.what, "markers", "gait2354, helen_hayes, oxford_foot")
    assert all(len(one.kept) and "knee_angle_r" not in names(one) for one in found)


def test_without_a_static_trial_the_file_s_own_angles_are_not_taken_for_those_of_markers(files, trials):
    found, findings = pooled(files, trials, MARKERS, without=("static",))
    assert all(len(one.kept) and "knee_angle_r" not in names(one) for one in found)
    said = {(one.severity, one.what, one.spoils) for one in findings if one.kind == "static trial"}
    assert said == {("warning", "there is no static trial", "angles from markers")}


def test_emg_in_another_unit_than_that_of_the_static_trial_is_named(files, trials, from_file):
    emg = trials["straight"].stream("emg")
    wrong = with_stream(trials["straight"], "emg", emg.with_values(emg.values / 1e3))
    assert not [one for one in from_file[1] if one.kind == "EMG unit"]
    _, findings = pooled(files, {**trials, "straight": wrong}, Kinematics(angles="file"), without=("turn",))
    (said,) = [one for one in findings if one.kind == "EMG unit"]
    assert said.file == "P01 straight" and says(said.what, "weaker", "the static trial")


def test_without_emg_in_the_static_trial_walks_are_held_against_the_first(files, trials):
    emg = trials["turn"].stream("emg")
    wrong = with_stream(trials["turn"], "emg", emg.with_values(emg.values * 1e3))
    walks = {**trials, "turn": wrong, "static": bare(trials["static"], "emg")}
    (said,) = [one for one in pooled(files, walks, Kinematics(angles="file"))[1] if one.kind == "EMG unit"]
    assert said.file == "P01 turn" and says(said.what, "stronger", "P01")


@pytest.mark.parametrize("angles", ["file", "markers"])
def test_no_kinetics_are_drawn_of_a_plate_of_another_gain_or_of_a_mass_that_is_not_the_person_s(
    files, trials, angles, from_file, from_markers
):
    wrong = {kind: gained(trial, 2, 1.3) if kind != "static" else trial for kind, trial in trials.items()}
    found, findings = pooled(files, wrong, Kinematics(angles=angles))
    right, _ = from_file if angles == "file" else from_markers
    assert [int(one.kept["kinetic"].sum()) for one in found] == [1, 1] != [int(o.kept["kinetic"].sum()) for o in right]
    said = [one for one in findings if one.kind == "plate step" and one.severity == "warning"]
    assert len(said) == 2 and all("plate_2" in one.what and says(one.what, "body weight", "450 N") for one in said)
    heavy, findings = pooled(files, trials, Kinematics(angles=angles), without=("turn",), mass_kg=49.5)
    assert not any("ankle_power_r" in names(one) for one in heavy)
    assert any(one.kind == "no moments" and says(one.what, "45.9 kg", "49.5 kg") for one in findings)
    near, findings = pooled(files, trials, Kinematics(angles=angles), without=("turn",), mass_kg=47.5)
    assert any("ankle_power_r" in names(one) for one in near)
    assert any(one.kind == "body weight" and one.severity == "warning" for one in findings)


def with_heels_exchanged(trial, pair=("LHEE", "RHEE"), seconds=(0.6, 1.1)):
    """Two labels exchanged for half a second, the heels'; nothing that the file computed changes."""
    frames = slice(*(round(at * trial.stream("markers").rate_hz) for at in seconds))
    return with_labels_exchanged(trial, pair, frames), frames


@pytest.mark.slow
def test_angles_that_follow_the_right_labels_stay_and_keep_their_cycles(files, trials, from_file):
    other, _ = with_heels_exchanged(trials["straight"])
    (clean, _), _ = from_file
    (found,), said = pooled(files, {**trials, "straight": other}, Kinematics(angles="file"), without=("turn",))
    (one,) = (one for one in said if one.kind == "exchanged markers")
    assert one.channel == "LHEE, RHEE" and one.spans == ((0.6, 1.1),) and "angles of the file follow" in one.spoils
    assert len(found.kept) == len(clean.kept) > 0
    np.testing.assert_array_equal(found.curves, clean.curves)


def test_angles_of_the_wrong_labels_are_left_out_and_the_refusal_names_these(files, trials):
    """A file whose model ran after the labels were exchanged: its ankles follow the lines of the wrong ones."""
    other, frames = with_heels_exchanged(trials["straight"])
    angles, lines = other.stream("kinematics"), line_angles(other.stream("markers"))
    values, right = np.array(angles.values), line_angles(trials["straight"].stream("markers"))
    for name in ("ankle_angle_l", "ankle_angle_r"):
        values[frames, angles.index(name)] += (lines[name] - right[name])[frames]
    wrong = with_stream(other, "kinematics", angles.with_values(values))
    for trial, source in ((wrong, "file"), (other, "markers")):
        (found,), said = pooled(files, {**trials, "straight": trial}, Kinematics(angles=source), without=("turn",))
        assert any(one.kind == "exchanged markers" and one.spans == ((0.6, 1.1),) for one in said)
        assert len(found.kept) == 0
        (refusal,) = found.refusals
        assert says(refusal.reason, "0.60", "1.10 s foot_l, foot_r", "LHEE", "RHEE")
        assert "Correct the labels, add trials" in refusal.reason


@pytest.mark.parametrize("pair", [("LTHI", "LKNE"), ("LASI", "RASI")])
def test_all_that_hangs_on_a_segment_of_wrong_labels_is_missing(files, trials, pair):
    """A model builds its joint centres from the pelvis down: a thigh that is wrong turns shank and foot too."""
    trial, frames = with_heels_exchanged(trials["straight"], pair)
    angles, lines = trial.stream("kinematics"), line_angles(trial.stream("markers"))
    right, values = line_angles(trials["straight"].stream("markers")), np.array(angles.values)
    for name in set(lines) & set(angles.names):
        values[frames, angles.index(name)] += (lines[name] - right[name])[frames]
    wrong = with_stream(trial, "kinematics", angles.with_values(values))
    measures = read_body_measures(files["static"])
    calibration = calibrate_body(trials["static"].stream("markers"), marker_set("plug_in_gait"), measures)
    found = without_exchanged_markers(wrong, calibration).stream("kinematics")
    lost = {name for name in found.names if np.isnan(found[name][frames]).all()}
    left = {"hip_flexion_l", "knee_angle_l", "ankle_angle_l", "LFootProgressAngles.z"}
    assert left <= lost
    assert ({"ankle_angle_r", "LPelvisAngles.x"} <= lost) == (pair == ("LASI", "RASI"))
    for name in found.names:
        np.testing.assert_array_equal(np.delete(found[name], np.r_[frames]), np.delete(angles[name], np.r_[frames]))


PLACES = {
    "LASI": (0.0, 0.12, 0.9), "RASI": (0.0, -0.12, 0.9), "LPSI": (-0.15, 0.05, 0.92), "LKNE": (0.0, 0.1, 0.45),
    "LANK": (0.0, 0.1, 0.08), "LHEE": (-0.05, 0.1, 0.03), "LTOE": (0.14, 0.1, 0.03),
}  # fmt: skip


def _person(size=1.0, shank=1.0):
    time = np.arange(50) / 100
    places = {}
    for name, (x, y, z) in PLACES.items():
        up = 0.08 + (z - 0.08) * shank if name == "LKNE" else z
        places[name] = size * np.array([x, y, up]) + np.outer(time, [1, 0, 0])
    return markers_at(time, places)


def test_distances_of_a_segment_do_not_walk():
    found = segment_distances(_person())
    assert found["LASI", "RASI"] == pytest.approx(0.24)
    assert found["LKNE", "LANK"] == pytest.approx(0.37)
    assert ("LKNE", "LHEE") not in found


def test_another_person_is_named_with_the_two_distances():
    (said,) = person_findings(_person(), _person(size=1.08), "walk.c3d")
    assert (said.severity, said.kind, said.file) == ("warning", "static trial", "walk.c3d")
    assert says(said.what, "markers were moved")
    assert says(said.what, "370 mm", "400 mm") or says(said.what, "240 mm", "259 mm")


def test_one_marker_that_was_set_again_is_no_other_person():
    assert person_findings(_person(), _person(shank=1.1), "walk.c3d") == []
    assert person_findings(_person(), _person(size=1.02), "walk.c3d") == []


def test_few_markers_show_nothing():
    few = _person().selected([f"{name}.{axis}" for name in ("LKNE", "LANK") for axis in "xyz"])
    assert person_findings(few, _person(size=1.3), "walk.c3d") == []


@pytest.mark.slow
def test_six_people_in_seventy_two_pairs(gait_data):
    walks, standing = {}, {}
    with C3DReader() as reader:
        for folder in sorted(path for path in (gait_data / "young_straight_and_turn").iterdir() if path.is_dir()):
            place = gait_data / "young_static" / folder.name
            place = place if place.is_dir() else folder / "static"
            standing[folder.name] = read_trial(next(place.glob("*.c3d")), reader=reader).stream("markers")
            for file in sorted(folder.glob("[st][tu]r*/*.c3d")):
                walks[folder.name, file.stem] = read_trial(file, reader=reader).stream("markers")
    said = {
        (person, file, other): bool(person_findings(static, walk, file))
        for (person, file), walk in walks.items()
        for other, static in standing.items()
    }
    assert len(said) == 72
    assert all(found == (person != other) for (person, _, other), found in said.items())
