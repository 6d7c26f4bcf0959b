"""The code that docs/simulation.md prints runs as it stands there."""

import re
from pathlib import Path

import pytest
from hidden_in_a_function import write_record

from gaitdisc.simulation.parts import Term

PAGE = Path(__file__).parents[2] / "docs" / "simulation.md"


@pytest.mark.slow
def test_the_code_on_the_page_runs_from_top_to_bottom(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    write_record(tmp_path / "tank.csv", lambda one: one.with_effect(Term("leak", "port", "hidden", "-0.4*level**2")), 1)
    names: dict = {}
    blocks = re.findall(r"^```python\n(.*?)^```", PAGE.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)
    assert len(blocks) == 2
    for block in blocks:
        exec(compile(block, str(PAGE), "exec"), names)
    assert names["states"].shape == (2, 501, 2) and names["ok"].all()
    assert "coulomb_friction" in (tmp_path / "pendulum_with_friction.toml").read_text()
    assert [(one.place, one.name) for one in names["augmented"].effects] == [("leak", "quadratic_stiffness")]
    assert {path.name for path in (tmp_path / "found").iterdir()} >= {"discovery.json", "augmented.toml", "report.html"}
