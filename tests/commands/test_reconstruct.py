import json

import pytest
from texts import says

from gaitdisc.commands.options import REFUSED

pytestmark = pytest.mark.usefixtures("unpainted")
FAST = ("--kinds", "linear,delay ridge")  # no network, where none is asked about


def test_a_study_gives_a_sentence_a_table_and_a_report(study, tmp_path, called):
    done = called("reconstruct", study, "-s", "hip_flexion_r,knee_angle_r", "--out", tmp_path, "-q", ends=0)
    assert says(done.stdout, "from right hip flexion and right knee angle")
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert "Relative L2" in page and "MSE (" not in page
    assert page.index('<h2 id="answer">') < page.index("<figure>") < page.index("How the numbers were computed")
    assert "http" not in page.split("</head>")[1] and "<script" not in page
    assert (tmp_path / "errors.csv").is_file()


def test_a_sensor_that_is_not_there_is_one_sentence(study, called):
    done = called("reconstruct", study, "-s", "knee_ange_r", ends=REFUSED)
    assert "the nearest is 'knee_angle_r'" in done.stderr


def test_the_saved_model_is_of_the_kind_that_the_page_recommends(study, tmp_path, called):
    words = ("-s", "hip_flexion_r", "--out", tmp_path, "-q", "--spacing", "0.02", *FAST)
    done = called("reconstruct", study, *words, ends=0)
    recommended = json.loads((tmp_path / "reconstruction.json").read_text())["recommended"]
    [model] = (tmp_path / "models").iterdir()
    saved = json.loads((model / "model.json").read_text())
    assert saved["kind"] == recommended
    assert saved["sensing"]["lags"] == {"count": 50, "spacing": 2, "ahead": 0}  # one second back
    assert f"models: {tmp_path / 'models'}, {recommended} for each participant" in done.stdout


def test_without_sensors_it_is_refused(study, called):
    done = called("reconstruct", study, ends=REFUSED)
    assert "reconstruction must have at least one sensor" in done.stderr


def test_a_search_chooses_the_sensors_and_stands_in_the_report(study, tmp_path, called):
    done = called("reconstruct", study, "--search", 2, "--out", tmp_path, "-q", *FAST, ends=0)
    assert says(done.stdout, "may not be enough")
    assert '<h2 id="search">Sensors</h2>' in (tmp_path / "report.html").read_text(encoding="utf-8")
    assert len((tmp_path / "search.csv").read_text().splitlines()) == 3
