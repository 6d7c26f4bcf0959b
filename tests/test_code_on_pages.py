"""The code of docs/library.md, howto.md, fields.md and simulation.md runs as it stands; so do a person's scripts."""

import re
import runpy

import matplotlib.pyplot as plt
import pandas as pd
import pytest
from as_a_user import told
from hidden_in_a_function import write_record
from library_pictures import DOCS, MOST_LINES, PICTURES, blocks, run_script, scripts
from texts import says

import gaitdisc as gd
from gaitdisc.simulation.parts import Term

QUICK = ("cycles", "reconstruction")


def test_there_is_a_picture_of_each_and_none_is_long():
    page = (DOCS / "library.md").read_text(encoding="utf-8")
    assert list(scripts()) == list(PICTURES)
    for name, text in scripts().items():
        assert f"](pictures/{name}.png)" in page and (DOCS / "pictures" / f"{name}.png").is_file()
        assert len([line for line in text.splitlines() if line.strip()]) <= MOST_LINES, name
        assert [line for line in text.splitlines() if "from gaitdisc" in line or "import gaitdisc." in line] == []


@pytest.mark.parametrize("name", [pytest.param(p, marks=() if p in QUICK else pytest.mark.slow) for p in PICTURES])
def test_a_script_runs_as_it_stands(tmp_path, name, trained_briefly):
    run_script(scripts()[name], tmp_path)
    assert (tmp_path / f"{name}.png").stat().st_size > 5000
    assert len(plt.gcf().axes[0].lines) > 1
    results = [path.parent for path in tmp_path.glob("*/*.json")]
    assert len(results) == (name in ("discovery", "response"))
    assert all(gd.load(folder) for folder in results)


def test_scripts_without_a_picture_run_as_they_stand(tmp_path, capsys):
    plain = [block for block in blocks() if block not in scripts().values()]
    printed = (
        ("Trial('the table'", "kinematics 1", "100 Hz"),
        ("Strides(11", "side 'r'", "0.25 to 11.25 s", "[60.  0.]"),
        ("knee", "10", "5.0", "2.5", "6.0", "0.003906"),
        ("'-12.2625*sin(angle)'",),
    )
    for script, words in zip(plain, printed, strict=True):
        assert len([line for line in script.splitlines() if line.strip()]) <= MOST_LINES
        run_script(script, tmp_path)
        assert says(capsys.readouterr().out, *words)


STUDIES = DOCS.parent / "studies"


@pytest.mark.slow
def test_every_block_of_the_page_and_every_script_of_one_participant_runs(tmp_path, monkeypatch, trained_briefly):
    def run(script, *words):
        monkeypatch.setattr("sys.argv", [script, *words])
        runpy.run_path(str(STUDIES / script))

    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "4000")  # as `told` sets it, so that it is taken back
    names = {}
    page = (DOCS / "howto.md").read_text(encoding="utf-8")
    for language, block in re.findall(r"```(\w*)\n(.*?)```", page, re.DOTALL):
        if language == "python":
            exec(compile(block, "docs/howto.md", "exec"), names)
        elif block.startswith("python "):
            run(*block.split()[1:])
        else:
            assert not [line for line in told(*block.split()[1:]) if line.startswith(("exit code", "traceback"))]
    assert names["found"].verdict == "missing_physics" and names["look"].light == "green"
    run("participant_reconstruct.py", "P01", "recordings/P01/nominal_ik.mot", "hip_flexion_r", "knee_angle_r")
    gd.write_simulation(names["model"], "shank.toml")
    pd.concat(names["trials"]).to_csv("trials.csv", index=False)
    run("participant_discover.py", "P01", "shank.toml", "trials.csv")
    assert gd.read_simulation("found/P01_augmented.toml").effects and gd.load("responses/P01")
    assert gd.load("found/P01").effects[0].place == "knee" and gd.load("models/P01") and page.count("\n## ") == 10


def test_fields_runs_from_top_to_bottom():
    exec("".join(blocks(DOCS / "fields.md")), {})


@pytest.mark.slow
def test_simulation_runs_from_top_to_bottom(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    write_record(tmp_path / "tank.csv", lambda one: one.with_effect(Term("leak", "port", "hidden", "-0.4*level**2")), 1)
    names: dict = {}
    both = blocks(DOCS / "simulation.md")
    assert len(both) == 2
    for block in both:
        exec(compile(block, "docs/simulation.md", "exec"), names)
    assert names["states"].shape == (2, 501, 2) and names["ok"].all()
    assert "coulomb_friction" in (tmp_path / "pendulum_with_friction.toml").read_text()
    assert [(one.place, one.name) for one in names["augmented"].effects] == [("leak", "quadratic_stiffness")]
    assert {path.name for path in (tmp_path / "found").iterdir()} >= {"discovery.json", "augmented.toml", "report.html"}
