"""What a script asks of walks: what may be given, contacts, angles, moments, fitness, the response to a device."""

import numpy as np
import pandas as pd
import pytest

import gaitdisc as gd
from gaitdisc.errors import ChannelError, GaitdiscError, ReadError, SamplingError, SchemaError, StrideError
from gaitdisc.kinematics.motion import move_body
from gaitdisc.response.participant_response import R2_COLUMNS


@pytest.fixture(scope="module")
def walks():
    return gd.example_walks(20.0)


def test_a_table_of_angles_is_a_walk_like_its_file(walks):
    angles = walks["nominal"].stream("kinematics")
    table = angles.to_pandas()
    of_table, of_recording = gd.contacts(table, "angles"), gd.contacts(angles, "angles")
    expected = gd.contacts(gd.Trial("walk", {"kinematics": angles}), "angles")
    for side in "lr":
        np.testing.assert_allclose(of_table[side].time, expected[side].time, atol=1e-9)
        np.testing.assert_array_equal(of_recording[side].time, expected[side].time)
    assert len(gd.cycles(table.reset_index(), "r")) == len(gd.cycles(angles, "r"))


def test_two_tables_are_compared_as_their_trials(walks):
    first, second = (walks[word].stream("kinematics") for word in ("exo", "nominal"))
    found = gd.compare(first.to_pandas(), second, ["ankle_angle_r"])
    expected = gd.compare(*(gd.Trial("walk", {"kinematics": one}) for one in (first, second)), ["ankle_angle_r"])
    np.testing.assert_allclose(found.to_frame()["gap"], expected.to_frame()["gap"], atol=1e-6)


def test_a_table_and_a_recording_are_checked(walks):
    angles = walks["nominal"].stream("kinematics")
    assert gd.check(angles).strides == gd.check(angles.to_pandas()).strides != {}
    jumped = angles.to_pandas()
    jumped.iloc[300:380, 0] = np.nan
    assert gd.check(jumped).light == "amber"


def test_streams_come_from_the_channels_and_marks_stay(walks):
    both = walks["nominal"].on_one_base(100.0, ("kinematics", "emg"))
    assert gd.check(both).streams.keys() == {"kinematics", "emg"}
    assert "the recording" in gd.check(both).name


def test_what_is_no_walk_is_refused():
    with pytest.raises(ReadError, match=r"must be given as a file or a DataFrame"):
        gd.contacts(np.zeros((10, 2)))
    with pytest.raises(ReadError, match=r"times \[s\]"):
        gd.read(pd.DataFrame({"knee_angle_r": [1.0, 2.0]}))


def test_the_files_hold_the_walks(tmp_path):
    walks, files = gd.example_walks(5.0), gd.example_files(tmp_path, 5.0)
    assert {word: [path.suffix for path in paths] for word, paths in files.items()} == {
        "nominal": [".mot", ".c3d"], "exo": [".mot", ".c3d"]}  # fmt: skip
    read = gd.read(files["exo"])
    np.testing.assert_allclose(
        read.stream("kinematics")["knee_angle_r"], walks["exo"].stream("kinematics")["knee_angle_r"], atol=1e-5
    )
    assert set(read.stream("emg").names) == set(walks["exo"].stream("emg").names)


def test_a_file_of_a_walk_is_looked_at(tmp_path):
    angles, analog = gd.example_files(tmp_path, 10.0)["nominal"]
    seen = gd.check(angles)
    assert isinstance(seen, gd.Inspection) and seen.light == "green" and set(seen.strides) == {"r", "l"}
    (tmp_path / "words.csv").write_text("these,are\nno,numbers\n")
    assert gd.check(tmp_path / "words.csv").light == "red"
    assert analog.suffix == ".c3d"


@pytest.fixture(scope="module")
def walk():
    return gd.example_walks(10.0)["nominal"]


def test_contacts_and_cycles_of_a_walk_and_of_its_file(walk, tmp_path):
    found = gd.contacts(walk)
    assert {one.detector for one in found.values()} == {"force"}
    strides = gd.cycles(walk, "l")
    np.testing.assert_allclose(strides.start, found["l"].time[:-1])
    files = gd.example_files(tmp_path, 10.0)["nominal"]
    again = gd.cycles(files[0], "l", detector="angles")
    assert again.detector == "angles" and abs(len(again) - len(strides)) <= 1


def test_every_detector_places_its_own_contacts(walk):
    found = gd.contacts_by_detector(walk)
    assert set(found) == {"force", "angles"}
    apart = found["force"]["l"].compared(found["angles"]["l"])
    assert len(apart.difference_s) >= 7 and apart.median_ms < -10  # by angles they lie early, and stay where they are
    np.testing.assert_array_equal(gd.contacts(walk)["l"].time, found["force"]["l"].time)


def test_a_cycle_with_a_gap_in_what_is_cut_is_dropped(walk):
    kinematics, strides = walk.stream("kinematics"), gd.cycles(walk)
    values = np.array(kinematics.values)
    inside = (kinematics.time > strides.start[1]) & (kinematics.time < strides.start[1] + 0.5)
    values[inside] = np.nan
    cut = gd.cycles(walk, recording=kinematics.with_values(values))
    assert len(cut) == len(strides) - 1 and cut.dropped[0].start == strides.start[1]


def test_contacts_that_are_known_are_used_as_they_are_given(walk):
    table = pd.DataFrame({"time": np.arange(0.0, 10.0, 0.01), "knee": 0.0})
    at = np.arange(0.5, 9.0)
    strides = gd.cycles(table, contacts=at)  # nothing has to be found in it, so that its names are its own
    np.testing.assert_array_equal(strides.start, at[:-1])
    assert (strides.side, strides.detector) == ("r", "events")
    found = gd.contacts(walk)
    for given in (found, found["l"]):
        np.testing.assert_array_equal(gd.cycles(walk, "l", contacts=given).start, gd.cycles(walk, "l").start)


