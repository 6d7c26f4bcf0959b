"""OpenSim storage files: headers of both styles, real files of every dialect."""

import hashlib

import numpy as np
import pytest
from texts import says

from gaitdisc.channel import Channel, vocabulary
from gaitdisc.errors import ChannelError, ReadError, SamplingError, UnitError
from gaitdisc.ingest.storage import parse_header, read_storage, write_storage
from gaitdisc.recording import Recording

BODY = "time\tknee_angle_r\tpelvis_tx\n" + "".join(f"{i / 100}\t{30 + 30 * np.sin(i)}\t{i}\n" for i in range(60))
HIP = vocabulary().named("hip_flexion_r")
HEAD = "Coordinates\nversion=1\nnRows=60\nnColumns=3\ninDegrees=yes\nendheader\n"


def _written(tmp_path, text, name="walk.mot"):
    path = tmp_path / name
    path.write_text(text)
    return path


def test_degrees_of_a_real_ik_file(gait_data):
    path = gait_data / "exotendon_run" / "c3d_Trimmed_running_natural2_manual_scaling_ik.mot"
    trial = read_storage(path)
    walk = trial.streams["kinematics"]
    assert walk.values.shape == (6047, 39)
    assert walk.rate_hz == 100.0
    assert walk["hip_flexion_r"][0] == 32.63556900
    assert walk["pelvis_tx"][-1] == 1.12326431
    assert walk.channels[walk.index("mtp_angle_l")].unit == "deg"
    # the copied coordinate stands in radians in this file of degrees
    np.testing.assert_allclose(walk["knee_angle_r_beta"], walk["knee_angle_r"], atol=0.01)
    assert walk.source.sha256 == hashlib.sha256(path.read_bytes()).hexdigest()
    assert [finding.kind for finding in trial.findings] == ["mixed units"]


def test_radians_paths_and_a_wrong_count_of_a_moco_file(gait_data):
    trial = read_storage(gait_data / "opensim_walks" / "moco_3dwalking" / "coordinates.sto")
    walk = trial.streams["kinematics"]
    assert walk.values.shape == (1350, 31)
    assert walk["hip_flexion_r"][0] == pytest.approx(np.degrees(0.3965801380677928))
    assert walk["pelvis_tx"][0] == 0.00987536
    np.testing.assert_allclose(walk["knee_angle_r_beta"], walk["knee_angle_r"], atol=0.01)  # in degrees in this one
    assert any(says(finding.what, "40 columns", "32") for finding in trial.findings)


def test_simm_header_trailing_tabs_and_capital_time_of_an_emg_file(gait_data):
    trial = read_storage(gait_data / "opensim_walks" / "mrs_emg_walking" / "EMG_gait.mot")
    emg = trial.streams["emg"]
    assert emg.values.shape == (4610, 24)
    assert emg["emg_hamlat_r"][0] == -0.3956014228  # not shifted by the tab at the end of its line
    assert emg["emg_rf_r"][0] == -0.0420625351
    assert {channel.unit for channel in emg.channels} == {"1"}
    assert (emg.rate_hz, emg.time[0], emg.time[-1]) == (1000.0, 0.001, 4.61)


def test_emg_without_sides(gait_data):
    trial = read_storage(
        gait_data / "opensim_walks" / "moco_3dwalking" / "electromyography.sto", {"soleus": "emg_sol_r"}
    )
    emg = trial.streams["emg"]
    assert emg.names[:2] == ("emg_sol_r", "emg_gas")
    assert emg["emg_sol_r"][0] == 9.669363727051634438e-03
    assert emg.rate_hz == 2000.0
    assert any("the label does not name the side" in finding.what for finding in trial.findings)


def test_ground_forces_of_both_naming_habits(gait_data):
    folder = gait_data / "opensim_walks"
    one = read_storage(folder / "moco_3dwalking" / "grf_walk.mot").streams["forces"]
    assert one["ground_force_r_px"][0] == 331.7057913303967
    assert one["ground_force_r_vy"].max() == pytest.approx(942.327988, abs=1e-6)
    trial = read_storage(folder / "mrs_emg_walking" / "GRF_gait.mot")
    other = trial.streams["forces"]
    assert other["ground_force_l_vy"].max() == pytest.approx(671.671639, abs=1e-6)  # called 1_ground_force_vy
    assert [c.unit for c in other.channels if c.name.endswith(("_py", "_x"))] == ["m", "m", "N m", "N m"]
    assert any("as the right foot" in finding.what for finding in trial.findings)


