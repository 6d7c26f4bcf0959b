import re

import pandas as pd
import pytest
from manufactured_discovery import manufactured

from gaitdisc.report.discovery_page import VERDICTS, write_discovery_report
from gaitdisc.results import discovery as noun


def test_the_answer_comes_first_and_the_page_needs_nothing_else(tmp_path):
    text = write_discovery_report(manufactured(), tmp_path).read_text(encoding="utf-8")
    body = text[text.index("<main>") :]
    assert body.index("lacks a one-sided spring") < body.index("Verdict: missing physics") < body.index("279 N m/rad")
    assert not re.search(r'(src|href)="(?!data:|#)', text)
    assert "<script" not in text


@pytest.mark.usefixtures("unpainted")
def test_every_table_lies_beside_the_page(tmp_path):
    write_discovery_report(manufactured(), tmp_path)
    names = {path.stem for path in (tmp_path / "tables").iterdir()}
    assert {"estimates", "gap", "where", "rivals", "findings", "files"} <= names
    assert pd.read_csv(tmp_path / "tables" / "estimates.csv")["high"].tolist() == [292.8, 0.037]
    assert (tmp_path / "figures" / "over_stride.csv").is_file()


@pytest.mark.usefixtures("unpainted")
def test_no_gap_is_a_page_too(tmp_path):
    empty = manufactured(verdict="no_gap", where=(), effects=(), rivals=(), findings=(), provenance=None)
    text = write_discovery_report(empty, tmp_path).read_text(encoding="utf-8")
    assert "no gap: nothing is added to the simulation" in text
    assert "What else it could be" not in text


@pytest.mark.usefixtures("unpainted")
def test_what_a_file_says_is_text_and_never_markup(tmp_path):
    text = write_discovery_report(manufactured(sentence="<b>lacks</b>"), tmp_path).read_text(encoding="utf-8")
    assert "&lt;b&gt;lacks" in text


def test_every_verdict_has_its_words():
    assert set(VERDICTS) == set(noun.VERDICTS)
