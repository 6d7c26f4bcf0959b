"""CSV and Parquet: units stated or known."""

import numpy as np
import pandas as pd
import pytest

from gaitdisc.errors import ReadError, SamplingError, UnitError
from gaitdisc.ingest.table import read_frame, read_table


def _read(tmp_path, text, channels=None, name="walk.csv"):
    path = tmp_path / name
    path.write_text(text, encoding="utf-8")
    return read_table(path, channels)


def test_units_are_converted_and_known_names_need_none(tmp_path):
    columns = {"ankle_angle_r": [10, 12, 13], "Sol_r [mV]": [1, 2, 2], "pelvis_tx [mm]": [1000, 1001, 1002]}
    table = pd.DataFrame({"Time": [0, 0.01, 0.02], **columns, "load [kN]": [2, 3, 4]})
    trial = _read(tmp_path, table.to_csv(index=False))
    np.testing.assert_allclose(trial.streams["kinematics"]["pelvis_tx"], [1.0, 1.001, 1.002], rtol=1e-15)
    assert trial.streams["emg"]["emg_sol_r"].tolist() == [0.001, 0.002, 0.002]
    assert trial.streams["signals"]["load"].tolist() == [2000, 3000, 4000]
    assert trial.streams["kinematics"].channels[0].unit == "deg"


def test_semicolons_decimal_commas_milliseconds_and_comments(tmp_path):
    trial = _read(tmp_path, "# from the lab\n#\ntime [ms];knee_angle_r\n0;1,5\n10;2,5\n20;3\n")
    assert trial.streams["kinematics"]["knee_angle_r"].tolist() == [1.5, 2.5, 3.0]
    np.testing.assert_allclose(trial.streams["kinematics"].time, [0, 0.01, 0.02])


def test_the_study_names_and_units(tmp_path):
    table = pd.DataFrame({"time_s": [0, 1], "ch1": [1, 3], "ch2": [2, 4]})
    trial = _read(
        tmp_path, table.to_csv(sep="\t", index=False), {"ch1": "emg_sol_r [mV]", "ch2": "knee_angle_r"}, "a.tsv"
    )
    assert trial.streams["emg"]["emg_sol_r"].tolist() == [0.001, 0.003]
    assert trial.streams["kinematics"]["knee_angle_r"].tolist() == [2, 4]


def test_the_study_ignores_columns_of_text_and_without_a_unit(tmp_path):
    text = "time,note,CH7,knee_angle_r\n0,ok,1,5\n0.01,,2,6\n"
    trial = _read(tmp_path, text, {"note": "ignore", "ch7": "ignore"})
    assert list(trial.streams) == ["kinematics"] and trial.streams["kinematics"].names == ("knee_angle_r",)
    frame = pd.read_csv(tmp_path / "walk.csv")
    assert read_frame(frame, {"note": "ignore", "CH7": "ignore"}).streams["kinematics"].names == ("knee_angle_r",)


@pytest.mark.parametrize(
    ("text", "times"),
    [
        ("Subject,Context,Name,Time (s),Description\nA,Right,Foot Strike,0.52,\nA,Left,General,0.6,\n", [0.52]),
        ("exported\nevent;side;time [ms]\nheel strike;r;520,5\nto;r;1210\n", [0.5205, 1.21]),
        ("RHS\tRTO\n0.52\t1.21\n1.66\t\n", [0.52, 1.21, 1.66]),
    ],
)
def test_a_table_of_events_gives_contacts_and_foot_offs(tmp_path, text, times):
    trial = _read(tmp_path, text)
    assert not trial.streams and [event.time for event in trial.events] == pytest.approx(times)
    assert {event.side for event in trial.events} == {"r"} and trial.events[0].label == "initial contact"


@pytest.mark.parametrize(
    ("text", "kind", "words"),
    [
        ("event,time\nheel strike,1.0\n", ReadError, "line 2: each initial .* must have a side; this line has none"),
        ("event,time\nleft heel strike,soon\n", ReadError, "line 2: the time of an event must be a number.*'soon'"),
        (
            "event;frame;side\nHS;124;R\n",
            ReadError,
            "events must have a column of times.*'event;frame;side'.*frame rate",
        ),
        (
            "time,foo\n0,1\n1,2\n",
            UnitError,
            r"column 'foo' must have a unit; neither .*\. Write 'foo \[unit\]' in the header",
        ),
        ("time,Sol_r\n0,1\n1,2\n", UnitError, 'the column seems to be emg_sol_r.*"Sol_r" = "emg_sol_r \\[unit\\]"'),
        ("time,foo [furlong]\n0,1\n1,2\n", UnitError, "column 'foo \\[furlong\\]' must be in the list of units"),
        ("knee_angle_r,hip\n0,1\n", ReadError, r"must have a column 'time \[s\]' .*; line 1 is 'knee_angle_r,hip'"),
        ("time [h],knee_angle_r\n0,1\n", ReadError, r"must have a column 'time \[s\]'"),
        ("time,,a\n0,1,2\n", ReadError, "column 2 has none"),
        ("time,\n0,1\n", ReadError, "column 2 has none"),
        ("time,[deg]\n0,1\n", ReadError, "column 2 has none"),
        ("time,knee_angle_r\n0,1\n1,x\n", ReadError, "line 3, column 'knee_angle_r'"),
        ("time,knee_angle_r\n0,1\n1,2\n3,2\n", SamplingError, "must have a constant rate; between line"),
        ("time,ground_force_r_vy\n0,1\n1,\n", ReadError, "ground_force_r_vy must have a number in every sample"),
        ("time,knee_angle_r\n", ReadError, "none follow line 1"),
        ("# nothing\n", ReadError, "walk.csv"),
    ],
)
def test_bad_tables_are_refused_in_words(tmp_path, text, kind, words):
    with pytest.raises(kind, match=words) as refusal:
        _read(tmp_path, text)
    assert "walk.csv" in str(refusal.value)


