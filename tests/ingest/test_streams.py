"""Numbers of a table, its clock, and its columns as streams; what is none is said, forces that lack are refused."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from gaitdisc.channel import vocabulary
from gaitdisc.errors import ChannelError, ReadError, SamplingError
from gaitdisc.ingest.cells import Form, even_time, parse_cells, printed_digit
from gaitdisc.ingest.columns import column_in_unit, find_stream, name_channel, sort_trial
from gaitdisc.ingest.reading import read_trial
from gaitdisc.recording import Source

TIME = np.arange(5) / 100
SOURCE = Source("walk.mot", "0" * 64, "mot")


def _trial(*names, values=None):
    table = np.ones((5, len(names))) if values is None else values
    return sort_trial(
        SOURCE, TIME, table, [column_in_unit(n, name_channel(n), name_channel(n).unit, "") for n in names]
    )


def test_every_channel_of_the_vocabulary_has_its_stream():
    streams = {channel.name: find_stream(channel) for channel in vocabulary().channels}
    assert streams["knee_angle_r"] == streams["pelvis_tx"] == "kinematics"
    assert streams["ground_force_r_vy"] == streams["ground_force_r_px"] == streams["ground_torque_r_y"] == "forces"
    assert streams["knee_angle_r_moment"] == "moments"
    assert streams["emg_sol_r"] == "emg"


def test_one_file_gives_several_streams_on_one_base():
    trial = _trial("knee_angle_r", "emg_sol_r", "RHEE.x", "sync")
    assert set(trial.streams) == {"kinematics", "emg", "markers", "signals"}
    assert trial.name == "walk"
    assert trial.streams["emg"].source == SOURCE


@pytest.mark.parametrize("name", ["ground_force_r_vx", "ground_force_r_vy", "pelvis_tx_force"])
def test_nan_in_a_force_is_refused_with_sample_and_time(name):
    values = np.ones((5, 1))
    values[2:4] = np.nan
    with pytest.raises(ReadError, match=rf"{name}.*2 of 5.*sample 3.*0\.02 s"):
        _trial(name, values=values)


def test_gaps_elsewhere_stay_for_the_quality_checks():
    values = np.ones((5, 2))
    values[1, 0] = values[2, 1] = np.nan
    trial = _trial("knee_angle_r", "ground_force_r_px", values=values)
    assert np.isnan(trial.streams["kinematics"].values[1, 0])
    assert trial.findings == ()


def test_two_columns_of_one_channel_are_refused():
    with pytest.raises(ChannelError, match=r"walk\.mot.*'sync'.*columns 2.*4"):
        _trial("sync", "a", "sync")


@pytest.mark.parametrize("rate_hz", [100.0, 1000.0, 2000.0])
def test_milliseconds_under_the_name_of_seconds_are_refused(tmp_path, rate_hz):
    time = np.arange(400) / rate_hz
    knee = 30 * np.sin(6 * time)
    rows = "\n".join(f"{1000 * t:g},{value}" for t, value in zip(time, knee, strict=True))
    (tmp_path / "walk.csv").write_text(f"time,knee_angle_r [deg]\n{rows}\n")
    said = rf"knee_angle_r .*0\.2 s.* {1000 / rate_hz:g} s apart, so 400"
    with pytest.raises(SamplingError, match=said):
        read_trial(tmp_path / "walk.csv")
    (tmp_path / "walk.csv").write_text(f"time [ms],knee_angle_r [deg]\n{rows}\n")
    assert read_trial(tmp_path / "walk.csv").stream("kinematics").rate_hz == pytest.approx(rate_hz)
    (tmp_path / "tank.csv").write_text(f"time,level\n{rows}\n")  # no walk: any rate
    assert read_trial(tmp_path / "tank.csv", {"level": "level [1]"}).stream("signals").rate_hz < 5


LABELS = ["time", "a", "b"]


@given(arrays(float, st.tuples(st.integers(1, 6), st.just(3)), elements=st.floats(allow_infinity=False)))
def test_every_number_comes_back_to_the_last_bit(table):
    lines = ["\t".join(map(repr, row)) for row in table.tolist()]
    np.testing.assert_array_equal(parse_cells(lines, LABELS, 1, Form("a.mot")).values, table)


@pytest.mark.parametrize("blank", ["", "  ", "nan", "NaN", "-nan(ind)", "1.#QNAN"])
def test_blank_cells_and_all_spellings_of_nan_are_missing(blank):
    cells = parse_cells([f"0\t{blank}\t1", f"1\t2\t{blank}"], LABELS, 1, Form("a.mot"))
    np.testing.assert_array_equal(cells.values, [[0, np.nan, 1], [1, 2, np.nan]])


def test_trailing_tabs_and_blank_lines_are_passed_over():
    cells = parse_cells(["0\t1\t2\t", "", "1\t2\t3\t\t", "2\t3\t4"], LABELS, 5, Form("a.mot"))
    assert cells.values[:, 2].tolist() == [2, 3, 4]
    assert cells.lines.tolist() == [5, 7, 8]
    assert cells.rows == ["0\t1\t2", "1\t2\t3", "2\t3\t4"]


def test_blanks_separate_and_a_comma_may_be_the_decimal_sign():
    assert parse_cells([" 0  1\t2"], LABELS, 1, Form("a", " ")).values.tolist() == [[0, 1, 2]]
    assert parse_cells(["0,5;1;2,25"], LABELS, 1, Form("a", ";", ",")).values.tolist() == [[0.5, 1, 2.25]]
    assert parse_cells(["0,5;-nan(ind);2,25"], LABELS, 1, Form("a", ";", ",")).values[0, 2] == 2.25


@pytest.mark.parametrize("word", ["abc", "1.2.3", "inf", "-Infinity", "1e999", "1_000", "0x10", "--"])
def test_a_cell_that_is_no_number_is_named_with_line_and_column(word):
    with pytest.raises(ReadError, match=r"a\.mot.*line 12.*'b'"):
        parse_cells(["0\t1\t2", f"1\t2\t{word}"], LABELS, 11, Form("a.mot"))


def test_short_and_long_rows_are_named_and_none_are_refused():
    with pytest.raises(ReadError, match=r"3 cells.*line 12.*2"):
        parse_cells(["0\t1\t2", "1\t2"], LABELS, 11, Form("a.mot"))
    with pytest.raises(ReadError, match=r"line 11 has 2"):
        parse_cells(["0\t1", "1\t2\t3"], LABELS, 11, Form("a.mot"))
    with pytest.raises(ReadError, match=r"line 12 has 4"):
        parse_cells(["0\t1\t2", "1\t2\t3\t4"], LABELS, 11, Form("a.mot"))
    with pytest.raises(ReadError, match="none follow line 10"):
        parse_cells(["", "  "], LABELS, 11, Form("a.mot"))


def test_printed_digit_is_the_finest_one():
    assert printed_digit(["0", "0.45", "0.451"]) == 1e-3
    assert printed_digit(["  1.501e-03"]) == pytest.approx(1e-6)
    assert printed_digit(["3", "words", "nan"]) == 1.0
    assert printed_digit(["0,25"]) == 0.01


def test_zeros_that_fill_up_a_number_are_no_digits():
    """Times rounded to ms and printed with six digits, as OpenSim's own marker files have them."""
    assert printed_digit(["0.000000", "0.017000", "0.033000"]) == 1e-3
    assert printed_digit(["100", "200"]) == 1.0


