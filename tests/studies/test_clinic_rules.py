import importlib.util
from pathlib import Path

import pytest

STUDIES = Path(__file__).parents[2] / "studies"


@pytest.mark.slow
def test_what_is_planted_is_found_on_pages_of_few_people():
    spec = importlib.util.spec_from_file_location("clinic_rules", STUDIES / "clinic_rules.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    rows = list(module.run(quick=True))
    assert [row["planted"] for row in rows] == ["nothing", "stiff knee", "drop foot", "child"]
    assert rows[0]["said elsewhere"] == 0
    assert all(row["found"] <= row["pages"] == 2 for row in rows)
