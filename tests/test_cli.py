import json
import subprocess
import sys

import pytest
from typer.testing import CliRunner

from gaitdisc.cli import REFUSED, SOME_REFUSED, app
from gaitdisc.cohort.driven_walker import DrivenWalker
from gaitdisc.ingest.storage import write_storage

USAGE = 2


def called(*words):
    """Exit code and everything printed, with refusals printed as `main` prints them."""
    return subprocess.run(
        [sys.executable, "-m", "gaitdisc", *map(str, words)], capture_output=True, text=True, check=False
    )


@pytest.fixture(scope="module")
def recordings(tmp_path_factory):
    folder = tmp_path_factory.mktemp("lab")
    for condition, spring in (("natural", 0.0), ("exo", 250.0)):
        walker = DrivenWalker("A", seed=8, spring_per_s2=spring)
        path = folder / "walker1" / f"{condition}.mot"
        path.parent.mkdir(exist_ok=True)
        write_storage(walker.walked(40.0, condition).stream("kinematics"), path)
    return folder


@pytest.fixture(scope="module")
def study(recordings, tmp_path_factory):
    folder = tmp_path_factory.mktemp("study") / "study"
    assert CliRunner().invoke(app, ["new", str(folder), "--from", str(recordings)]).exit_code == 0
    return folder


def test_new_then_check_then_run_then_report(study):
    checked = CliRunner().invoke(app, ["check", str(study), "--json"])
    assert checked.exit_code == 0, checked.output
    seen = json.loads(checked.stdout)
    assert [one["condition"] for one in seen] == ["exo", "natural"] or [one["condition"] for one in seen] == [
        "natural",
        "exo",
    ]
    assert all(one["strides"]["r"]["kept"] > 30 for one in seen)
    ran = CliRunner().invoke(app, ["run", str(study), "--quiet"])
    assert ran.exit_code == 0, ran.output
    page = study / "run" / "report" / "report.html"
    first = page.read_bytes()
    page.unlink()
    drawn = CliRunner().invoke(app, ["report", str(study / "run")])
    assert drawn.exit_code == 0, drawn.output
    assert page.read_bytes() == first


def test_check_writes_nothing(study):
    before = sorted(path for path in study.rglob("*"))
    CliRunner().invoke(app, ["check", str(study)])
    assert sorted(path for path in study.rglob("*")) == before


def test_a_refusal_is_one_sentence_and_exit_code_1(tmp_path):
    done = called("check", tmp_path / "nowhere")
    assert done.returncode == REFUSED
    assert done.stderr.startswith("SchemaError: a study, a recording or a folder is needed; ")
    assert "Traceback" not in done.stdout + done.stderr


def test_a_typo_is_exit_code_2_with_a_suggestion():
    done = called("chekc")
    assert done.returncode == USAGE
    assert "check" in done.stderr


def test_a_study_is_not_overwritten(study, recordings):
    done = called("new", study, "--from", recordings)
    assert done.returncode == REFUSED
    assert "is there already" in done.stderr


def test_the_batch_goes_on_past_a_broken_file(study, recordings, tmp_path):
    text = (study / "study.toml").read_text()
    folder = tmp_path / "two"
    (folder / "raw").mkdir(parents=True)
    for name in ("natural", "exo"):
        (folder / "raw" / f"{name}.mot").write_bytes((recordings / "walker1" / f"{name}.mot").read_bytes())
    (folder / "raw" / "broken.mot").write_text("Coordinates\n")
    head = text[: text.index("[[participants]]")]
    good = '[[participants]]\nid = "P01"\n' + "".join(
        f'[[participants.trials]]\ncondition = "{name}"\nfiles = ["raw/{name}.mot"]\n' for name in ("natural", "exo")
    )
    bad = good.replace("P01", "P02").replace("raw/exo.mot", "raw/broken.mot")
    (folder / "study.toml").write_text(head + bad + good)
    done = called("run", folder, "--quiet")
    assert done.returncode == SOME_REFUSED, done.stderr
    assert "refused: P02 exo:" in done.stderr
    assert "broken.mot" in done.stderr
    assert "1 participants" in done.stdout
    checked = called("check", folder)
    assert checked.returncode == SOME_REFUSED
    assert "Traceback" not in checked.stderr


def test_demo_does_the_whole_job(tmp_path):
    done = called("demo", tmp_path / "demo", "--seconds", "30", "--people", "1", "--quiet")
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "demo" / "run" / "report" / "report.html").stat().st_size > 10_000
    assert "no people" in done.stdout


def test_export_brings_streams_to_one_time_base(tmp_path):
    trial = DrivenWalker("A", seed=8).walked(10.0, "natural")
    for key in ("kinematics", "forces"):
        write_storage(trial.stream(key), tmp_path / f"{key}.mot")
    done = called("export", tmp_path / "kinematics.mot", tmp_path / "forces.mot", "--out", tmp_path / "both.csv")
    assert done.returncode == 0, done.stderr
    assert "12 channels, 1000 samples at 100 Hz" in done.stdout
    assert called("check", tmp_path / "both.csv").returncode == 0


def test_version():
    assert called("--version").stdout.startswith("gaitdisc 0.")
