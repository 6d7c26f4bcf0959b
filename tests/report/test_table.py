import numpy as np
import pandas as pd

from gaitdisc.report.table import save_table, save_tables, words_table


def test_tables_are_written_without_index(tmp_path):
    save_table(pd.DataFrame({"a": [1.0, np.nan]}), tmp_path / "t.csv")
    assert (tmp_path / "t.csv").read_text() == 'a\n1\n""\n'


def test_words():
    assert words_table("files", "Files.", ("file", "SHA-256"), [("a.c3d", "ff")]).rows == (("a.c3d", "ff"),)


def test_the_numbers_lie_under_the_name_of_their_table(tmp_path):
    tables = [words_table(name, "", ("what", "value"), [("a", name)]) for name in ("first", "second")]
    save_tables(tables, tmp_path)
    assert (tmp_path / "tables" / "second.csv").read_text() == "what,value\na,second\n"
    assert len(list((tmp_path / "tables").iterdir())) == 2
