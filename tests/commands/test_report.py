import shutil

from typer.testing import CliRunner

from gaitdisc.cli import app


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