def test_plates_without_a_foot_are_said_until_the_study_names_it(tmp_path):
    labels = ("ground_force_1_vx", "ground_force_1_vy")
    rows = "".join(f"{i}\t1\t1\n" for i in range(9))
    file = _written(tmp_path, "\t".join(["forces\nendheader\ntime", *labels]) + "\n" + rows)
    (found,) = [one for one in read_storage(file).findings if one.severity == "warning"]
    assert found.what.startswith(", ".join(labels))
    assert found.spoils.endswith('"ground_force_1_vx" = "ground_force_r_vx [N]"')
    mapped = read_storage(file, {name: f"{name.replace('1', 'r')} [N]" for name in labels})
    assert mapped.streams["forces"].names == ("ground_force_r_vx", "ground_force_r_vy") and not mapped.findings


def test_joint_moments(gait_data):
    trial = read_storage(gait_data / "opensim_walks" / "moco_3dwalking" / "id_walk.sto")
    moments = trial.streams["moments"]
    assert moments["knee_angle_r_moment"][0] == -64.24946116
    units = {channel.name: channel.unit for channel in moments.channels}
    assert (units["pelvis_tx_force"], units["pelvis_tilt_moment"]) == ("N", "N m")


def test_treadmill_files_have_their_published_length(gait_data):
    walk = read_storage(gait_data / "treadmill_walk_ik" / "S01DE504_ik.mot").streams["kinematics"]
    assert len(walk.time) == 2100
    assert walk["pelvis_tilt"][0] == -3.26085957


def test_the_writer_states_degrees_and_refuses_names_with_tabs(tmp_path):
    recording = Recording(np.arange(3.0), np.zeros((3, 1)), (Channel("a\tb", "signal", "1"),))
    with pytest.raises(ChannelError, match="tabs"):
        write_storage(recording, tmp_path / "a.mot")
    path = write_storage(Recording(np.arange(3.0), np.zeros((3, 1)), (HIP,)), tmp_path / "a.mot")
    assert says(path.read_text(), "inDegrees=yes\n", "endheader\ntime\thip_flexion_r\n0.0\t0.0")


def test_translations_are_never_scaled(tmp_path):
    radians = BODY.replace("knee_angle_r", "mtp_angle_r")
    text = HEAD.replace("yes", "no") + "\n".join(
        line if i == 0 or not line else "\t".join([line.split("\t")[0], "0.5", line.split("\t")[2]])
        for i, line in enumerate(radians.split("\n"))
    )
    walk = read_storage(_written(tmp_path, text)).streams["kinematics"]
    assert walk["mtp_angle_r"][0] == pytest.approx(np.degrees(0.5))
    assert walk["pelvis_tx"][-1] == 59.0


def test_a_silent_header_is_inferred_or_refused(tmp_path):
    silent = HEAD.replace("inDegrees=yes\n", "")
    trial = read_storage(_written(tmp_path, silent + BODY))
    assert any(finding.kind == "unit inferred" and "read as deg" in finding.what for finding in trial.findings)
    still = "time\tknee_angle_r\tpelvis_tx\n" + "".join(f"{i / 100}\t0.5\t0\n" for i in range(60))
    with pytest.raises(UnitError, match=r"walk\.mot"):
        read_storage(_written(tmp_path, silent + still))


@pytest.mark.parametrize(
    ("change", "kind", "words"),
    [
        (lambda t: t.replace("inDegrees=yes", "inDegrees=no"), UnitError, "knee_angle_r reaches"),
        (lambda t: t[: t.index("0.3\t") - 1], ReadError, r"60 rows .*; it ends after 30 rows, at line 37\. The file"),
        (lambda t: t[: t.index("0.3\t") + 12], ReadError, "3 cells, one per column; line 38 .the last line. has 2"),
        (
            lambda t: t.replace("0.3\t", "0.305\t"),
            SamplingError,
            "between line 37 and line 38|between line 38 and line 39",
        ),
        (lambda t: t.replace("0.3\t", "abc\t"), ReadError, "line 38, column 'time'"),
        (lambda t: t.replace("pelvis_tx", "knee_angle_r"), ChannelError, "'knee_angle_r' in columns 2 and 3"),
        (lambda t: "\x00" + t, ReadError, "binary data"),
        (lambda t: t.split("time")[0], ReadError, "must have a line of labels"),
        (lambda t: t.split("0.0\t")[0], ReadError, "none follow line 7"),
    ],
)
def test_bad_files_are_refused_with_the_place(tmp_path, change, kind, words):
    with pytest.raises(kind, match=words) as refusal:
        read_storage(_written(tmp_path, change(HEAD + BODY)))
    assert "walk.mot" in str(refusal.value)


