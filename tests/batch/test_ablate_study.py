import pytest

from gaitdisc.batch.ablate_study import ablate_study
from gaitdisc.batch.run_study import run_study
from gaitdisc.results.run_store import load_run


@pytest.mark.slow
def test_a_run_keeps_what_ablate_added(study, tmp_path):
    one = study.model_copy(update={"participants": study.participants[:1]})
    run = ablate_study(one, tmp_path, (1.0, 300.0))
    [quantity] = run.quantities
    assert quantity.participant == "P01"
    assert quantity.left_away[300.0].startswith("the training part has")
    medians = quantity.medians()
    assert medians.loc[1.0, "exo"] < medians["exo"].iloc[-1]
    assert [each.participant for each in run_study(one, tmp_path).quantities] == ["P01"]
    assert load_run(tmp_path).quantities[0].table.equals(load_run(tmp_path).quantities[0].table)
