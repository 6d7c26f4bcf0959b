"""All code of docs/howto.md and docs/fields.md runs as it stands, and so do the scripts of one participant."""

import re
import runpy

import pandas as pd
import pytest
from as_a_user import told
from library_pictures import DOCS, blocks

import gaitdisc as gd

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
