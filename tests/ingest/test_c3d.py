import numpy as np
import pytest
from texts import says

from gaitdisc.errors import ReadError, SamplingError
from gaitdisc.ingest.c3d import read_c3d

SAMPLES = "c3d_reader_samples"


def _everything(trial) -> str:
    """All words of a trial, as a report could print them."""
    words = [trial.name, trial.subject, *(event.label for event in trial.events)]
    words += [finding.line() for finding in trial.findings]
    for recording in trial.streams.values():
        words += [recording.source.reader, recording.source.file, *recording.names]
    return "\n".join(words)


# --- what is written is what is read


def test_markers_and_channels_with_their_clocks(tmp_path, write_c3d, some_points, some_analog, reader):
    labels = {("ANALOG", "LABELS"): ["Voltage.L Rect", "Voltage.R Hams", "Voltage.L Spare", "EMG9"]}
    path = write_c3d(tmp_path / "walk.c3d", some_points, some_analog, labels)
    trial = reader.read(path)
    assert trial.name == "walk"
    markers, emg = trial.stream("markers"), trial.stream("emg")
    np.testing.assert_allclose(markers.values, some_points.transpose(2, 1, 0).reshape(50, 9) / 1000, rtol=1e-6)
    assert (markers.rate_hz, emg.rate_hz) == (100.0, 1000.0)
    assert markers.time[0] == emg.time[0] == 0
    assert emg.names == ("emg_rf_l", "emg_ham_r", "emg_9")
    np.testing.assert_allclose(emg.values, some_analog[[0, 1, 3]].T, rtol=1e-6)
    assert trial.stream("signals").names == ("Voltage.L Spare",)
    assert len(markers.source.sha256) == 64
    assert markers.source.reader.startswith("ezc3d")


def test_the_hash_is_that_of_the_file(tmp_path, write_c3d, some_points):
    import hashlib

    path = write_c3d(tmp_path / "a.c3d", some_points)
    assert read_c3d(path).stream("markers").source.sha256 == hashlib.sha256(path.read_bytes()).hexdigest()


def test_gaps_are_nan(tmp_path, write_c3d, some_points, reader):
    some_points[:, 1, 10:20] = np.nan
    markers = reader.read(write_c3d(tmp_path / "a.c3d", some_points)).stream("markers")
    assert np.isnan(markers.values[10:20, 3:6]).all()
    assert np.isnan(markers.values).sum() == 30


def test_more_than_255_points(tmp_path, write_c3d, reader):
    points = np.random.default_rng(3).normal(900, 300, (3, 300, 5))
    markers = reader.read(write_c3d(tmp_path / "a.c3d", points)).stream("markers")
    assert markers.names[::3] == tuple(f"M{number}.x" for number in range(1, 301))


def test_more_than_65535_frames(tmp_path, write_c3d, reader):
    points = np.random.default_rng(4).normal(900, 300, (3, 1, 70_000))
    fields = {("TRIAL", f"ACTUAL_{end}_FIELD"): [1.0, 0.0] for end in ("START", "END")}
    path = write_c3d(tmp_path / "a.c3d", points, parameters=fields)
    content = path.read_bytes()
    for end, frame in (("START", 1), ("END", 70_000)):  # ezc3d writes floats; the two 16-bit words are what labs have
        at = content.index(f"ACTUAL_{end}_FIELD".encode()) + len(f"ACTUAL_{end}_FIELD")
        words = bytes([content[at] - 4, 0, 2, 1, 2]) + frame.to_bytes(4, "little")
        content = content[:at] + words + content[at + len(words) + 4 : 1536] + bytes(4) + content[1536:]
    path.write_bytes(content)
    trial = reader.read(path)
    np.testing.assert_allclose(trial.stream("markers").values, points[:, 0].T / 1000, rtol=1e-6)


def test_more_than_65535_frames_whose_number_nobody_says(tmp_path, write_c3d, reader):
    path = write_c3d(tmp_path / "a.c3d", np.full((3, 1, 70_000), 900.0))
    with pytest.raises(ReadError, match=r"a\.c3d.*700\d\d.*65535"):
        reader.read(path)


