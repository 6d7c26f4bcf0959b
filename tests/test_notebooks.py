"""The notebooks run from top to bottom, cell by cell, are small, use the door alone and hold no outputs."""

import ast
import json
from pathlib import Path

import matplotlib.pyplot as plt
import pytest

NOTEBOOKS = Path(__file__).parents[1] / "docs" / "notebooks"


def cells(name, kind="code"):
    book = json.loads((NOTEBOOKS / f"{name}.ipynb").read_text(encoding="utf-8"))
    assert book["nbformat"] == 4
    return [cell for cell in book["cells"] if cell["cell_type"] == kind]


def run(name):
    """Names of a notebook after its last cell, and what each cell shows: the value of its last line."""
    names, shown = {"__name__": "__main__"}, []
    for number, cell in enumerate(cells(name), 1):
        tree = ast.parse("".join(cell["source"]), f"{name}, code cell {number}")
        last = tree.body.pop() if isinstance(tree.body[-1], ast.Expr) else None
        exec(compile(tree, f"{name} {number}", "exec"), names)
        shown.append(eval(compile(ast.Expression(last.value), f"{name} {number}", "eval"), names) if last else None)
    return names, shown


@pytest.fixture
def screen(monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    plt.switch_backend("agg")
    yield
    plt.close("all")


@pytest.mark.parametrize("name", [path.stem for path in sorted(NOTEBOOKS.glob("*.ipynb"))])
def test_a_notebook_is_short_holds_no_output_and_goes_through_the_door(name):
    assert {(cell["execution_count"], str(cell["outputs"])) for cell in cells(name)} == {(None, "[]")}
    text = "\n".join("".join(cell["source"]) for cell in cells(name))
    assert "import gaitdisc as gd" in text and "from gaitdisc" not in text and "gaitdisc." not in text
    assert len([line for line in text.splitlines() if line.strip()]) <= 50
    assert cells(name, "markdown")


@pytest.mark.slow
def test_chapter_3_names_the_hidden_spring_and_forecasts_better_with_it(screen):
    names, shown = run("chapter3")
    [effect] = names["found"].effects
    assert effect.name == "cubic_stiffness"
    assert effect.estimates["stiffness"].value == pytest.approx(names["CUBIC"], rel=0.1)
    assert names["errors"]["model with what was found"] < 0.2 * names["errors"]["known model"]
    assert names["found"] in shown and "<table" in names["found"]._repr_html_()


@pytest.mark.slow
def test_chapter_4_fits_its_models_and_draws_them(screen, trained_briefly):
    names, _ = run("chapter4")
    assert set(names["table"]["model"]) >= {"nominal", "exo", "augmented"}
    assert len(plt.gcf().axes[0].lines) > 1
