import pytest

from gaitdisc.batch.participant_unit import response_key, unit_keys
from gaitdisc.batch.quantity_unit import computed_quantity, stored_quantity
from gaitdisc.results import DataQuantity, Refusal


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("quantities")


def test_it_is_computed_once_and_loaded_afterwards(study, folder):
    person, shares = study.participants[0], []
    key = response_key(unit_keys(study, person))
    assert stored_quantity(person, folder, key) is None
    first = computed_quantity(study, person, folder, (5.0,), "first", shares.append)
    assert isinstance(first, DataQuantity)
    assert shares[-1] == 1.0
    work = len(shares)
    again = computed_quantity(study, person, folder, (5.0,), "first", shares.append)
    assert isinstance(again, DataQuantity)
    assert again.table.equals(stored_quantity(person, folder, key).table)
    assert len(shares) == work


def test_other_settings_are_not_taken_for_these(study, folder):
    person = study.participants[0]
    other = study.model_copy(update={"models": study.models.model_copy(update={"seed": 7})})
    assert stored_quantity(person, folder, response_key(unit_keys(other, person))) is None


def test_a_walk_that_is_refused_refuses_the_rest(study, tmp_path):
    person = study.participants[0]
    broken = person.trials[1].model_copy(update={"files": ("nowhere.mot",)})
    person = person.model_copy(update={"trials": (person.trials[0], broken)})
    refused = computed_quantity(study, person, tmp_path, (5.0,), "first", lambda _: None)
    assert isinstance(refused, Refusal)
    assert "exo, file 1 is to be read" in refused.reason and "nowhere.mot" not in refused.reason