def test_events_and_the_first_field(tmp_path, write_c3d, some_points, reader):
    parameters = {
        ("TRIAL", "ACTUAL_START_FIELD"): [101.0, 0.0],
        ("TRIAL", "ACTUAL_END_FIELD"): [150.0, 0.0],
        ("EVENT", "USED"): [2],
        ("EVENT", "LABELS"): ["Foot Strike", "Foot Off"],
        ("EVENT", "CONTEXTS"): ["Left", "Right"],
        ("EVENT", "TIMES"): np.array([[0.0, 0.0], [1.3, 1.1]]),
    }
    trial = reader.read(write_c3d(tmp_path / "a.c3d", some_points, parameters=parameters, first_frame=101))
    assert [(event.label, event.side) for event in trial.events] == [("foot off", "r"), ("initial contact", "l")]
    assert [event.time for event in trial.events] == pytest.approx([0.1, 0.3], abs=1e-6)


def test_a_rate_that_is_no_multiple_is_reported(tmp_path, write_c3d, some_points, some_analog, reader):
    path = write_c3d(tmp_path / "a.c3d", some_points, some_analog)
    content = path.read_bytes()
    at = content.index(np.float32(1000).tobytes())
    path.write_bytes(content[:at] + np.float32(1003).tobytes() + content[at + 4 :])
    trial = reader.read(path)
    (said,) = (finding.what for finding in trial.findings if finding.kind == "analog rate")
    assert says(said, "1003 Hz", "10.03 times", "100 Hz", "10 samples per frame", "1000 Hz")
    assert trial.stream("signals").rate_hz == 1000


def test_no_rate_is_refused(tmp_path, write_c3d, some_points, reader):
    path = write_c3d(tmp_path / "a.c3d", some_points)
    path.write_bytes(path.read_bytes().replace(np.float32(100).tobytes(), bytes(4)))
    with pytest.raises(SamplingError, match=r"a\.c3d.*POINT:RATE 0\.0 Hz"):
        reader.read(path)


def test_nothing_passes_that_names_a_person(tmp_path, write_c3d, some_points, some_analog, reader):
    person = "Zebulon"
    parameters = {
        ("SUBJECTS", "NAMES"): [person],
        ("SUBJECTS", "USED"): [1],
        ("TRIAL", "NOTE"): [f"{person} walks"],
        ("MANUFACTURER", "COMPANY"): [person],
        ("PROCESSING", "OPERATOR"): [person],
        ("POINT", "LABELS"): [f"{person}:LASI", f"{person}:RKneeAngles", f"{person}:T10"],
        ("POINT", "DESCRIPTIONS"): [person] * 3,
        ("POINT", "ANGLES"): [f"{person}:RKneeAngles"],
        ("ANALOG", "LABELS"): [f"{person} R TA", f"EMG {person}", f"{person}", "EMG1"],
        ("ANALOG", "DESCRIPTIONS"): [f"of {person}"] * 4,
        ("EVENT", "USED"): [1],
        ("EVENT", "LABELS"): [f"{person} stumbles"],
        ("EVENT", "CONTEXTS"): ["General"],
        ("EVENT", "SUBJECTS"): [person],
        ("EVENT", "TIMES"): np.array([[0.0], [0.1]]),
    }
    trial = reader.read(write_c3d(tmp_path / "a.c3d", some_points, some_analog, parameters))
    assert person.lower() not in _everything(trial).lower()
    assert trial.stream("kinematics").names[0] == "knee_angle_r"
    assert trial.events[0].label == "stumbles"


def test_a_folder_named_after_a_person_is_not_in_a_refusal(tmp_path, write_c3d, some_points, reader):
    (tmp_path / "Zebulon").mkdir()
    path = write_c3d(tmp_path / "Zebulon" / "a.c3d", some_points)
    path.write_bytes(path.read_bytes()[:-900])
    with pytest.raises(ReadError) as refusal:
        reader.read(path)
    assert "Zebulon" not in str(refusal.value)


# --- two readers


def test_the_second_reader_is_used_and_named(tmp_path, write_c3d, some_points, some_analog, reader, monkeypatch):
    path = write_c3d(tmp_path / "a.c3d", some_points, some_analog)
    crash = "it crashed (exit code -11)"
    monkeypatch.setattr(reader.process, "read", lambda *_, **__: ({"said": crash}, []))
    trial = reader.read(path)
    assert trial.stream("markers").source.reader.startswith("gaitdisc")
    np.testing.assert_allclose(trial.stream("markers").values[:, 0], some_points[0, 0] / 1000, rtol=1e-6)
    said = [finding.what for finding in trial.findings if finding.kind == "second reader"]
    assert said[0].endswith(f"ezc3d, which failed: {crash}")


