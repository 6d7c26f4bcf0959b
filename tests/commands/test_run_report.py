import pytest
import typer
from made_clinic import made_controls, made_person, made_run

from gaitdisc.clinic.clinical_reference import save_reference
from gaitdisc.clinic.run_pages import keep_reference
from gaitdisc.commands.options import STOPPED
from gaitdisc.commands.run_report import report_on
from gaitdisc.ingest.study_file import load_study


def test_whoever_stops_it_reads_that_nothing_is_lost(study, tmp_path, caplog):
    def stopped(_):
        raise KeyboardInterrupt

    with caplog.at_level("INFO", "gaitdisc"), pytest.raises(typer.Exit) as ended:
        report_on(stopped, load_study(study), tmp_path, quiet=True)
    assert ended.value.exit_code == STOPPED
    assert "continues from there" in caplog.text


@pytest.mark.usefixtures("unpainted")
def test_a_run_of_cycles_has_pages_of_people_drawn_again_only_beside_another_reference(study, tmp_path, capsys):
    run = made_run(made_person())
    run.save(tmp_path)

    def page():
        report_on(lambda _: run, load_study(study), tmp_path, quiet=True)
        drawn = tmp_path / "report" / "people" / "P01.html"
        return drawn.stat().st_mtime_ns, drawn.read_text(encoding="utf-8")

    first = page()
    assert f"people: {tmp_path / 'report' / 'index.html'}" in capsys.readouterr().out
    assert (tmp_path / "report" / "index.html").is_file() and "No reference." in first[1]
    assert page() == first
    save_reference(made_controls(6), tmp_path / "elsewhere")
    keep_reference(tmp_path / "elsewhere", tmp_path)
    assert "6 controls of the laboratory" in page()[1]


def test_where_everybody_is_refused_the_exit_code_says_so(study, called, tmp_path):
    text = (study / "study.toml").read_text(encoding="utf-8").replace("min_strides = 10", "min_strides = 900")
    other = tmp_path / "study.toml"
    other.write_text(text.replace("../lab", str(study.parent / "lab")), encoding="utf-8")
    done = called("modalities", other, "--quiet", ends=1)
    assert "refused: " in done.stderr
