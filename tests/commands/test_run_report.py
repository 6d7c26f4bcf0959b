import pytest
import typer

from gaitdisc.commands.exit_codes import STOPPED
from gaitdisc.commands.run_report import report_on
from gaitdisc.ingest.study_file import load_study


def test_whoever_stops_it_is_told_that_nothing_is_lost(study, tmp_path, capsys):
    def stopped(_):
        raise KeyboardInterrupt

    with pytest.raises(typer.Exit) as ended:
        report_on(stopped, load_study(study), tmp_path, quiet=True)
    assert ended.value.exit_code == STOPPED
    assert "goes on from there" in capsys.readouterr().err
