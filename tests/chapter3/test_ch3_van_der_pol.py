import importlib
from pathlib import Path

import pytest

STUDIES = Path(__file__).parents[2] / "studies"


@pytest.fixture
def study(monkeypatch):
    monkeypatch.syspath_prepend(STUDIES)
    return importlib.import_module("ch3_van_der_pol")


def test_text_and_code_hide_a_term_of_opposite_sign_and_start_apart(study):
    text, code = study.systems()["text"], study.systems()["code"]
    x = text.start[None] * 0 + 2.0
    assert (text.true(x) - text.known(x))[0, 1] == pytest.approx(-0.08)
    assert (code.true(x) - code.known(x))[0, 1] == pytest.approx(0.08)
    assert (text.start.tolist(), code.start.tolist()) == ([0.1, 5.0], [0.1, 0.1])


@pytest.mark.slow
def test_the_quick_study_answers_every_statement(study, tmp_path):
    result = study.run(quick=True, folder=tmp_path)
    captions = [study.FIGURES[each] for each in ("system", "cost")]
    assert [row[0] for row in result.tables[0].rows] == [where for where, *_ in study.STATED] + captions
    assert (tmp_path / "tables.md").exists()