def test_contacts_in_frames_and_unknown_sides_and_detectors_are_refused(walk):
    with pytest.raises(StrideError, match=r"'right'.*contacts were found"):
        gd.cycles(walk, "right")
    with pytest.raises(StrideError, match=r"1000 s.*W01_nominal"):
        gd.cycles(walk, contacts=[100, 1000])
    for detector in ("heel", np.array([0.5, 1.5])):
        with pytest.raises(StrideError, match=r"auto, force, events, markers, angles.*contacts=times"):
            gd.contacts(walk, detector)


@pytest.fixture(scope="module")
def files(gait_data):
    walks = sorted((gait_data / "young_straight_and_turn" / "HC030A").rglob("*.c3d"))
    statics = sorted((gait_data / "young_static" / "HC030A").rglob("*.c3d"))
    if not walks or not statics:
        pytest.skip("no walk of HC030A with its static trial")
    return walks[0], statics[0]


def test_angles_are_those_of_the_room_below(files):
    from gaitdisc.ingest.c3d_parameters import read_body_measures

    walk, static = files
    trial, standing = gd.read(walk), gd.read(static)
    found = gd.angles(trial, static)
    below = move_body(trial.stream("markers"), standing.stream("markers"), measures=read_body_measures(static)).angles
    np.testing.assert_array_equal(found.values, below.values)
    assert found.channels == below.channels and "knee_angle_r" in found.names


def test_moments_come_with_a_mass_and_are_refused_without_forces(files):
    walk, static = files
    trial = gd.read(walk)
    found = gd.moments(trial, static, mass_kg=45.8)  # of HC030A
    assert {"N m/kg", "W/kg"} <= {channel.unit for channel in found.channels}
    with pytest.raises(GaitdiscError, match="plates must agree within 5 %"):
        gd.moments(trial, static, mass_kg=70.0)
    bare = gd.Trial("bare", {"markers": trial.stream("markers")})
    with pytest.raises(GaitdiscError, match="forces"):
        gd.moments(bare, static, mass_kg=45.8)


def test_two_trials_and_their_files_say_the_same(walks, tmp_path):
    found = gd.compare(walks["exo"], walks["nominal"], ["ankle_angle_r"], detector="angles")
    files = gd.example_files(tmp_path, 20.0)
    of_files = gd.compare(files["exo"][0], files["nominal"][0], ["ankle_angle_r"], detector="angles")
    np.testing.assert_allclose(of_files.curves["gap"], found.curves["gap"], atol=1e-3)
    assert isinstance(found, gd.Mismatch) and found.to_frame()["channel"].unique().tolist() == ["ankle_angle_r"]


def test_a_region_is_as_large_as_the_smallest_reported_and_one_channel_may_be_a_word(walks):
    found = gd.compare(walks["exo"], walks["nominal"], ["ankle_angle_r"], smallest_deg=3.5)
    assert len(found.regions) and (found.regions["gap"].abs() >= 3.5).all()
    assert not len(gd.compare(walks["exo"], walks["nominal"], ["ankle_angle_r"], smallest_deg=30.0).regions)
    assert gd.compare(walks["exo"], walks["nominal"], "ankle_angle_r").names == ("ankle_angle_r",)


OUTPUTS = ("ankle_angle_r",)


@pytest.fixture(scope="module")
def long():
    return gd.example_walks(30.0)


@pytest.mark.usefixtures("trained_briefly")
def test_two_walks_become_a_run_that_is_saved_and_drawn(long, tmp_path):
    run = gd.fit_response(long["nominal"], long["exo"], OUTPUTS, ["ankle_angle_r", "knee_angle_r", "hip_flexion_r"])
    table = run.to_frame()
    assert set(R2_COLUMNS) <= set(table) and set(table["variable"]) == set(OUTPUTS)
    ridge = table[(table["kind"] == "ridge") & (table["walk"] == "exo")].set_index("model")["r2"]
    assert ridge["augmented"] > ridge["nominal"]  # a spring at the ankle that only the one walk has
    again = gd.load(run.save(tmp_path / "run"))
    assert isinstance(again, gd.ResponseRun) and again.to_frame().equals(table)
    predicted, held = again.predict(long["exo"]), run.responses[0].held_out
    assert predicted.channels[0].unit == "deg/s2" and np.isnan(predicted.values[0, 0])
    rows = np.searchsorted(predicted.time, held.time)
    np.testing.assert_allclose(predicted.values[rows], held.predicted["augmented"], rtol=1e-4)
    with pytest.raises(SchemaError, match=r"no weights of 'ridge'.*older version saved without weights"):
        again.predict(long["exo"], "ridge")
    assert again.provenance.settings["models"]["outputs"] == list(OUTPUTS)
    assert gd.plot.r2(again).get_xlim()[1] == 1.0
    assert gd.plot.curves(again, "ankle_angle_r").get_title() == "ankle angle, right"
    assert "median R² of augmented" in again._repr_html_()


def test_an_output_that_is_no_angle_of_both_and_a_share_in_percent_are_refused(long):
    with pytest.raises(ChannelError, match=r"'ankle_angle_q' is not among .* .hip_flexion_r"):
        gd.fit_response(long["nominal"], long["exo"], ("ankle_angle_q",))
    with pytest.raises(SamplingError, match=r"held_out_share.*0.*12.5"):
        gd.fit_response(long["nominal"], long["exo"], held_out_share=12.5)
    with pytest.raises(ChannelError, match="'ankle' is not among"):
        gd.fit_response(long["nominal"], long["exo"], outputs="ankle")
