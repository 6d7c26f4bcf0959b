from hidden_in_a_mass import Experiment, mass, record

from gaitdisc.discovery.decision import judge
from gaitdisc.discovery.inquiry import begin_inquiry


def test_a_verdict_carries_the_account_and_what_else_was_weighed(inquiry, as_read, named):
    verdict = judge(inquiry, as_read)
    assert verdict.word == "missing_physics"
    assert verdict.account.labels == named[0].labels
    assert verdict.rivals[0].evidence <= verdict.rivals[1].evidence
    assert (verdict.shaking, verdict.starts) == (None, {})


def test_a_random_push_comes_with_its_place_and_strength_and_without_an_explanation():
    inquiry = begin_inquiry(mass(), record(mass(), 3, Experiment(shaking=6.0)))
    verdict = judge(inquiry, inquiry.as_read())
    assert verdict.word == "process_noise"
    assert verdict.account.account.parts == ()
    assert verdict.shaking is not None
    assert verdict.shaking.place.name == "load"
    assert 4.0 < verdict.shaking.strength < 8.0
