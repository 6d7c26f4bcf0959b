"""A person's page, its PDF, and the index of all."""

import base64
import hashlib
import re

import pandas as pd
import pytest
from made_clinic import PROVENANCE, made_controls, made_person, made_run
from texts import says

from gaitdisc.clinic.clinical_reference import PersonSession
from gaitdisc.clinic.laboratory import Laboratory
from gaitdisc.clinic.page_words import ENGLISH, PageWords
from gaitdisc.clinic.person_page import index_rows, write_index, write_person_page
from gaitdisc.clinic.reading import contrast, read_beside
from gaitdisc.clinic.sentences import contrast_heading
from gaitdisc.recording import PERCENT
from gaitdisc.report.figure import file_names
from gaitdisc.saved.provenance import Refusal

REFERENCE = made_controls(6)


def _page(tmp_path, *people, title="P01", contrasts=()):
    session = PersonSession(title, tuple(read_beside(one, REFERENCE) for one in people), contrasts)
    return write_person_page(session, file_names([title])[title], REFERENCE, PROVENANCE, tmp_path)[0]


def _pdf(tmp_path, session, say=ENGLISH):
    pytest.importorskip("typst")
    return write_person_page(session, "P01", REFERENCE, PROVENANCE, tmp_path, say, pdf=True)[1].read_bytes()


def _count_sheets(content):
    return len(re.findall(rb"/Type */Page\b", content))


@pytest.fixture(scope="module")
def page(tmp_path_factory):
    folder = tmp_path_factory.mktemp("page")
    first, second = made_person(each=6), made_person(condition="turn", each=6)
    pair = contrast(read_beside(first, REFERENCE), read_beside(second, REFERENCE))
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
    wanted = ["What stands out", "Time and distance", "Scores", "Kinematics, walk",
              "Moments, powers and forces, walk", "EMG, walk", "All values that the rules use"]  # fmt: skip
    assert headings[: len(wanted)] == wanted
    assert headings[-3:] == ["Turn", "walk and turn", "How it was made"]
    assert text.count('role="img"') == text.count('aria-label="') - text.count('role="region"')
    assert says(text, "not", "device. No diagnosis")


def test_two_sessions_are_named_as_sessions_and_their_condition_once(tmp_path):
    before, after = (read_beside(made_person(session=word, each=6), REFERENCE) for word in ("before", "after"))
    session = PersonSession("P01 before after", (after, before), (contrast(before, after),))
    page = write_person_page(session, "P01", REFERENCE, PROVENANCE, tmp_path)[0]
    text = page.read_text(encoding="utf-8")
    headings = re.findall(r"<h2[^>]*>([^<]*)</h2>", text)
    assert headings[1] == "before and after, condition walk" and "Session before, condition walk" in headings
    assert "Kinematics, session after, condition walk" in headings
    assert "Dotted lines: before; solid or dashed lines: after." in text and '<th scope="col">left, before</th>' in text
    assert "after walk" not in text and "before walk" not in text
    assert (page.with_suffix("") / "before_walk-after_walk-changes.csv").is_file()


def test_conditions_of_a_session_are_named_with_their_session():
    pair = contrast(*(read_beside(made_person(session="before", condition=word), None) for word in ("walk", "turn")))
    assert contrast_heading(pair) == "walk and turn, session before"


def test_the_numbers_of_every_sheet_and_table_lie_beside_it(page):
    beside = page.with_suffix("")
    names = {path.name for path in beside.iterdir()}
    assert {"kinematics.csv", "kinetics.csv", "emg.csv", "cycles.csv", "spatiotemporal.csv", "files.csv"} <= names
    files = pd.read_csv(beside / "files.csv").to_numpy().tolist()
    assert files == [["P01 walk, file 1", 64 * "a"], ["P01 turn, file 1", 64 * "a"]]
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
    from gaitdisc.saved.provenance import Refusal

    person = made_person()
    nothing = made_person(
        cycles=person.cycles.assign(kept=False),
        curves=person.curves[:0],
        refusals=(Refusal("P01", "walk", "too short"),),
    )
    text = _page(tmp_path, nothing).read_text(encoding="utf-8")
    assert "Left out" in text and "too short" in text and "Kinematics" not in text


@pytest.fixture(scope="module")
def reading():
    return read_beside(made_person(), made_controls(6))


