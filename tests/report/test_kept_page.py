"""A page is drawn once of one run."""

from __future__ import annotations

import pytest
from made_cycles import made_cycles

from gaitdisc.report.kept_page import page_of
from gaitdisc.results import ResponseRun
from gaitdisc.results.cycles_store import save_cycles
from gaitdisc.results.provenance import made_now
from gaitdisc.results.run_store import save_run


@pytest.fixture
def folder(tmp_path):
    one = made_cycles()
    save_cycles(one, tmp_path / "cycles" / "P01-walk", "key")
    _save(tmp_path, one)
    return tmp_path


def _save(folder, one, title="t"):
    save_run(ResponseRun(title, "walk", "", (), (), (), made_now({}, 0, {}, "4.2"), cycles=(one,)), folder)


def _drawing(folder, drawn):
    def draw():
        drawn.append(1)
        (folder / "report" / "figures").mkdir(parents=True, exist_ok=True)
        (folder / "report" / "figures" / "a.svg").write_text("<svg/>")
        page = folder / "report" / "report.html"
        page.write_text("page")
        return page

    return draw


def test_a_page_of_the_same_run_is_not_drawn_again(folder):
    drawn: list[int] = []
    first = page_of(folder, _drawing(folder, drawn))
    _save(folder, made_cycles())  # another time of making, the same run
    assert page_of(folder, _drawing(folder, drawn)) == first and len(drawn) == 1


@pytest.mark.parametrize("change", ["title", "unit", "page", "figure", "seal"])
def test_whatever_is_changed_is_drawn_anew(folder, change):
    drawn: list[int] = []
    page_of(folder, _drawing(folder, drawn))
    if change == "title":
        _save(folder, made_cycles(), "another")
    elif change == "unit":
        save_cycles(made_cycles(each=3), folder / "cycles" / "P01-walk", "other")
    elif change == "page":
        (folder / "report" / "report.html").write_text("edited")
    elif change == "figure":
        (folder / "report" / "figures" / "a.svg").unlink()
    else:
        (folder / "report" / "drawn.json").write_text("{}")
    page_of(folder, _drawing(folder, drawn))
    assert len(drawn) == 2
