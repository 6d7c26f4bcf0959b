from pathlib import Path

import pytest

from gaitdisc.batch.variant_unit import computed_variants
from gaitdisc.response.modalities import ALL, AS_STUDIED
from gaitdisc.results import Refusal
from gaitdisc.results.variants import Variants


def computed(study, folder, question):
    shares = []
    found = computed_variants(study, study.participants[0], folder, question, shares.append)
    return found, shares


@pytest.fixture(scope="module")
def first_time(small, tmp_path_factory):
    """Folder, variants and shares said, by question: computed once for all tests; what is learnt counts in one."""
    folder = tmp_path_factory.mktemp("variants")
    with pytest.MonkeyPatch.context() as brief:
        brief.setattr("gaitdisc.networks.training_settings.epochs_of", lambda *_: 2)
        modalities = computed(small, folder, "modalities")
    return {"modalities": (folder, *modalities), "sensitivity": (folder, *computed(small, folder, "sensitivity"))}


@pytest.mark.parametrize(("question", "first"), [("modalities", ALL), ("sensitivity", AS_STUDIED)])
def test_variants_are_computed_once_and_then_loaded(small, first_time, question, first):
    folder, found, shares = first_time[question]
    assert isinstance(found, Variants)
    assert found.table["variant"].iloc[0] == first
    assert shares == sorted(shares)
    assert shares[-1] == pytest.approx(1.0)
    again, shares = computed(small, folder, question)
    assert shares == []
    assert again.table.equals(computed(small, folder, question)[0].table)
    assert again.table["r2"].to_numpy() == pytest.approx(found.table["r2"].to_numpy())


def test_a_cut_off_changes_what_is_tested(first_time):
    _, found, _ = first_time["sensitivity"]
    middle = found.table[found.table["kind"] == "network"].groupby(["variant", "model"])["r2"].median()
    assert middle["angles 12 Hz", "exo"] < middle["angles 4 Hz", "exo"]  # faster noise is less predictable
    assert {"25% of the training part", "50% of the training part"} <= set(found.table["variant"])
    assert "null" in set(found.table["kind"])


def test_a_file_that_cannot_be_read_refuses_this_participant(study, tmp_path):
    gone = study.participants[0].trials[0].model_copy(update={"files": ("gone.mot",)})
    person = study.participants[0].model_copy(update={"trials": (gone, study.participants[0].trials[1])})
    for question in ("modalities", "sensitivity"):
        refused = computed_variants(study, person, tmp_path, question, lambda _: None)
        assert isinstance(refused, Refusal)
        assert "nominal, file 1 is to be read" in refused.reason and "gone.mot" not in refused.reason
    assert not list(Path(tmp_path).rglob("variants.json"))
