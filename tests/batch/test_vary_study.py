import pytest

from gaitdisc.batch.vary_study import vary_study
from gaitdisc.batch.workers import Workers
from gaitdisc.errors import SchemaError
from gaitdisc.results.stores import load_variant_run

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


def test_who_is_left_out_of_the_run_is_left_out_here_too(small, tmp_path):
    excluded = small.participants[1].model_copy(update={"excluded": "ill"})
    some = small.model_copy(update={"participants": (small.participants[0], excluded)})
    run = vary_study(some, tmp_path, "sensitivity")
    assert [each.participant for each in run.people] == ["P01"]
    assert [refusal.participant for refusal in run.refusals] == ["P02"]


def test_a_question_that_is_none(study, tmp_path):
    with pytest.raises(SchemaError, match="a question is one of: modalities, sensitivity; found 'why'"):
        vary_study(study, tmp_path, "why")
