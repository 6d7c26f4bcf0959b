import csv

import numpy as np
import pandas as pd
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gaitdisc.channel import Channel
from gaitdisc.ingest.table import read_table, write_table
from gaitdisc.recording import Recording
from gaitdisc.spreadsheet import quote, read_csv, unquote, write_csv

SIGNS = "=+-@\t\r\n＝＋－＠"
TEXT = st.text(st.sampled_from("=+-@\t\r\n'a1.;,\" ＝"), max_size=6) | st.text(max_size=6)


@pytest.mark.parametrize("sign", SIGNS)
def test_what_a_spreadsheet_would_compute_begins_with_an_apostrophe(sign):
    assert quote(f"{sign}SUM(A1)") == f"'{sign}SUM(A1)"


@pytest.mark.parametrize("number", ["-0.5", "+3", "-1e-05", "1", "-.5", "2."])
def test_a_number_stays_a_number(number):
    assert quote(number) == number


@given(TEXT)
def test_text_comes_back_and_never_begins_with_a_formula(text):
    assert unquote(quote(text)) == text
    safe = quote(text)
    assert safe == text or safe[0] == "'"
    assert safe[:1] not in SIGNS or not safe or float(safe) == float(text)


@settings(deadline=None, max_examples=40)
@given(
    st.lists(TEXT.map(lambda text: "".join(text.split())).filter(bool), min_size=2, max_size=3, unique=True),
    st.lists(st.tuples(TEXT, st.floats(allow_nan=False, allow_infinity=False)), min_size=1, max_size=4),
)
def test_a_table_comes_back_equal(tmp_path_factory, names, rows):
    path = tmp_path_factory.mktemp("table") / "table.csv"
    words = [f"{word}w" for word, _ in rows]  # which is no number, and not empty
    table = pd.DataFrame({names[0]: words, names[1]: [value for _, value in rows]})
    write_csv(table, path)
    again = read_csv(path)
    assert list(again.columns) == names[:2]
    assert [plain_ends(cell) for cell in again.iloc[:, 0]] == [plain_ends(word) for word in words]
    assert again.iloc[:, 1].tolist() == table.iloc[:, 1].tolist()
    with path.open(newline="", encoding="utf-8") as file:
        cells = [cell for row in csv.reader(file) for cell in row]
    assert all(cell[:1] not in set(SIGNS) or is_number(cell) for cell in cells if cell)


def is_number(text):
    try:
        float(text)
    except ValueError:
        return False
    return True


def plain_ends(text):
    """A CSV has one kind of line end inside a cell."""
    return text.replace("\r\n", "\n").replace("\r", "\n")


def test_another_separator_in_a_cell_begins_no_cell_of_its_own(tmp_path):
    write_csv(pd.DataFrame({"a": ["x;=1+1"]}), tmp_path / "t.csv")
    assert '"x;=1+1"' in (tmp_path / "t.csv").read_text()


@pytest.mark.parametrize("name", ["=cmd", "+a", "-b", "@c", "'=d", "plain"])
def test_a_recording_with_such_a_channel_is_read_again_as_it_was(tmp_path, name):
    time = np.arange(50) / 100
    recording = Recording(time, -np.sin(time)[:, None], (Channel(name, "signal", "V"),))
    write_table(recording, tmp_path / "walk.csv")
    heading = (tmp_path / "walk.csv").read_text().splitlines()[0].split(",")[1]
    assert heading == (f"{name} [V]" if name == "plain" else f"'{name} [V]")
    again = read_table(tmp_path / "walk.csv").streams["signals"]
    assert again.names == (name,)
    np.testing.assert_array_equal(again.values, recording.values)


def test_words_that_look_like_numbers_stay_words(tmp_path):
    write_csv(pd.DataFrame({"who": ["007", "8"], "n": [1, 2]}), tmp_path / "a.csv")
    table = read_csv(tmp_path / "a.csv", ("who",))
    assert (table["who"].tolist(), table["n"].tolist()) == (["007", "8"], [1, 2])


def test_further_rows_are_written_under_the_first(tmp_path):
    rows = [pd.DataFrame({"who": ["P1", "=P2"], "n": [1, 2]}), pd.DataFrame({"who": ["P3", None], "n": [3, 4]})]
    write_csv(rows[0], tmp_path / "parts.csv", rest=iter(rows[1:]))
    write_csv(pd.concat(rows), tmp_path / "whole.csv")
    assert (tmp_path / "parts.csv").read_bytes() == (tmp_path / "whole.csv").read_bytes()
