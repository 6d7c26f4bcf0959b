import pytest
from made_clinic import made_controls, made_person, made_run
from manufactured_discovery import manufactured
from texts import says

from gaitdisc.clinic.clinical_reference import save_reference
from gaitdisc.commands.options import REFUSED


def test_the_report_of_a_run_is_drawn_again_without_fitting(study, called, undrawn):
    called("run", study, "--quiet", ends=0)
    page = study / "run" / "report" / "report.html"
    first = page.read_bytes()
    page.unlink()
    called("report", study / "run", ends=0)
    assert page.read_bytes() == first


def test_any_saved_result_is_drawn_by_its_folder(tmp_path, called, unpainted):
    manufactured().save(tmp_path / "found")
    done = called("report", tmp_path / "found", ends=0)
    assert done.stdout == f"report: {tmp_path / 'found' / 'report.html'}\n"
    assert manufactured().sentence in (tmp_path / "found" / "report.html").read_text()


def test_a_folder_with_no_page_to_draw_is_refused(tmp_path, called):
    (tmp_path / "model.json").write_text("{}")
    assert says(called("report", tmp_path, ends=REFUSED).stderr, "no page", "above", "`models`")
    assert "nowhere is not a folder" in called("report", tmp_path / "nowhere", ends=REFUSED).stderr


@pytest.fixture(scope="module")
def run_folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("week") / "run"
    made_run(made_person("P07", session="s1"), made_person("P07", session="s2", seed=1), made_person("P08")).save(
        folder
    )
    return folder


@pytest.fixture
def without_figures(monkeypatch, unpainted):
    """The page of everybody has its words alone: its figures take seconds a person."""
    monkeypatch.setattr("gaitdisc.processing.page.cycles_figures", lambda *_: [])


def test_one_person_before_and_after_beside_a_reference(called, run_folder, tmp_path, unpainted):
    save_reference(made_controls(6), tmp_path)
    one = called("report", run_folder.parent, "--person", "P07", "--reference", tmp_path, ends=0)
    assert "P07_s1.html" in one.stdout and "P07_s2.html" in one.stdout
    assert "6 controls of the laboratory" in (run_folder / "report" / "people" / "P07_s1.html").read_text()
    both = called("report", run_folder, "--person", "P07", "--before", "s1", "--after", "s2", ends=0)
    assert "P07_s1_s2.html" in both.stdout
    assert "s1 and s2, condition walk" in (run_folder / "report" / "people" / "P07_s1_s2.html").read_text()


def test_what_is_not_there_is_refused_in_words(called, run_folder, tmp_path):
    nobody = called("report", run_folder, "--person", "P99", ends=1)
    assert "'P99' is not. Name one of: P07, P08." in nobody.stderr
    half = called("report", run_folder, "--before", "s1")
    assert says(half.stderr, "--person, --before", "--after")
    none = called("report", run_folder, "--reference", tmp_path / "none")
    assert "gaitdisc reference CONTROLS --out FOLDER" in none.stderr


def test_the_report_of_a_clinic_has_everybodys_pages_and_leaves_those_that_stand(
    called, run_folder, tmp_path, without_figures
):
    report = run_folder / "report"
    first = called("report", run_folder.parent, ends=0)
    assert f"people: {report / 'index.html'}" in first.stdout and f"report: {report / 'report.html'}" in first.stdout
    page = report / "people" / "P08.html"
    drawn, written = page.read_bytes(), page.stat().st_mtime_ns
    (report / "people" / "P07.pdf").write_text("a page more")
    assert called("report", run_folder.parent).stdout == first.stdout
    assert page.stat().st_mtime_ns == written
    page.write_text("edited")
    edited = called("report", run_folder, ends=1)
    assert says(edited.stderr, "P08.html", "changed", "report")
    assert page.read_text() == "edited"
    assert called("report", run_folder, "--overwrite").returncode == 0 and page.read_bytes() == drawn
    save_reference(made_controls(6), tmp_path)
    called("report", run_folder, "--reference", tmp_path)
    assert "6 controls of the laboratory" in page.read_text()
    assert called("report", run_folder).returncode == 0 and "6 controls of the laboratory" in page.read_text()


@pytest.mark.slow
def test_a_language_is_written_filled_in_kept_and_taken_away(called, run_folder, tmp_path, without_figures):
    table, page = tmp_path / "de.csv", run_folder / "report" / "people" / "P08.html"
    empty = called("report", run_folder, "--language", table, ends=0)
    assert "Fill in the second column" in empty.stdout
    table.write_text("English,other\nWhat stands out,Auffälliges <i>\nknee flexion,Kniebeugung\n", encoding="utf-8")
    done = called("report", run_folder, "--language", table, ends=0)
    assert "remain in English: " in done.stdout and "hip flexion; " in done.stdout
    assert "Auffälliges &lt;i&gt;" in page.read_text() and "Kniebeugung" in page.read_text()
    called("report", run_folder, "--person", "P08")
    assert "Kniebeugung" in page.read_text()
    called("report", run_folder, "--language", "en")
    assert "What stands out" in page.read_text() and "Kniebeugung" not in page.read_text()
