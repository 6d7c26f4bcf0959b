from dataclasses import replace

import numpy as np
import pytest
from hidden_in_a_mass import Experiment, mass, record

from gaitdisc.discovery.case import set_up_case
from gaitdisc.discovery.process_noise import rank_process_noise
from gaitdisc.simulation.parts import Sensor


def _weighed(how, seed=3, simulation=None, gaps=False):
    measured = record(mass(), seed, how)
    if gaps:
        observed = np.array(measured.observed)
        observed[:, 100:112] = observed[0, 300:309] = np.nan
        measured = replace(measured, observed=observed)
    case = set_up_case(simulation or mass(), measured)
    now = case.as_read()
    return rank_process_noise(now, case.search.places)[0]


@pytest.mark.parametrize(("seed", "gaps"), [(3, False), (4, False), (3, True)])
def test_random_pushes_are_likelier_than_a_sensor_that_remembers(seed, gaps):
    best = _weighed(Experiment(shaking=6.0), seed, gaps=gaps)
    assert best.rival - best.bic > 0.1 * best.numbers
    assert best.strength == pytest.approx(6.0, rel=0.3)
    assert best.place.name == "load"


@pytest.mark.parametrize("how", [Experiment(), Experiment(cutoff_hz=6.0)], ids=["white", "coloured"])
def test_noise_of_the_sensor_is_not_taken_for_pushes(how):
    best = _weighed(how)
    assert best.rival - best.bic < 0.01 * best.numbers


def test_the_strength_of_pushes_follows_theirs():
    weak, strong = (_weighed(Experiment(shaking=size)).strength for size in (3.0, 12.0))
    assert strong / weak == pytest.approx(4.0, rel=0.3)
    assert np.isfinite(weak)


@pytest.mark.parametrize("pushed", [False, True])
def test_filtered_noise_of_the_sensor_is_not_taken_for_pushes_and_pushes_are_found_all_the_same(pushed):
    stated = mass().with_sensor(Sensor("x", lowpass=3.0))
    best = _weighed(Experiment(lowpass_hz=3.0, shaking=6.0 * pushed), simulation=stated)
    gained = (best.rival - best.bic) / best.numbers
    assert gained > 0.1 if pushed else gained < 0.01