def test_a_last_number_that_was_cut_is_refused_where_all_lines_are_of_one_width(tmp_path):
    rows = "".join(f"{i / 100:12.8f}\t{40 * np.sin(i):14.8f}\n" for i in range(60))
    text = "Coordinates\ninDegrees=yes\nendheader\ntime\tknee_angle_r\n" + rows
    read_storage(_written(tmp_path, text[:-1]))
    with pytest.raises(ReadError, match=r"27 characters.*line 64.*24"):
        read_storage(_written(tmp_path, text[:-4]))


def test_more_rows_than_the_header_claims_are_reported(tmp_path):
    trial = read_storage(_written(tmp_path, (HEAD + BODY).replace("nRows=60", "nRows=50")))
    assert len(trial.findings) == 1 and says(trial.findings[0].what, "50 rows", "60")


def test_a_header_of_too_many_rows_is_read_where_the_file_ends_with_a_line(tmp_path):
    rows = "".join(f"{i / 100}\t{40 * np.sin(i)}\n" for i in range(200))
    text = "Coordinates\ndatarows 301\ninDegrees=\nendheader\ntime\tknee_angle_r\n" + rows
    (finding,) = read_storage(_written(tmp_path, text)).findings[:1]
    assert says(finding.what, "301 rows", "200") and says(finding.spoils, "end", "incomplete")
    with pytest.raises(ReadError, match="incomplete"):
        read_storage(_written(tmp_path, text[:-1]))


def test_both_styles_at_once_as_in_the_emg_file_of_an_example():
    lines = ["EMG.mot", "nRows=4", "nColumns=3", "", "name EMG.mot", "datacolumns 3", "datarows 5", "range 0.1 4.6"]
    header = parse_header([*lines, "endheader", "Time\tHamL_r\tTA_r\t", "0\t1\t2"], "EMG.mot")
    assert header.title == "EMG.mot"
    assert header.labels == ("Time", "HamL_r", "TA_r")
    assert (header.rows, header.columns) == ((4, 5), (3, 3))
    assert header.degrees is None
    assert header.body_line == 11


@pytest.mark.parametrize(("word", "degrees"), [("yes", True), ("no", False), ("YES ", True), (" n", False)])
def test_in_degrees_is_read(word, degrees):
    assert parse_header([f"inDegrees={word}", "EndHeader", "", "time a b", "0 1 2"], "a.mot").degrees is degrees


def test_comments_blank_lines_and_blanks_between_labels_are_read():
    lines = ["Coordinates", "", "Angles are in degrees (inDegrees).", "endheader", "", "time  a   b"]
    header = parse_header(lines, "a.mot")
    assert (header.labels, header.separator, header.body_line) == (("time", "a", "b"), " ", 7)


def test_columns_that_we_wrote_ourselves_describe_themselves():
    lines = ["x", "column 2=emg [V] r", "column 3=signal [deg/s]", "endheader", "time\ta\tb\tc"]
    assert parse_header(lines, "a.sto").own == {2: ("emg", "V", "r"), 3: ("signal", "deg/s", "")}


@pytest.mark.parametrize(
    ("lines", "words"),
    [
        (["time,a", "0,1"], "header ends with the line 'endheader'; none of its 2 lines is 'endheader'"),
        (["x", "endheadr", "time\ta"], "the nearest is 'endheadr'"),
        (["endheader"], "must have a line of labels after 'endheader'.*; line 1 begins with ''"),
        (["endheader", "knee\thip"], "line 2 begins with 'knee'"),
        (["endheader", "time"], "line 2: time is the only column"),
        (["endheader", "time\ta\t\tb"], "line 2: label 3 is blank"),
        (["endheader", "time\t[deg]"], "line 2: label 2 is blank"),
        (["nRows=many", "endheader", "time\ta"], "line 1 must have a whole number after 'nrows'; found 'many'"),
        (["inDegrees=maybe", "endheader", "time\ta"], "line 1 must be inDegrees=yes or inDegrees=no; found 'maybe'"),
    ],
)
def test_what_is_no_header_is_refused_with_its_line(lines, words):
    with pytest.raises(ReadError, match=words) as refusal:
        parse_header(lines, "a.mot")
    assert str(refusal.value).startswith("a.mot")
