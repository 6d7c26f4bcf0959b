import importlib.util
import sys
from pathlib import Path

import pytest

STUDIES = Path(__file__).parents[2] / "studies"


@pytest.fixture
def study(monkeypatch):
    monkeypatch.syspath_prepend(str(STUDIES))
    spec = importlib.util.spec_from_file_location("planted_faults", STUDIES / "planted_faults.py")
    module = importlib.util.module_from_spec(spec)
    monkeypatch.setitem(sys.modules, "planted_faults", module)
    spec.loader.exec_module(module)
    return module


@pytest.mark.slow
def test_three_faults_in_three_files_are_found_and_the_files_themselves_raise_no_alarm(study, gait_data):
    found, alarms = study.outcomes(gait_data.parent, quick=True)
    assert alarms == []
    assert [one.found for one in found] == [True, True, True]
    assert study.table(found)[-1] == ("all", 3, 3, 0, 0)