@given(
    st.sampled_from([50.0, 59.94, 60.0, 100.0, 120.0, 148.148, 200.0, 250.0, 1000.0]),
    st.integers(3, 3000),
    st.floats(0, 500),
)
def test_rounded_times_come_back_even_and_near(rate, count, start):
    true = start + np.arange(count) / rate
    digit = 10.0 ** -np.ceil(np.log10(rate / 0.3))
    printed = np.round(true / digit) * digit
    even = even_time(printed, digit, "a.mot")
    assert np.ptp(np.diff(even)) < 1e-9
    assert np.abs(even - true).max() < 2.1 * digit


def test_an_even_base_is_left_as_it_is():
    time = 0.1 + np.arange(100) / 60
    assert even_time(time, 1e-16, "a.mot") is time


def test_a_whole_rate_is_found_behind_the_digits():
    time = np.round(np.arange(601) / 60, 3)
    assert 1 / np.diff(even_time(time, 1e-3, "a.mot")).mean() == pytest.approx(60, abs=1e-9)


@pytest.mark.parametrize("digits", [2, 3, 8])
def test_one_missing_sample_is_not_taken_for_rounding(digits):
    time = np.delete(np.round(np.arange(1000) / 100, digits), 500)
    with pytest.raises(SamplingError, match=r"line 511.*line 512.*0\.02 s.*4\.99 s"):
        even_time(time, 10.0**-digits, "a.mot", np.arange(12, 12 + 999))


def test_too_few_digits_are_refused():
    with pytest.raises(SamplingError, match=r"resolution of 1e-02 s"):
        even_time(np.round(np.arange(100) / 60, 2), 1e-2, "a.mot")


@pytest.mark.parametrize(
    ("time", "words"),
    [
        ([0.0], "at least two samples; it has 1"),
        ([0.0, np.nan, 2.0], "every sample must have a time; row 2 has nan"),
        ([0.0, 1.0, 1.0], "time must increase; row 3 has t = 1 s after 1 s"),
        ([0.0, 1.0, 0.5], "time must increase"),
    ],
)
def test_times_that_are_none_are_refused(time, words):
    with pytest.raises(SamplingError, match=words):
        even_time(np.array(time), 0.1, "a.mot")
