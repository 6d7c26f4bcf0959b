from hidden_in_a_mass import Experiment, mass, record

from gaitdisc.discovery.decision import decide
from gaitdisc.discovery.problem import set_up_problem


def test_a_verdict_carries_the_account_and_what_else_was_weighed(problem, as_read, named):
    verdict = decide(problem, as_read)
    assert verdict.word == "missing_physics"
    assert verdict.found.labels == named[0].labels
    assert verdict.rivals[0].bic <= verdict.rivals[1].bic
    assert (verdict.process_noise, verdict.starts) == (None, {})


def test_a_random_push_comes_with_its_place_and_strength_and_without_an_explanation():
    problem = set_up_problem(mass(), record(mass(), 3, Experiment(shaking=6.0)))
    verdict = decide(problem, problem.as_read())
    assert verdict.word == "process_noise"
    assert verdict.found.model.parts == ()
    assert verdict.process_noise is not None
    assert verdict.process_noise.place.name == "load"
    assert 4.0 < verdict.process_noise.strength < 8.0
