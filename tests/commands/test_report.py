import shutil

from manufactured_discovery import manufactured
from typer.testing import CliRunner

from gaitdisc.cli import app
from gaitdisc.commands.exit_codes import REFUSED


def test_the_report_of_a_run_is_drawn_again_without_fitting(study):
    shutil.rmtree(study / "run" / "report", ignore_errors=True)  # other tests leave one whose figures are not painted
    ran = CliRunner().invoke(app, ["run", str(study), "--quiet"])
    assert ran.exit_code == 0, ran.output
    page = study / "run" / "report" / "report.html"
    first = page.read_bytes()
    page.unlink()
    drawn = CliRunner().invoke(app, ["report", str(study / "run")])
    assert drawn.exit_code == 0, drawn.output
    assert page.read_bytes() == first


def test_any_saved_result_is_drawn_by_its_folder(tmp_path, called, unpainted):
    manufactured().save(tmp_path / "found")
    done = called("report", tmp_path / "found")
    assert (done.returncode, done.stdout) == (0, f"report: {tmp_path / 'found' / 'report.html'}\n")
    assert manufactured().sentence in (tmp_path / "found" / "report.html").read_text()


def test_a_folder_with_no_page_to_draw_is_refused(tmp_path, called):
    (tmp_path / "model.json").write_text("{}")
    done = called("report", tmp_path)
    assert done.returncode == REFUSED
    assert "holds a saved model, which has none. Name the folder above its `models`" in done.stderr
    done = called("report", tmp_path / "nowhere")
    assert done.returncode == REFUSED and "nowhere is no folder" in done.stderr
