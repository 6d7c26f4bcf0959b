import pytest
from texts import says

from gaitdisc.response.participant_response import QUANTITY, DataQuantity, load_run
from gaitdisc.run.run_study import response_key, run_study, unit_keys
from gaitdisc.run.vary_study import ablate_study, compute_quantity
from gaitdisc.saved.provenance import Refusal


@pytest.mark.slow
def test_a_run_keeps_what_ablate_added(study, tmp_path):
    one = study.model_copy(update={"participants": study.participants[:1]})
    run = ablate_study(one, tmp_path, (1.0, 300.0))
    [quantity] = run.quantities
    assert quantity.participant == "P01"
    assert quantity.left_away[300.0].startswith("the training part is")
    medians = quantity.medians()
    assert medians.loc[1.0, "exo"] < medians["exo"].iloc[-1]
    assert [each.participant for each in run_study(one, tmp_path).quantities] == ["P01"]
    assert load_run(tmp_path).quantities[0].table.equals(load_run(tmp_path).quantities[0].table)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("quantities")


def test_it_is_computed_once_and_loaded_afterwards(small, folder, trained_briefly):
    person, shares = small.participants[0], []
    key = response_key(unit_keys(small, person))
    assert QUANTITY.kept(folder / "quantities" / person.id, key) is None
    first = compute_quantity(small, person, folder, (5.0,), "first", shares.append)
    assert isinstance(first, DataQuantity)
    assert shares[-1] == 1.0
    work = len(shares)
    again = compute_quantity(small, person, folder, (5.0,), "first", shares.append)
    assert isinstance(again, DataQuantity)
    kept = QUANTITY.kept(folder / "quantities" / person.id, key)
    assert kept is not None and again.table.equals(kept.table)
    assert len(shares) == work


def test_other_settings_are_not_taken_for_these(small, folder):
    person = small.participants[0]
    other = small.model_copy(update={"models": small.models.model_copy(update={"seed": 7})})
    assert QUANTITY.kept(folder / "quantities" / person.id, response_key(unit_keys(other, person))) is None


def test_a_walk_that_is_refused_refuses_the_rest(study, tmp_path):
    person = study.participants[0]
    broken = person.trials[1].model_copy(update={"files": ("nowhere.mot",)})
    person = person.model_copy(update={"trials": (person.trials[0], broken)})
    refused = compute_quantity(study, person, tmp_path, (5.0,), "first", lambda _: None)
    assert isinstance(refused, Refusal)
    assert says(refused.reason, "1", "be read") and "nowhere.mot" not in refused.reason
