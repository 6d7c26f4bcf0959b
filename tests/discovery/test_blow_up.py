import pytest
from hidden_in_a_mass import Experiment, mass, record

from gaitdisc.discovery.blow_up import refuse_blow_up
from gaitdisc.simulation.parts import Term
from gaitdisc.simulation.refusal import SimulationError


@pytest.fixture(scope="module")
def measured():
    return record(mass(), 2, Experiment(seconds=8.0))


def test_a_simulation_that_stays_near_the_data_passes(measured):
    refuse_blow_up(mass(), measured)


def test_where_it_blows_up_and_what_drives_it_is_told(measured):
    wild = mass().with_effect(Term("load", "port", "wild", "k*exp(300*abs(x))"))
    with pytest.raises(SimulationError, match=r"leaves it in trial \d after t = .* s, first in 'v'.*Check 'k'"):
        refuse_blow_up(wild, measured)
