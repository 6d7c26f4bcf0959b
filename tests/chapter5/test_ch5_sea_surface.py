import importlib
from pathlib import Path

import pytest

STUDIES = Path(__file__).parents[2] / "studies"


@pytest.fixture
def study(monkeypatch):
    monkeypatch.syspath_prepend(STUDIES)
    return importlib.import_module("ch5_sea_surface")


def test_routes_stay_on_their_fields_and_come_back_after_a_year(study, gait_data):
    for field, task, region in study.fields():
        routes = study.routes_of(field, task.season, region)
        assert [route.sensors for route in routes] == [3, 1, 1, 1, 1, 2, 2, 2, 3]
        for route in routes:
            assert (route.points[: -task.season] == route.points[task.season :]).all()


@pytest.mark.slow
def test_the_quick_study(study, gait_data, tmp_path):
    result = study.run(quick=True, folder=tmp_path)
    temporal = [c for c in result.cells if c.split == "temporal" and c.field.startswith("Pacific")]
    three = {c.model: c for c in temporal if c.route == "3 fixed"}
    assert 0.7 < three["delay ridge"].relative_l2 < 0.9
    assert three["POD ceiling"].relative_l2 < 0.3
    assert (tmp_path / "figures" / "errors-1.png").exists()
