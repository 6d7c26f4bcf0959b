import importlib.util
import sys
import tomllib
from pathlib import Path

import pytest

STUDIES = Path(__file__).parents[2] / "studies"


@pytest.fixture
def study(monkeypatch):
    monkeypatch.syspath_prepend(STUDIES)
    spec = importlib.util.spec_from_file_location("ch4_ankle_exo", STUDIES / "ch4_ankle_exo.py")
    module = importlib.util.module_from_spec(spec)
    monkeypatch.setitem(sys.modules, "ch4_ankle_exo", module)  # dataclasses look their module up
    spec.loader.exec_module(module)
    return module


def test_every_printed_number_has_ours_and_its_source(study):
    printed = tomllib.loads(study.PRINTED.read_text(encoding="utf-8"))["value"]
    assert [value["id"] for value in printed] == list(study.OURS)
    assert all(value["source"] for value in printed if value["printed"] != "not printed")
    assert {key for value in printed for key in value} == {"id", "what", "printed", "source"}  # no reason by hand


@pytest.mark.slow
def test_the_quick_study_is_the_whole_way_for_one_person(study, tmp_path):
    result = study.run(quick=True, folder=tmp_path, jobs=1)
    assert len(result.run.responses) == len(result.run.quantities) == 1
    ours = result.printed.set_index("what")["ours"]
    assert ours["Augmented explains less than Exo"] == "none"
    assert ours[[one for one in ours.index if one.startswith("(ii) Exo")]].to_list() == ["not tested"]
    figures = {path.stem for path in (tmp_path / "report" / "figures").glob("*.csv")}
    assert {"quantity", "reduction", "residual-W01-1"} <= figures
    assert (tmp_path / "printed.csv").read_text(encoding="utf-8").startswith("what,printed,ours,source")


@pytest.mark.slow
@pytest.mark.timeout(1800)
def test_the_order_of_the_chapter_holds(study, tmp_path):
    """What must hold is the order and the logic, not the numbers: the cohort is another population."""
    run = study.run(quick=False, folder=tmp_path).run
    assert [refusal.participant for refusal in run.refusals] == ["W07"]
    nominal, augmented, exo = (sys.modules["ch4_ours"].medians(run, model) for model in ("nominal", "augmented", "exo"))
    angles = list(sys.modules["ch4_ours"].ANGLES)
    assert (nominal[angles] < augmented[angles]).all()
    assert (abs(augmented - exo) < 0.05).all()
    assert (exo < 1).all()
    tests = run.tests.of_pair("nominal", "augmented")
    assert tests["different"].sum() >= 6
    reductions = run.over.reduction_tests
    of_angles = reductions[reductions["variable"].isin(angles)]
    assert (of_angles["low"] > 0).all()
    whole = [quantity.medians()["exo"] for quantity in run.quantities]
    assert all(exo.iloc[-1] > exo.loc[10.0] > exo.loc[1.0] for exo in whole)
