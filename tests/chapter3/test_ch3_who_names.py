import importlib
from pathlib import Path

import numpy as np
import pytest

STUDIES = Path(__file__).parents[2] / "studies"


@pytest.fixture
def study(monkeypatch):
    monkeypatch.syspath_prepend(STUDIES)
    return importlib.import_module("ch3_who_names")


def test_what_sindy_should_say_is_what_is_hidden(study):
    for case in study.cases():
        x = case.system.start[None] + np.array([[0.3], [0.7]])
        gap = case.system.true(x) - case.system.known(x)
        if case.approach == "dynamics" and case.terms:
            powers = {"x**3": x[:, 0] ** 3, "y": x[:, 1], "x**2*y": x[:, 0] ** 2 * x[:, 1]}
            for output, terms in case.terms.items():
                written = sum(value * powers[term] for term, value in terms.items())
                assert gap[:, case.system.states.index(output)] == pytest.approx(written)
        if not case.words:
            assert not gap.any()


@pytest.mark.slow
def test_the_quick_study_names_the_cubic_of_the_text(study, tmp_path):
    table = study.run(quick=True, folder=tmp_path).tables[0]
    assert table.rows[0][3].startswith("named")
    assert (tmp_path / "figures" / "names.svg").exists()
