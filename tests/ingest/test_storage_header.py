"""Headers of both styles, and the words for what is none."""

from __future__ import annotations

import pytest

from gaitdisc.errors import ReadError
from gaitdisc.ingest.storage import parsed_header


def test_both_styles_at_once_as_in_the_emg_file_of_an_example():
    lines = ["EMG.mot", "nRows=4", "nColumns=3", "", "name EMG.mot", "datacolumns 3", "datarows 5", "range 0.1 4.6"]
    header = parsed_header([*lines, "endheader", "Time\tHamL_r\tTA_r\t", "0\t1\t2"], "EMG.mot")
    assert header.title == "EMG.mot"
    assert header.labels == ("Time", "HamL_r", "TA_r")
    assert (header.rows, header.columns) == ((4, 5), (3, 3))
    assert header.degrees is None
    assert header.body_line == 11


@pytest.mark.parametrize(("word", "degrees"), [("yes", True), ("no", False), ("YES ", True), (" n", False)])
def test_in_degrees_is_read(word, degrees):
    assert parsed_header([f"inDegrees={word}", "EndHeader", "", "time a b", "0 1 2"], "a.mot").degrees is degrees


def test_comments_blank_lines_and_blanks_between_labels_are_read():
    lines = ["Coordinates", "", "Angles are in degrees (inDegrees).", "endheader", "", "time  a   b"]
    header = parsed_header(lines, "a.mot")
    assert (header.labels, header.separator, header.body_line) == (("time", "a", "b"), " ", 7)


def test_columns_that_we_wrote_ourselves_describe_themselves():
    lines = ["x", "column 2=emg [V] r", "column 3=signal [deg/s]", "endheader", "time\ta\tb\tc"]
    assert parsed_header(lines, "a.sto").own == {2: ("emg", "V", "r"), 3: ("signal", "deg/s", "")}


@pytest.mark.parametrize(
    ("lines", "words"),
    [
        (["time,a", "0,1"], "header ends with the line 'endheader'; none of its 2 lines is that"),
        (["x", "endheadr", "time\ta"], "the nearest is 'endheadr'"),
        (["endheader"], "needs a line of labels after 'endheader'.*; line 1 begins with ''"),
        (["endheader", "knee\thip"], "line 2 begins with 'knee'"),
        (["endheader", "time"], "line 2: there is time alone"),
        (["endheader", "time\ta\t\tb"], "line 2: label 3 is blank"),
        (["endheader", "time\t[deg]"], "line 2: label 2 is blank"),
        (["nRows=many", "endheader", "time\ta"], "line 1 needs a whole number after 'nrows'; found 'many'"),
        (["inDegrees=maybe", "endheader", "time\ta"], "line 1 needs inDegrees=yes or inDegrees=no; found 'maybe'"),
    ],
)
def test_what_is_no_header_is_refused_with_its_line(lines, words):
    with pytest.raises(ReadError, match=words) as refusal:
        parsed_header(lines, "a.mot")
    assert str(refusal.value).startswith("a.mot")
