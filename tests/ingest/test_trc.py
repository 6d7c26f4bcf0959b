"""Marker files, real and broken."""

import numpy as np
import pytest
from texts import says

from gaitdisc.errors import ReadError, SamplingError, UnitError
from gaitdisc.ingest.trc import parse_trc_header, read_trc

ROWS = "".join(f"{i + 1}\t{i / 100:.3f}\t{i}\t2\t3\t{10 * i + 1}\t\t30\n" for i in range(10))
TEXT = (
    "PathFileType\t4\t(X/Y/Z)\ta.trc\nDataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\n100\t100\t10\t2\tmm\n"
    "Frame#\tTime\tRHEE\t\t\tLHEE\n\t\tX1\tY1\tZ1\tX2\tY2\tZ2\n\n" + ROWS
)


def _read(tmp_path, text, channels=None):
    path = tmp_path / "a.trc"
    path.write_text(text)
    return read_trc(path, channels)


def test_millimetres_of_a_real_file(gait_data):
    trial = read_trc(gait_data / "opensim_walks" / "moco_3dwalking" / "markers_walk.trc")
    markers = trial.streams["markers"]
    assert markers.values.shape == (238, 123)
    assert markers["R.Shoulder.x"][0] == pytest.approx(-0.652630)
    assert markers["L.Toe.x"][-1] == pytest.approx(2.461683)
    assert (markers.rate_hz, markers.channels[0].unit) == (100.0, "m")
    assert trial.findings == ()


def test_shifted_labels_and_zeros_of_a_real_file(gait_data):
    trial = read_trc(gait_data / "opensim_walks" / "mrs_emg_walking" / "TRC_gait.trc")
    markers = trial.streams["markers"]
    assert markers.values.shape == (461, 3 * 59)
    assert markers["LASI.x"][0] == -2.4085  # its label stands one column further right
    assert markers["RASI.z"][0] == -0.12681
    assert np.isnan(markers["LASI.x"][-1])  # 0 0 0 in the file
    assert int(np.isnan(markers["LASI.x"]).sum()) == 106


def test_milliseconds_printed_with_six_digits_are_a_clock_of_60_hz(gait_data):
    folder = gait_data.parent / "opensim_gait10dof" / "ExperimentalData"
    if not folder.is_dir():
        pytest.skip(f"real recordings are absent: {folder}")
    for name, frames in (("subject01_static.trc", 300), ("subject01_walk.trc", 151)):
        markers = read_trc(folder / name).streams["markers"]
        assert (len(markers.time), markers.rate_hz) == (frames, 60.0)


def test_units_blanks_and_clock(tmp_path):
    markers = _read(tmp_path, TEXT).streams["markers"]
    assert markers.names == ("RHEE.x", "RHEE.y", "RHEE.z", "LHEE.x", "LHEE.y", "LHEE.z")
    np.testing.assert_allclose(markers["LHEE.x"], (10 * np.arange(10) + 1) / 1000)
    assert np.isnan(markers["LHEE.y"]).all()
    metres = _read(tmp_path, TEXT.replace("\tmm\n", "\tm\n")).streams["markers"]
    np.testing.assert_allclose(metres["RHEE.y"], 2.0)


def test_names_of_subjects_are_dropped_and_labels_mapped(tmp_path):
    text = TEXT.replace("RHEE", "Anna:RHEE").replace("LHEE", "Anna:LHEE")
    trial = _read(tmp_path, text, {"LHEE": "heel_l"})
    assert trial.streams["markers"].names[::3] == ("RHEE.x", "heel_l.x")
    assert trial.findings[0].kind == "identifier"
    assert "Anna" not in repr(trial.findings) + repr(trial.streams["markers"].channels)


@pytest.mark.parametrize(
    ("old", "new", "kind", "words"),
    [
        ("PathFileType", "PathType", ReadError, "first line begins with 'PathFileType'"),
        ("\tUnits", "", ReadError, "Units is"),
        ("\tmm\n", "\tkg\n", UnitError, "Units is 'kg'"),
        ("\t10\t2\t", "\tten\t2\t", ReadError, "NumFrames in line 3 must be above 0; found 'ten'"),
        ("\n100\t", "\n50\t", SamplingError, r"DataRate states 50 Hz, but the times step by 0.01 s \(100 Hz\)"),
        ("\t41\t\t30\n", "\t41\n", ReadError, "must have 8 cells, one per column; line 11 has 6"),
        ("\t41\t", "\tx\t", ReadError, r"line 11, column 'LHEE\.x'"),
        ("5\t0.040", "5\t0.035", SamplingError, "constant rate"),
    ],
)
def test_bad_files_are_refused_in_words(tmp_path, old, new, kind, words):
    assert old in TEXT
    with pytest.raises(kind, match=words) as refusal:
        _read(tmp_path, TEXT.replace(old, new))
    assert "a.trc" in str(refusal.value)


def test_fewer_frames_than_the_header_says_are_read_where_the_last_line_is_whole(tmp_path):
    text = TEXT.replace("\t10\t2\t", "\t12\t2\t")
    (finding,) = _read(tmp_path, text).findings[:1]
    assert says(finding.what, "12 frames", "10") and says(finding.spoils, "end", "incomplete")
    with pytest.raises(ReadError, match=r"have 12 frames,.* ends after 10 frames, at line 16"):
        _read(tmp_path, text.rstrip("\n"))


def test_equal_labels_are_numbered_as_in_a_c3d_file(tmp_path):
    trial = _read(tmp_path, TEXT.replace("LHEE", "RHEE"), {"RHEE_2": "heel_l"})
    assert trial.streams["markers"].names[::3] == ("RHEE_1.x", "heel_l.x")
    assert [finding.kind for finding in trial.findings] == ["equal labels"]


def test_wrong_counts_that_do_no_harm_are_reported(tmp_path):
    trial = _read(tmp_path, TEXT.replace("\t10\t2\t", "\t9\t3\t"))
    frames, markers = (f.what for f in trial.findings if f.kind == "wrong count")
    assert says(frames, "9 frames", "10") and says(markers, "3 markers", "2")


def test_a_header_without_markers_is_refused():
    with pytest.raises(ReadError, match=r"name its markers in line 4"):
        parse_trc_header([*TEXT.split("\n")[:3], "Frame#\tTime\t\t"], "a.trc")
