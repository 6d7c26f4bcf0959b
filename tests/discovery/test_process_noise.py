from dataclasses import replace

import numpy as np
import pytest
from hidden_in_a_mass import Experiment, mass, record

from gaitdisc.discovery.case import set_up_case
from gaitdisc.discovery.process_noise import rank_process_noise
from gaitdisc.simulation.parts import Sensor


def _weighed(how, seed=3):
    case = set_up_case(mass(), record(mass(), seed, how))
    now = case.as_read()
    return rank_process_noise(now.shooting, now.model, case.search.places)[0]


@pytest.mark.parametrize("seed", [3, 4])
def test_random_pushes_are_likelier_than_a_sensor_that_remembers(seed):
    best = _weighed(Experiment(shaking=6.0), seed)
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


def test_filtered_noise_of_the_sensor_is_not_taken_for_pushes_and_pushes_are_found_all_the_same():
    stated = mass().with_sensor(Sensor("x", lowpass=3.0))
    for how, pushed in ((Experiment(lowpass_hz=3.0), False), (Experiment(lowpass_hz=3.0, shaking=6.0), True)):
        case = set_up_case(stated, record(mass(), 3, how))
        now = case.as_read()
        best = rank_process_noise(now.shooting, now.model, case.search.places)[0]
        gained = (best.rival - best.bic) / best.numbers
        assert gained > 0.1 if pushed else gained < 0.01


def test_gaps_change_little():
    measured = record(mass(), 3, Experiment(shaking=6.0))
    observed = np.array(measured.observed)
    observed[:, 100:112] = observed[0, 300:309] = np.nan
    gaps = set_up_case(mass(), replace(measured, observed=observed))
    now = gaps.as_read()
    best = rank_process_noise(now.shooting, now.model, gaps.search.places)[0]
    assert best.rival - best.bic > 0.1 * best.numbers
    assert best.strength == pytest.approx(6.0, rel=0.3)
