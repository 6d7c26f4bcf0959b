from pathlib import Path

import pytest
from texts import says

from gaitdisc.errors import SchemaError
from gaitdisc.response.variants import Variants, load_variant_run
from gaitdisc.response.vary import ALL, AS_STUDIED
from gaitdisc.run.vary_study import compute_variants, vary_study
from gaitdisc.run.workers import Workers
from gaitdisc.saved.provenance import Refusal

pytestmark = pytest.mark.usefixtures("trained_briefly")


@pytest.mark.slow
def test_every_participant_of_the_run_is_varied(small, tmp_path):
    shares = []
    run = vary_study(small, tmp_path, "modalities", progress=lambda who, share: shares.append((who, share)))
    assert [each.participant for each in run.people] == ["P01", "P02"]
    assert [who for who, share in shares if share == 1.0][-1] == "P02"
    assert run.held_out_s == pytest.approx((3.75, 3.75), abs=0.02)
    assert len(run.tests) == 0  # two people carry no test
    kept = load_variant_run(tmp_path / "modalities")
    assert kept.r2_table().equals(run.r2_table())
    beside = vary_study(small, tmp_path, "modalities", Workers(jobs=2))
    assert beside.r2_table().equals(vary_study(small, tmp_path, "modalities").r2_table())


def test_a_question_that_is_none(study, tmp_path):
    with pytest.raises(SchemaError, match="modalities or sensitivity; found 'why'"):
        vary_study(study, tmp_path, "why")


def computed(study, folder, question):
    shares = []
    found = compute_variants(study, study.participants[0], folder, question, shares.append)
    return found, shares


@pytest.fixture(scope="module")
def first_time(small, tmp_path_factory, briefly):
    """Folder, variants and shares said, by question: computed once for all tests."""
    folder = tmp_path_factory.mktemp("variants")
    with briefly():
        return {each: (folder, *computed(small, folder, each)) for each in ("modalities", "sensitivity")}


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
    assert {"25 % of the training part", "50 % of the training part"} <= set(found.table["variant"])
    assert "null" in set(found.table["kind"])


def test_who_is_left_out_of_the_run_is_left_out_here_too(small, first_time):
    excluded = small.participants[1].model_copy(update={"excluded": "ill"})
    some = small.model_copy(update={"participants": (small.participants[0], excluded)})
    run = vary_study(some, first_time["sensitivity"][0], "sensitivity")
    assert [each.participant for each in run.people] == ["P01"]
    assert [refusal.participant for refusal in run.refusals] == ["P02"]


def test_a_file_that_cannot_be_read_refuses_this_participant(study, tmp_path):
    gone = study.participants[0].trials[0].model_copy(update={"files": ("gone.mot",)})
    person = study.participants[0].model_copy(update={"trials": (gone, study.participants[0].trials[1])})
    for question in ("modalities", "sensitivity"):
        refused = compute_variants(study, person, tmp_path, question, lambda _: None)
        assert isinstance(refused, Refusal)
        assert says(refused.reason, "1", "be read") and "gone.mot" not in refused.reason
    assert not list(Path(tmp_path).rglob("variants.json"))
