"""Tables and recordings: one clear refusal for each fault."""

import math
from dataclasses import replace

import numpy as np
import pandas as pd
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from gaitdisc.channel import Channel
from gaitdisc.errors import ChannelError, GaitdiscError, ReadError, UnitError
from gaitdisc.ingest.reading import read_trial
from gaitdisc.recording import Recording, Source
from gaitdisc.simulation.compiled_simulation import Rows
from gaitdisc.simulation.measured_table import gather_recordings, gather_table, read_measured
from gaitdisc.simulation.parts import Sensor
from gaitdisc.simulation.running import compile_simulation
from gaitdisc.simulation.simulation_file import parse_simulation

KNEE = """title = "shank"
[states.knee_angle_r]
unit = "rad"
[states.rate]
unit = "rad/s"
[inputs.knee_angle_r_moment]
unit = "N m"
[parameters.inertia]
value = 0.45
unit = "kg m^2"
[equations]
knee_angle_r = "rate"
rate = "knee_angle_r_moment/inertia"
"""


def _table(trials=("1", "2"), count=40):
    t = np.arange(count) / 100
    parts = [
        pd.DataFrame({"trial": name, "time": t, "tau": np.sin(t * 9), "phase": (t * 2) % 1, "theta": np.cos(t * 7)})
        for name in trials
    ]
    return pd.concat(parts, ignore_index=True)


def test_a_table_is_read(ankle, tmp_path):
    table = _table(("walk a", "walk b"))
    table.to_csv(tmp_path / "walk.csv", index=False)
    table.to_parquet(tmp_path / "walk.parquet")
    for ending in ("csv", "parquet"):
        measured = read_measured(tmp_path / f"walk.{ending}", ankle)
        assert measured.trials == ("walk a", "walk b")
        assert measured.channels == ("theta",)
        assert measured.drive.inputs.shape == (2, 40, 2)
        np.testing.assert_allclose(measured.observed[1, :, 0], table["theta"][40:], rtol=1e-12)
        assert [finding.kind for finding in measured.findings] == ["not measured"]
    assert ankle.observing(measured.channels).observations == (("theta", "theta"),)


def test_semicolons_with_decimal_commas(ankle, tmp_path):
    _table().to_csv(tmp_path / "walk.csv", index=False, sep=";", decimal=",")
    assert read_measured(tmp_path / "walk.csv", ankle).observed[0, 0, 0] == 1.0


def test_trial_numbers_keep_their_order_and_a_table_without_them_is_one_trial(ankle, tmp_path):
    _table((10, 9, 2)).to_csv(tmp_path / "walk.csv", index=False)
    assert read_measured(tmp_path / "walk.csv", ankle).trials == ("10", "9", "2")
    _table(("1",)).drop(columns="trial").to_csv(tmp_path / "walk.csv", index=False)
    assert read_measured(tmp_path / "walk.csv", ankle).trials == ("1",)


def _broken(change):
    table = _table().astype({"theta": object, "tau": object, "time": object, "trial": object})
    change(table)
    return table


def _set(row, column, value):
    return lambda table: table.__setitem__(column, [value if i == row else v for i, v in enumerate(table[column])])


@pytest.mark.parametrize(
    ("table", "kind", "words"),
    [
        (_table().rename(columns={"tau": "tau_a"}), ChannelError, "column 'tau'; walk.csv has trial, time, tau_a"),
        (_table().rename(columns={"theta": "Theta_"}), ChannelError, "tau, phase, Theta_, the nearest is 'Theta_'"),
        (_table().rename(columns={"time": "t"}), ChannelError, "must have a column 'time'"),
        (_table().rename(columns={"trial": "Trial"}), ChannelError, "the nearest is 'Trial'"),
        (_table().assign(extra=1).rename(columns={"extra": " tau"}), ChannelError, "'tau' twice"),
        (_broken(_set(47, "time", None)), ReadError, "row must have a time; walk.csv, line 49 (trial '2') has none"),
        (_broken(_set(5, "tau", "n.a.")), ReadError, "line 7 (trial '1'), column 'tau'"),
        (_broken(_set(5, "tau", "inf")), ReadError, "line 7 (trial '1'), column 'tau'"),
        (_broken(_set(9, "trial", None)), ReadError, "line 11 has none"),
    ],
)  # fmt: skip
def test_faults_are_told_with_their_place(ankle, tmp_path, table, kind, words):
    table.to_csv(tmp_path / "walk.csv", index=False)
    with pytest.raises(kind) as refusal:
        read_measured(tmp_path / "walk.csv", ankle)
    assert words in str(refusal.value)


