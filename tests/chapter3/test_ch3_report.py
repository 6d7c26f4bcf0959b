import importlib
from pathlib import Path

import numpy as np
import pytest
from chapter3.cell import cell_of
from chapter3.record import Conditions, recorded, system_of

from gaitdisc.simulation.parts import Term
from gaitdisc.simulation.simulation_file import bundled

STUDIES = Path(__file__).parents[2] / "studies"


@pytest.fixture
def study(monkeypatch):
    monkeypatch.syspath_prepend(STUDIES)
    return importlib.import_module("chapter3.pages")


def test_the_system_is_drawn_with_the_rate_that_it_lacks(study):
    system = system_of(bundled("van_der_pol"), Term("y", "equation", "cubic_stiffness", "-0.01*x**3"))
    cells = {"text": (cell_of(recorded(system, Conditions(duration_s=5.0)), "sindy", "dynamics"),)}
    figures = {"system": "Fig. 3.2", "dynamics": "Fig. 3.3", "noise": "Fig. 3.5"}
    stated, variant = study.blocks_of(cells, figures, (), {"text": system})
    assert [figure.name for figure in variant.figures] == ["system-1", "dynamics-1", "noise-1"]
    numbers = variant.figures[0].numbers
    assert np.allclose(numbers["missing rate"], -0.01 * numbers["x truth"] ** 3)
    assert stated.tables[0].rows[0][0] == "Fig. 3.2"
