import numpy as np
import pytest
from hidden_in_a_mass import Experiment, mass, record

from gaitdisc.discovery.inquiry import begin_inquiry
from gaitdisc.discovery.shaken import shaken


def _weighed(how, seed=3):
    inquiry = begin_inquiry(mass(), record(mass(), seed, how))
    now = inquiry.as_read()
    return shaken(now.shooting, now.account, inquiry.search.places)[0]


@pytest.mark.parametrize("seed", [3, 4])
def test_random_pushes_are_likelier_than_a_sensor_that_remembers(seed):
    best = _weighed(Experiment(shaking=6.0), seed)
    assert best.rival - best.evidence > 0.1 * best.numbers
    assert best.strength == pytest.approx(6.0, rel=0.3)
    assert best.place.name == "load"


@pytest.mark.parametrize("how", [Experiment(), Experiment(cutoff_hz=6.0)], ids=["white", "coloured"])
def test_noise_of_the_sensor_is_not_taken_for_pushes(how):
    best = _weighed(how)
    assert best.rival - best.evidence < 0.01 * best.numbers


def test_the_strength_of_pushes_follows_theirs():
    weak, strong = (_weighed(Experiment(shaking=size)).strength for size in (3.0, 12.0))
    assert strong / weak == pytest.approx(4.0, rel=0.3)
    assert np.isfinite(weak)