def test_observations_that_the_file_lists_are_all_needed(ankle, tmp_path):
    _table().to_csv(tmp_path / "walk.csv", index=False)
    with pytest.raises(ChannelError, match="must have a column 'power'"):
        read_measured(tmp_path / "walk.csv", ankle.with_observation("power", "tau*omega").observing(["theta", "power"]))


@pytest.mark.parametrize("name", ["absent.csv", "walk.xlsx", "broken.parquet", "empty.csv", "ragged.csv"])
def test_files_that_are_no_table(ankle, tmp_path, name):
    (tmp_path / "broken.parquet").write_bytes(b"PAR1 no")
    (tmp_path / "empty.csv").write_text("")
    (tmp_path / "ragged.csv").write_text("trial,time\n1,2,3,4,5\n1,2\n,,,,,,,,\n")
    with pytest.raises(GaitdiscError) as refusal:
        read_measured(tmp_path / name, ankle)
    assert name in str(refusal.value)


def _recording(unit="deg", tau=None, quantity="angle"):
    t = np.arange(50) / 100
    channels = (Channel("theta", quantity, unit), Channel("tau", "moment", "N m"), Channel("phase", "signal", "1"))
    tau = np.cos(9 * t) if tau is None else tau
    return Recording(t, np.column_stack([np.sin(7 * t), tau, t % 1]), channels, source=Source("walk.mot"))


def test_recordings_are_converted(ankle):
    measured = gather_recordings([_recording(), _recording("rad")], ankle)
    np.testing.assert_allclose(measured.observed[0] / (math.pi / 180), measured.observed[1], atol=1e-12)
    assert measured.channels == ("theta",)


def test_suspect_samples_are_told(ankle):
    recording = _recording()
    marks = np.zeros((50, 3), bool)
    marks[3:9, 0] = True
    findings = gather_recordings([recording.with_values(recording.values, marks)], ankle).findings
    assert any(each.kind == "suspect" and "samples marked as unreliable: 6 of 50" in each.what for each in findings)


def test_a_real_walk_drives_a_knee(gait_data):
    """Inverse kinematics [deg] and inverse dynamics [N m] of one walk: converted, and a shank follows for 50 ms."""
    folder = gait_data / "opensim_walks" / "mrs_emg_walking"
    walk = read_trial([folder / "IK_gait.mot", folder / "ID_gait.sto"]).on_one_base(100.0)
    knee = parse_simulation(KNEE)
    measured = gather_recordings([walk], knee)
    np.testing.assert_allclose(np.degrees(measured.observed[0, :, 0]), walk["knee_angle_r"], rtol=1e-12)
    np.testing.assert_array_equal(measured.drive.inputs[0, :, 0], walk["knee_angle_r_moment"])
    begin = np.arange(0, 190, 20)
    angle = measured.observed[0, :, 0]
    rows = Rows(np.zeros(10, int), begin, np.column_stack([angle, np.gradient(angle, 0.01)])[begin])
    states, ok = compile_simulation(knee).run(measured.drive, rows, 20)
    assert ok.all()
    assert np.degrees(np.abs(states[:, 5, 0] - angle[begin + 5])).max() < 10