def test_both_refusals_are_said(tmp_path, write_c3d, some_points, reader, monkeypatch):
    monkeypatch.setattr(reader.process, "read", lambda path, *_, **__: ({"said": f"no {path}"}, []))
    path = write_c3d(tmp_path / "a.c3d", some_points)
    content = path.read_bytes()  # of three points; of two by the header
    path.write_bytes(content[:2] + b"\2\0" + content[4:])
    with pytest.raises(ReadError, match=r"those of .* contradict each other .*ezc3d reports: .*no a\.c3d"):
        reader.read(path)


def test_a_file_that_vanishes_is_refused_in_words(tmp_path, write_c3d, some_points, reader, monkeypatch):
    path = write_c3d(tmp_path / "a.c3d", some_points)

    def vanishing(path, header):
        raise FileNotFoundError(2, "No such file or directory", str(path))

    monkeypatch.setattr("gaitdisc.ingest.c3d.read_c3d_parameters", vanishing)
    with pytest.raises(ReadError, match=r"a\.c3d.*file or directory"):
        reader.read(path)


# --- real files


def test_six_encodings_of_one_trial_are_one_trial(gait_data, reader):
    folder = gait_data / SAMPLES / "c3d_org_sample01"
    trials = {name: reader.read(folder / f"Eb015{name}.c3d") for name in ("pr", "pi", "vr", "vi", "sr", "si")}
    first = trials["pr"]
    assert first.stream("markers").values.shape == (450, 78)
    for name, trial in trials.items():
        for key, recording in first.streams.items():
            other = trial.stream(key)
            assert other.names == recording.names
            atol = 1e-4 if key == "markers" else 1e-3  # integers in steps of 1/12 mm
            np.testing.assert_allclose(other.values, recording.values, atol=atol, err_msg=f"{name} {key}")
        assert trial.stream("markers").source.reader.startswith("gaitdisc" if name[0] == "s" else "ezc3d")


def test_the_same_trial_in_other_forms(gait_data, reader):
    for names in (
        [f"c3d_org_sample08/TEST{letter}PI" for letter in "ABCD"],
        [f"c3d_org_sample02/{name}" for name in ("pc_real", "pc_int", "Dec_real")],
    ):
        first, *others = (reader.read(gait_data / SAMPLES / f"{name}.c3d") for name in names)
        for other in others:
            for key, recording in first.streams.items():
                np.testing.assert_allclose(other.stream(key).values, recording.values, atol=3e-4)


def test_every_sample_is_read_or_refused_in_words(gait_data, reader):
    refused = {}
    paths = sorted((gait_data / SAMPLES).rglob("*.c3d")) + sorted((gait_data / "opensim_walks").rglob("*.c3d"))
    for path in paths:
        try:
            trial = reader.read(path)
        except ReadError as error:
            refused[path.stem] = str(error)
        else:
            assert trial.streams, path.name
    assert len(paths) == 30
    assert set(refused) == {"bad_parameter_section", "sgi_int", "sgi_real"}
    assert all("points" in words for words in refused.values())


def test_sixteen_emg_channels_with_equal_labels_stay_sixteen(gait_data, reader):
    trial = reader.read(gait_data / "treadmill_c3d_emg/walking_1.c3d")
    emg = trial.stream("emg")
    assert emg.names == tuple(f"emg_5_{number}" for number in range(1, 17))
    assert emg.rate_hz == 1000
    assert len(np.unique(emg.values.std(axis=0))) == 16
    named = reader.read(gait_data / "treadmill_c3d_emg/walking_1.c3d", {"#19": "emg_sol_r", "#20": "emg_ta_r"})
    np.testing.assert_array_equal(named.stream("emg")["emg_sol_r"], emg["emg_5_1"])


def test_young_walkers(gait_data, reader):
    muscles = {f"emg_{muscle}_{side}" for muscle in ("rf", "ham", "gas", "ta", "tp") for side in "lr"}
    for path in sorted(gait_data.glob("young_straight_and_turn/*/straight/*.c3d")):
        trial = reader.read(path)
        assert set(trial.stream("emg").names) == muscles
        assert trial.stream("signals").names == ("Voltage.L Spare", "Voltage.R Spare")
        assert np.nanmax(trial.stream("forces")["plate_1_fz"]) > 250
        knee = trial.stream("kinematics")["knee_angle_r"]
        assert 40 < np.nanmax(knee) < 80
        assert -15 < np.nanmin(knee) < 15
        assert {event.label for event in trial.events} == {"initial contact", "foot off"}
        assert {event.side for event in trial.events} == {"l", "r"}
        assert all(0 <= event.time <= trial.stream("markers").time[-1] + 0.005 for event in trial.events)
        heel = trial.stream("markers")["RHEE.z"]
        assert -0.05 < np.nanmin(heel) < 0.1
