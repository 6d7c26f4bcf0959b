import json

from texts import says
from typer.testing import CliRunner

from gaitdisc.cli import app
from gaitdisc.commands.options import REFUSED


def test_each_trial_has_its_strides(study):
    checked = CliRunner().invoke(app, ["check", str(study), "--json"])
    assert checked.exit_code == 0, checked.output
    seen = json.loads(checked.stdout)
    assert sorted(one["condition"] for one in seen) == ["exo", "natural"]
    assert all(20 < one["strides"]["r"]["kept"] <= 30 / 1.1 for one in seen)  # 30 s of strides of 1.1 s


def test_check_writes_nothing(study):
    before = sorted(path for path in study.rglob("*"))
    CliRunner().invoke(app, ["check", str(study)])
    assert sorted(path for path in study.rglob("*")) == before


def test_a_refusal_is_one_sentence_and_exit_code_1(tmp_path, called):
    done = called("check", tmp_path / "nowhere")
    assert done.returncode == REFUSED
    assert says(done.stderr, "SchemaError", "study, a recording")
    assert "Traceback" not in done.stdout + done.stderr


def test_a_condition_in_brackets_is_printed_as_it_is(study, tmp_path):
    text = (study / "study.toml").read_text().replace('"exo"', '"xo[/b]"').replace('"natural"', '"[natural]"')
    home = tmp_path / "study"
    home.mkdir()
    (home / "study.toml").write_text(text.replace("../..", str(study.parents[1])))
    checked = CliRunner().invoke(app, ["check", str(home)])
    assert checked.exception is None or isinstance(checked.exception, SystemExit), checked.exception
    assert "xo[/b]" in checked.output and "[natural]" in checked.output