def test_a_person_is_two_sheets_of_pdf_with_the_same_bytes_again(reading, tmp_path):
    person = PersonSession("P01", (reading,))
    first = _pdf(tmp_path, person)
    assert first[:5] == b"%PDF-" and b"FontFile2" in first
    assert _count_sheets(first) == 2
    assert _pdf(tmp_path, person) == first
    assert sorted(path.name for path in (tmp_path / "people").iterdir()) == ["P01", "P01.html", "P01.pdf"]


def test_a_person_without_a_kept_cycle_has_a_sheet_with_the_reason(tmp_path):
    person = made_person()
    nothing = made_person(cycles=person.cycles.assign(kept=False), curves=person.curves[:0])
    assert _count_sheets(_pdf(tmp_path, PersonSession("P01", (read_beside(nothing, None),)))) == 1


def test_refused_first_then_amber_then_green_each_with_why_and_link(tmp_path):
    reference = made_controls(20)
    good, few = made_person("P01"), made_person("P02", each=2, changed={"knee_angle_l": -40.0})
    far = made_person("P03", changed={"knee_angle_l": -40.0})
    run = made_run(good, few, far, refusals=(Refusal("P09", "", "no walk. Record again."),))
    sessions = [PersonSession(one.subject, (read_beside(one, reference),)) for one in (good, few, far)]
    rows = [row for one in sessions for row in index_rows(one, one.title)]
    text = write_index(run, rows, reference, tmp_path).read_text(encoding="utf-8")
    rows = re.findall(r'<td class="light (\w+)">.*?<th scope="row">(.*?)</th>', text)
    assert rows == [
        ("red", "P09"),
        ("amber", '<a href="people/P02.html">P02</a>'),
        ("green", '<a href="people/P01.html">P01</a>'),
        ("green", '<a href="people/P03.html">P03</a>'),
    ]
    assert says(text, "no walk. Record again") and says(text, "left leg 2, right leg 2")
    stands_out = pd.read_csv(tmp_path / "tables" / "people.csv").set_index("person")["stands out"]
    assert "knee" not in stands_out["P02"] and says(stands_out["P03"].lower(), "■", "knee", "left", "4 cycles")
    assert says(text, "4 people; 1 refused, 1", "amber, 2 green")


def test_an_index_of_nobody_but_refused_people_still_stands(tmp_path):
    run = made_run(refusals=(Refusal("P01", "", "<b>no</b> walk"),))
    text = write_index(run, [], None, tmp_path).read_text(encoding="utf-8")
    assert "&lt;b&gt;no" in text and "No reference" in text


def test_before_and_after_stand_on_the_first_sheet_of_page_and_pdf(tmp_path):
    bump = 15.0 * ((PERCENT >= 65) & (PERCENT <= 80))
    pair = [
        read_beside(
            made_person(session=word, each=8, spread=0.0, seed=k, changed={"knee_angle_l": k * bump}), REFERENCE
        )
        for k, word in enumerate(("before", "after"))
    ]
    session = PersonSession("P01 before after", (pair[1], pair[0]), (contrast(*pair),))
    assert session.before_after is session.contrasts[0]
    page = write_person_page(session, "P01", REFERENCE, PROVENANCE, tmp_path)[0].read_text(encoding="utf-8")
    headings = re.findall(r"<h2[^>]*>([^<]*)</h2>", page)
    assert headings[:3] == ["What stands out", "before and after, condition walk", "Time and distance"]
    changes = pd.read_csv(tmp_path / "people" / "P01" / "before_walk-after_walk-changes.csv")
    assert list(changes)[1:] == ["left, before walk", "left, after walk", "right, before walk", "right, after walk"]
    assert "gait profile score [deg]" in set(changes["value"])
    assert _count_sheets(_pdf(tmp_path, session)) == 5  # first sheet, then two of each session


def test_name_comment_and_side_of_the_laboratory_stand_on_the_page(tmp_path):
    house = Laboratory("Gait <lab>", affected={"P01": "left"}, comments={"P01": "after <b> surgery"})
    session, say = PersonSession("P01", (read_beside(made_person(), REFERENCE),)), PageWords(laboratory=house)
    page = write_person_page(session, "P01", REFERENCE, PROVENANCE, tmp_path, say)[0].read_text(encoding="utf-8")
    assert says(page, "Gait &lt;lab&gt;", "Side affected: left.", "after &lt;b&gt; surgery")
    assert len(_pdf(tmp_path, session, say)) > len(_pdf(tmp_path, session))
