import pytest
from typer.testing import CliRunner

from gaitdisc.cli import app


@pytest.mark.parametrize(("command", "option"), [("run", "--jobs"), ("ablate", "--out"), ("demo", "--quiet")])
def test_a_shared_option_is_explained_in_the_help(command, option):
    said = CliRunner().invoke(app, [command, "--help"], env={"COLUMNS": "200"}).output
    assert option in said
