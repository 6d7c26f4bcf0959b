"""Verbs of a study: run, ablate, modalities and sensitivity, apply."""

import pytest

from gaitdisc.commands.options import REFUSED, SOME_REFUSED

pytestmark = pytest.mark.usefixtures("undrawn")


def test_the_batch_goes_on_past_a_broken_file(study, recordings, tmp_path, called):
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
    (folder / "raw" / "other.mot").write_bytes((folder / "raw" / "natural.mot").read_bytes() + b"\n")
    bad = good.replace("P01", "P02").replace("raw/exo.mot", "raw/broken.mot").replace("raw/natural", "raw/other")
    (folder / "study.toml").write_text(head + bad + good)
    done = called("run", folder, "--quiet", ends=SOME_REFUSED)
    assert "refused: P02 exo:" in done.stderr
    assert "P02 exo, file 1" in done.stderr and "broken.mot" not in done.stderr  # the study says which file it is
    assert "1 participant in" in done.stdout
    assert "broken.mot" in called("check", folder, ends=SOME_REFUSED).stdout


def test_ablate_keeps_what_less_data_gave_and_draws_it(study, called):
    called("ablate", study, "--length", "5", "--quiet", ends=0)
    assert (study / "run" / "quantities").is_dir()
    assert "How much data" in (study / "run" / "report" / "report.html").read_text(encoding="utf-8")


@pytest.mark.slow
def test_a_variation_is_written_and_its_page_drawn_again(study, called):
    drawn = {}
    for command in ("modalities", "sensitivity"):
        done = called(command, study, "--quiet", ends=0)
        assert (study / "run" / command / "tables" / "r2.csv").is_file()
        assert "1 participant in" in done.stdout
        page = study / "run" / command / "report.html"
        drawn[page] = page.read_bytes()
        page.unlink()
    called("report", study / "run", ends=0)
    assert {page: page.read_bytes() for page in drawn} == drawn


@pytest.fixture(scope="module")
def model(study, called, tmp_path_factory):
    out = tmp_path_factory.mktemp("fitted")
    words = ["-s", "hip_flexion_r", "-s", "knee_angle_r", "--condition", "natural", "--out", out, "-q"]
    called("reconstruct", study, *words, "--kinds", "linear,delay ridge", ends=0)
    [model] = (out / "models").iterdir()
    return model


def test_a_saved_model_reconstructs_a_recording(model, recordings, tmp_path, called):
    out = tmp_path / "states.mot"
    done = called("apply", model, recordings / "walker1" / "exo.mot", "--out", out, ends=0)
    assert "ankle_angle_r: RMSE" in done.stdout and "% inside the 90 % interval" in done.stdout
    assert out.is_file()


def test_model_and_recording_in_the_wrong_order_are_refused(model, recordings, called):
    done = called("apply", recordings / "walker1" / "exo.mot", model, ends=REFUSED)
    assert "exo.mot" in done.stderr
    assert "gaitdisc apply MODEL RECORDING" in done.stderr