def test_radians_called_degrees_are_refused(tmp_path):
    rows = "".join(f"{i / 100},{0.5 * np.sin(i / 10)}\n" for i in range(100))
    with pytest.raises(UnitError, match="looks like radians"):
        _read(tmp_path, "time,hip_flexion_r\n" + rows)
    assert _read(tmp_path, "time,hip_flexion_r [rad]\n" + rows).streams["kinematics"].values.max() > 28


def test_bad_parquet_is_refused(tmp_path):
    path = tmp_path / "walk.parquet"
    for frame, words in [
        (pd.DataFrame({"time": [0.0, 1.0], "knee_angle_r": ["a", "b"]}), "column 'knee_angle_r' has type"),
        (pd.DataFrame({"knee_angle_r": [0.0, 1.0]}), r"'time \[s\]'.*columns are knee_angle_r"),
        (pd.DataFrame({"time": [0.0, 1.0], "knee_angle_r": [1, np.inf]}), "'knee_angle_r' contains infinite values"),
        (pd.DataFrame({"time": [], "knee_angle_r": []}, dtype=float), "no row"),
    ]:
        frame.to_parquet(path)
        with pytest.raises(ReadError, match=words):
            read_table(path)
    path.write_bytes(b"PAR1 something else PAR1")
    with pytest.raises(ReadError, match=r"walk\.parquet"):
        read_table(path)


def test_parquet_with_time_as_pandas_index_is_read(tmp_path):
    frame = pd.DataFrame({"knee_angle_r": [1, None, 3]}, index=pd.Index([0.0, 0.5, 1.0], name="time"))
    frame.to_parquet(tmp_path / "a.parquet")
    np.testing.assert_array_equal(read_table(tmp_path / "a.parquet").streams["kinematics"].values[:, 0], [1, np.nan, 3])


LEADING = """Subject,S07
Software,Motion Suite 4.1
Rate,100

Frame time (s),ankle
0.00,1.5
0.01,2.5
"""


def test_leading_lines_are_passed_over_and_the_study_names_the_time(tmp_path):
    channels = {"Frame time (s)": "time [s]", "ankle": "ankle_angle_r [deg]"}
    ankle = _read(tmp_path, LEADING, channels).streams["kinematics"]
    assert ankle["ankle_angle_r"].tolist() == [1.5, 2.5]
    assert ankle.time == pytest.approx([0.0, 0.01])
    plain = LEADING.replace("Frame time (s)", "time [s]")
    assert _read(tmp_path, plain, {"ankle": "ankle_angle_r [deg]"}).streams["kinematics"].rate_hz == pytest.approx(100)


def test_a_named_time_in_parquet_and_in_milliseconds(tmp_path):
    table = pd.DataFrame({"clock": [0.0, 10.0, 20.0], "knee_angle_r": [1.0, 2.0, 3.0]})
    table.to_parquet(tmp_path / "walk.parquet")
    knee = read_table(tmp_path / "walk.parquet", {"clock": "time [ms]"}).streams["kinematics"]
    assert knee.time == pytest.approx([0.0, 0.01, 0.02])


def test_a_table_without_a_time_says_how_to_name_it(tmp_path):
    with pytest.raises(ReadError, match=r"line 1 .*'Subject,S07'.*\"Frame time\""):
        _read(tmp_path, LEADING)
    far = "\n".join(["Comment,x"] * 60) + "\ntime [s],knee_angle_r\n0.0,1\n0.01,2\n"
    with pytest.raises(ReadError, match="line 1 is 'Comment,x'"):
        _read(tmp_path, far)


def test_a_line_of_units_below_the_header(tmp_path):
    path = tmp_path / "walk.csv"
    path.write_text("Nexus\nTrial 3\nTime,RKnee,emg_sol_r,Foot\nms,rad,mV,\n0,0.5,1,2\n10,0.25,2,3\n")
    trial = read_table(path, {"RKnee": "knee_angle_r", "Foot": "foot [V]"})
    np.testing.assert_allclose(trial.stream("kinematics")["knee_angle_r"], np.rad2deg([0.5, 0.25]))
    np.testing.assert_allclose(trial.stream("emg")["emg_sol_r"], [1e-3, 2e-3])
    assert trial.stream("signals").names == ("foot",) and trial.stream("signals").rate_hz == 100.0
    path.write_text("time,knee_angle_r\ns,left\n0,1\n0.01,2\n")
    with pytest.raises(ReadError, match=r"line 2.*must contain a number"):
        read_table(path)