def test_recordings_with_faults(ankle):
    with pytest.raises(UnitError, match=r"'theta'.*walk\.mot.*'N m'"):
        gather_recordings([_recording("N m")], ankle)
    with pytest.raises(UnitError, match=r"same kind as 'K'.*walk\.mot has it in 'degC'; .* have an offset"):
        warm = replace(ankle, states=(replace(ankle.states[0], unit="K"), *ankle.states[1:]))
        gather_recordings([_recording("degC", quantity="signal")], warm)
    with pytest.raises(ReadError, match=r"walk.mot'?.*'tau': 21 rows.*0\.07 s"):
        absent = (np.arange(50) >= 7) & (np.arange(50) < 28)
        gather_recordings([_recording(tau=np.where(absent, np.nan, np.arange(50.0)))], ankle)
    with pytest.raises(ChannelError, match="must have a column 'tau'"):
        gather_recordings([_recording().selected(["theta", "phase"])], ankle)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda t: t.iloc[:0], r"a trial must have 20 samples; walk.parquet has no rows. Export"),
        (lambda t: t.assign(theta="a lot"), r"'a lot'; 80 such cells\. Write a number, or leave the cell empty"),
        (lambda t: t.rename(columns={"time": "time_ms"}), r"in seconds; walk.parquet has 'time_ms'. Convert this"),
        (lambda t: t.rename(columns={"time": "Time [ms]"}), r"walk.parquet has 'Time \[ms\]'. Convert this column"),
        (
            lambda t: t.assign(time=pd.to_datetime(t["time"], unit="s")),
            r"time in seconds; walk.parquet, column 'time' contains dates or clock times, first 1970.* Write seconds",
        ),
    ],
)
def test_columns_of_another_kind_are_refused_in_words(ankle, tmp_path, change, words):
    change(_table()).to_parquet(tmp_path / "walk.parquet")
    with pytest.raises(GaitdiscError, match=words):
        read_measured(tmp_path / "walk.parquet", ankle)


def test_a_doubled_column_of_parquet_is_refused_as_one_of_csv(ankle, tmp_path):
    table = pa.Table.from_pandas(_table())
    pq.write_table(table.append_column("theta", table["theta"]), tmp_path / "walk.parquet")
    with pytest.raises(ChannelError, match=r"walk.parquet.*'theta'"):
        read_measured(tmp_path / "walk.parquet", ankle)


def test_empty_cells_of_a_channel_are_read_as_missing(ankle, tmp_path):
    _broken(_set(47, "theta", None)).to_csv(tmp_path / "walk.csv", index=False)
    measured = read_measured(tmp_path / "walk.csv", ankle)
    assert np.argwhere(np.isnan(measured.observed)).tolist() == [[1, 7, 0]]
    assert "empty cells" in [one.kind for one in measured.findings]


def test_recordings_are_converted_to_the_unit_of_the_observation(ankle):
    told = ankle.with_observation("theta", "57.2958*theta").observing(["theta"]).with_sensor(Sensor("theta", "deg"))
    observed = gather_recordings([_recording("rad"), _recording("deg")], told).observed
    np.testing.assert_allclose(observed[0], observed[1] / (math.pi / 180), atol=1e-9)


def test_a_table_in_memory_is_read_as_its_file_and_left_as_it_is(ankle, tmp_path):
    table = _table().rename(columns={"theta": " theta "}).iloc[::-1].iloc[::-1]
    table.to_csv(tmp_path / "walk.csv", index=False)
    before = table.copy()
    of_file, of_table = read_measured(tmp_path / "walk.csv", ankle), gather_table(table, ankle, "the table")
    np.testing.assert_allclose(of_table.observed, of_file.observed, rtol=1e-12)
    assert of_table.source == "the table" and of_table.trials == of_file.trials
    pd.testing.assert_frame_equal(table, before)
    with pytest.raises(ChannelError, match="the table has 'tau' twice"):
        gather_table(pd.concat([table, table[["tau"]]], axis="columns"), ankle, "the table")
