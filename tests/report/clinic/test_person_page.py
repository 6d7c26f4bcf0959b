from __future__ import annotations

import base64
import hashlib
import re

import pandas as pd
import pytest
from made_clinic import PROVENANCE, made_controls, made_person
from texts import says

from gaitdisc.clinic.reading import contrast_of, read_beside
from gaitdisc.report.clinic.person_page import page_names, write_person_page
from gaitdisc.results.clinical_reference import PersonSession

REFERENCE = made_controls(6)


def _page(tmp_path, *people, title="P01", contrasts=()):
    session = PersonSession(title, tuple(read_beside(one, REFERENCE) for one in people), contrasts)
    return write_person_page(session, page_names([title])[0], REFERENCE, PROVENANCE, tmp_path)


@pytest.fixture(scope="module")
def page(tmp_path_factory):
    folder = tmp_path_factory.mktemp("page")
    first, second = made_person(each=6), made_person(condition="turn", each=6)
    pair = contrast_of(read_beside(first, REFERENCE), read_beside(second, REFERENCE))
    return _page(folder, first, second, contrasts=(pair,))


def test_a_page_is_one_file_that_needs_nothing_but_itself(page):
    text = page.read_text(encoding="utf-8")
    assert page.stat().st_size < 3_000_000
    assert re.findall(r'(?:src|href)="(?!#)[^"]*"', text) == []
    assert "http" not in re.sub(r"http-equiv", "", text)
    assert text.count("<script>") == 1
    script = re.search(r"<script>(.*?)</script>", text, re.DOTALL)[1]
    allowed = base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()
    assert f"script-src 'sha256-{allowed}'" in text
    assert "default-src 'none'" in text


def test_its_parts_stand_in_the_order_of_a_clinic(page):
    text = page.read_text(encoding="utf-8")
    headings = re.findall(r"<h2[^>]*>([^<]*)</h2>", text)
    wanted = ["What stands out", "Time and distance", "Scores", "Reading the curves", "Kinematics, walk",
              "Moments, powers and forces, walk", "EMG, walk", "Appendix: every cycle, walk"]  # fmt: skip
    assert headings[: len(wanted)] == wanted
    assert headings[-3:] == ["Turn", "walk and turn", "How it was made"]
    assert text.count('role="img"') == text.count('aria-label="') - text.count('role="region"')
    assert says(text, "not", "device. No diagnosis")


def test_the_numbers_of_every_sheet_and_table_lie_beside_it(page):
    beside = page.with_suffix("")
    names = {path.name for path in beside.iterdir()}
    assert {"kinematics.csv", "kinetics.csv", "emg.csv", "cycles.csv", "spatiotemporal.csv", "files.csv"} <= names
    for name in re.findall(r"P01/([\w-]+\.csv)", page.read_text(encoding="utf-8")):
        assert len(pd.read_csv(beside / name)) == 101


def test_a_hostile_name_is_words_and_a_page_drawn_again_has_the_same_bytes(tmp_path):
    hostile = '"><img src=x onerror=alert(1)>'
    page = _page(tmp_path, made_person(hostile, condition=hostile), title=hostile)
    text = page.read_text(encoding="utf-8")
    assert "<img" not in text and "onerror=alert(1)&gt;" in text
    assert page.parent == tmp_path / "people" and "<" not in page.name
    assert _page(tmp_path, made_person(hostile, condition=hostile), title=hostile).read_text(encoding="utf-8") == text


def test_a_person_without_a_kept_cycle_has_a_page_with_the_reason(tmp_path):
    from gaitdisc.results.provenance import Refusal

    person = made_person()
    nothing = made_person(
        cycles=person.cycles.assign(kept=False),
        curves=person.curves[:0],
        refusals=(Refusal("P01", "walk", "too short"),),
    )
    text = _page(tmp_path, nothing).read_text(encoding="utf-8")
    assert "Left out" in text and "too short" in text and "Kinematics" not in text
