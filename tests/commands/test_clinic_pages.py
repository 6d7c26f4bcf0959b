from __future__ import annotations

from unittest.mock import patch

from made_clinic import SOURCE, made_controls, made_person, made_run, published_table, written_table
from texts import says

from gaitdisc.commands.clinic_pages import keep_reference, kept_reference, write_people
from gaitdisc.results.clinical_reference import save_reference
from gaitdisc.results.provenance import Refusal


def test_a_person_whose_page_fails_costs_nobody_else(tmp_path):
    from gaitdisc.report.clinic import person_page

    real = person_page.write_person_page

    def failing(person, *others):
        if person.title == "P02":
            raise ValueError(f"P02: {tmp_path}/cycles/P02")
        return real(person, *others)

    run = made_run(made_person("P01"), made_person("P02"), refusals=(Refusal("P03", "", "unread"),))
    with patch.object(person_page, "write_person_page", failing):
        index = write_people(run, tmp_path)
    text = index.read_text(encoding="utf-8")
    assert index == tmp_path / "report" / "index.html"
    assert str(tmp_path) not in text
    assert says(text, "P02", "run/cycles/P02") and "unread" in text
    assert [path.name for path in sorted((tmp_path / "report" / "people").glob("*.html"))] == ["P01.html"]


def test_a_reference_stays_with_the_run(tmp_path):
    save_reference(made_controls(3), tmp_path / "ref")
    assert kept_reference(tmp_path / "run") is None
    keep_reference(tmp_path / "ref", tmp_path / "run")
    keep_reference(None, tmp_path / "run")
    assert kept_reference(tmp_path / "run").people("walk") == 3


def test_a_run_without_cycles_has_no_pages_of_people(tmp_path):
    assert write_people(made_run(), tmp_path) is None
    assert list(tmp_path.iterdir()) == []


def test_a_published_reference_stays_as_its_table_until_another_takes_its_place(tmp_path):
    run = made_run(made_person("P01"))
    run.save(tmp_path / "run")
    keep_reference(written_table(tmp_path, published_table()), tmp_path / "run")
    index = write_people(run, tmp_path / "run")
    assert SOURCE[2:] in index.read_text() and SOURCE[2:] in (index.parent / "people" / "P01.html").read_text()
    save_reference(made_controls(3), tmp_path / "ref")
    keep_reference(tmp_path / "ref", tmp_path / "run")
    assert kept_reference(tmp_path / "run").published == ()
